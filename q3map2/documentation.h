// GPL-2.0-or-later. Files that are generated from the declared settings.
#pragma once

#include "common/setting_info.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

struct Stage;

/// The settings of a stage, by sections; none for stages without.
std::vector<SettingSection> SectionsOf(const Stage &stage);
/// docs/options.md.
std::string MarkdownPage();
/// docs/shader_directives.md.
std::string DirectivesPage();
/// docs/q3map2.1.
std::string ManualPage();

/// The help of a setting with its unit, range and default, as one sentence. `complete`: with the default range too.
std::string FullHelp(const SettingEntry &entry, bool complete);
/// Text without Markdown for code and links.
std::string WithoutMarkup(std::string_view text);

} // namespace q3
