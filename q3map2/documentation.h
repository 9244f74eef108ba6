// GPL-2.0-or-later. Files that are generated from the declared settings.
#pragma once

#include "common/setting_info.h"

#include <string>

namespace q3 {

/// docs/options.md.
std::string MarkdownPage();
/// docs/q3map2.1.
std::string ManualPage();
/// tools/completions/q3map2.bash, _q3map2 and q3map2.fish.
std::string BashCompletion();
std::string ZshCompletion();
std::string FishCompletion();

/// The help of a setting with its unit, range and default, as one sentence.
std::string FullHelp(const SettingEntry &entry);
/// Text without Markdown for code and links.
std::string WithoutMarkup(std::string_view text);

} // namespace q3
