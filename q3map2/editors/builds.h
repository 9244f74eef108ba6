// GPL-2.0-or-later. Entries of the build menus of level editors.
#pragma once

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

} // namespace q3
