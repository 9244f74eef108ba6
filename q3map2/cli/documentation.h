// GPL-2.0-or-later. Files that are generated: documentation of settings, keys and directives, and menus of level
// editors.
#pragma once

#include "common/settings.h"
#include "q3map2/cli/program.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

// ---- Documentation of the keys of entities ----

/// What holds for all keys, for the documentation.
inline constexpr std::string_view kKeyRules =
    "Key names are case-insensitive. Of several names of a key the first one present counts. Text that is not a "
    "number, a number with something after it, and a number out of range are warnings that name the entity and the "
    "key; for the last the nearest number of the range is used. Numbers of keys whose range is not named may be at "
    "least from -1000000 to 1000000.";

/// All declared keys, by kind of entity.
std::vector<SettingSection> EntitySections();

// ---- Documentation of the directives of shader scripts ----

/// What holds for all directives, for the documentation.
inline constexpr std::string_view kDirectiveRules =
    "A directive is a line of a shader in a script of the game (`scripts/*.shader`, or `shaders/*.shader`). Names are "
    "case-insensitive; "
    "parentheses around numbers may be left out, and the rest of a line after its values is not read. A faulty line "
    "is a warning that names the script, the line and the shader, and has no effect. Words that are for engines and "
    "editors are ignored; any other unknown word is a warning, with the nearest name if there is one. Numbers are "
    "limited to plus and minus 1000000000. Light is given in 8-bit levels: 255 is full light, before gamma and tone.";

/// All directives and words of stages that the compiler reads, by subject.
std::vector<SettingSection> DirectiveSections();

// ---- Pages that are generated from the declared settings ----

/// The settings of a stage, by sections; none for stages without.
std::vector<SettingSection> SectionsOf(const Stage &stage);
/// docs/options.md.
std::string MarkdownPage(StageList stages);
/// docs/shader_directives.md.
std::string DirectivesPage();
/// docs/q3map2.1.
std::string ManualPage(StageList stages);

/// Which ranges of numbers are shown: all, or only those that a setting declares itself.
enum class ShownRanges { Declared, All };

/// The help of a setting with its unit, range and default, as one sentence.
std::string FullHelp(const SettingEntry &entry, ShownRanges ranges);
/// Text without Markdown for code and links.
std::string WithoutMarkup(std::string_view text);

// ---- q3map2 -editorfiles ----

/// The stage: checks the commands of the menus (editors/editor_files.h) and writes the files into the folder that
/// `arguments` names. Returns the exit status.
int EditorFilesStage(const StageContext &context, Arguments arguments);

/// Error if a build step (editors/editor_files.h) names a stage, option or value that does not exist.
void CheckBuildStep(StageList stages, const std::string &step);

} // namespace q3
