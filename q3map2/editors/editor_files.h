// GPL-2.0-or-later. Entries of the build menus of level editors, and the files that hold them.
#pragma once

#include "q3map2/shader/games.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// An entry of a menu: runs of the program, one after the other.
struct EditorBuild {
    std::string label;
    std::vector<std::string> steps; ///< stage word and its options; the file comes last
    bool needsMap = true;           ///< reads the map source: editors that save a copy for it do so first
    bool opensGroup = false;        ///< a separator stands before it
};

/// Global options that editors put before those of a step.
inline constexpr std::array<std::string_view, 7> kEditorOptions{
    "-connect", "-game", "-fs_basepath", "-fs_basegame", "-fs_homepath", "-fs_game", "-fs_pakpath"};

/// Whether a step takes the map source; the others take the .bsp.
bool ReadsMapSource(std::string_view step);

/// For each preset a build without and one with SH grid, and one for that grid alone; then entries without preset.
/// SH grids go into BSPX lumps, so that every engine loads the maps.
std::vector<EditorBuild> EditorBuilds(std::span<const std::string_view> presets);

// ---- Menus and profiles in the forms that level editors read ----

/// A file for an editor.
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
