// GPL-2.0-or-later. The reference of the manual, which is generated from the declared settings: the pages of
// docs/reference about options, keys and directives, and the man page.
#pragma once

#include "common/settings.h"
#include "q3map2/cli/program.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Which ranges of numbers are shown: all, or only those that a setting declares itself.
enum class ShownRanges { Declared, All };

/// The help of a setting with its unit, range and default, as one sentence without its full stop.
std::string FullHelp(const SettingEntry &entry, ShownRanges ranges);
/// "q3map2" for what NetRadiant's q3map2 has too, "q3map2-sh 0.1.0" for what this program introduced in that version.
std::string SinceText(const SettingInfo &info);
/// Text without Markdown for code and links.
std::string WithoutMarkup(std::string_view text);

/// An example of an option on a command line, "q3map2 -light -samples 3 maps/mymap.bsp". `stage`: null for global
/// options.
std::string OptionExample(const Stage *stage, const SettingInfo &info);
/// The line of an entity with that key, "_color" "1 0.9 0.8" with these quotes; empty for keys without an example.
std::string KeyExample(const SettingInfo &info);
/// The line of a shader with that directive: q3map_surfaceLight 2000.
std::string DirectiveExample(const SettingInfo &info);

/// A generated page of docs/reference.
struct ReferencePage {
    std::string_view file; ///< "light.md"; also the topic of -help that prints it
    std::string (*text)(StageList stages);
};
/// All of them.
std::vector<ReferencePage> ReferencePages();

/// docs/q3map2.1.
std::string ManualPage(StageList stages);

} // namespace q3
