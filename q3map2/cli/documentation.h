// GPL-2.0-or-later. What the documentation lists: sections of keys and directives. The menus of level editors.
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
    "Names of keys are case-insensitive. If a key has several names, the first one in the entity counts. Text that is "
    "not a number, a number followed by other text, and a number out of range are warnings that name the entity and "
    "the key. A number out of range is replaced by the nearest one within it. Keys without a range accept at least "
    "-1000000 to 1000000.";

/// All declared keys, by kind of entity.
std::vector<SettingSection> EntitySections();

// ---- Documentation of the directives of shader scripts ----

/// What holds for all directives, for the documentation.
inline constexpr std::string_view kDirectiveRules =
    "A directive is a line of a shader in a script of the game (`scripts/*.shader`, or `shaders/*.shader`). Names are "
    "case-insensitive. Parentheses around numbers are optional, and the rest of a line after its values is ignored. A "
    "faulty line has no effect and is a warning that names the script, the line and the shader. Directives for engines "
    "and editors are ignored. Any other unknown directive is a warning, with the nearest name if there is one. Numbers "
    "are limited to plus and minus 1000000000. Light is given in 8-bit levels: 255 is full brightness, before gamma "
    "and "
    "tone.";

/// All directives and words of stages that the compiler reads, by subject.
std::vector<SettingSection> DirectiveSections();

/// The settings of a stage, by sections; none for stages without.
std::vector<SettingSection> SectionsOf(const Stage &stage);

/// Calls use(info) for every setting of the sections.
template <typename Use> void ForEntries(const std::vector<SettingSection> &sections, const Use &use) {
    for (const SettingSection &section : sections)
        for (const SettingEntry &entry : section.entries)
            use(entry.info);
}

// ---- q3map2 -editorfiles ----

/// The stage: checks the commands of the menus (editors/editor_files.h) and writes the files into the folder that
/// `arguments` names. Returns the exit status.
int EditorFilesStage(const StageContext &context, Arguments arguments);

/// Error if a build step (editors/editor_files.h) names a stage, option or value that does not exist.
void CheckBuildStep(StageList stages, const std::string &step);

} // namespace q3
