// GPL-2.0-or-later. Menus and profiles in the forms that level editors read.
#pragma once

#include "q3map2/editors/builds.h"
#include "q3map2/shader/games.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3 {

struct EditorFile {
    std::string path; ///< folder of the editor and name
    std::string text;
};

/// NetRadiant and GtkRadiant 1.5: the build menu, XML with variables in brackets.
std::string BuildMenu(const std::vector<EditorBuild> &builds, const Game &game);
/// GtkRadiant 1.6: the project template. The editor makes a new copy for the user when `templateVersion` changes.
std::string ProjectTemplate(const std::vector<EditorBuild> &builds, const Game &game, int templateVersion);
/// TrenchBroom: CompilationProfiles.cfg and GameEngineProfiles.cfg.
std::string CompilationProfiles(const std::vector<EditorBuild> &builds, const Game &game);
std::string EngineProfiles();
/// TrenchBroom 2024.2 and newer: GameConfig.cfg, with map formats, folders, tags and flags of the game, and the tools
/// that profiles name.
std::string GameConfig(const Game &game);

/// All files above.
std::vector<EditorFile> EditorFiles(const std::vector<EditorBuild> &builds, const Game &game, int templateVersion);

} // namespace q3
