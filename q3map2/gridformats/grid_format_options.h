// GPL-2.0-or-later. Options of the stage -convertgrid.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/light/sparse/sparse_bake.h"

#include <string>
#include <vector>

namespace q3 {

/// Documentation of -gridformats: its words.
inline constexpr std::string_view kGridFormatsDetails =
    "LIST is of these words, separated by commas: `sh` and `shbspx`, the SH grid in lump 18 or in a BSPX lump; "
    "`sparse`, the SH grid with cells of different sizes; "
    "`legacy`, the legacy grid fitted to the SH grid, `legacy-ioq3` and `legacy-daemon`, the same for what these "
    "engines make of it; `raw-ioq3` and `raw-rend2`, the fitted legacy grid and its floats in `maps/x/lightgrid.raw`; "
    "`octree` and `grids`, the BSPX lumps LIGHTGRID_OCTREE and LIGHTGRIDS. [grid_formats.md](grid_formats.md) tells "
    "which engine reads what.";

/// Values of the options of -convertgrid.
struct ConvertGridOptions {
    std::string formats;
    std::string output;      ///< path of the map to write; empty: the input
    float ambientFactor = 1; ///< of lump 15 and raw files; product of the game's default and the option
    SparseGoal sparse;
    bool givenSparse = false; ///< an option of the sparse grid was given: it is made again
    bool fixBotFiles = false; ///< enter the written map into bot files beside it
};

/// The options of the -convertgrid stage, declared.
std::vector<SettingGroup<ConvertGridOptions>> ConvertGridSettings();
/// Takes them off `arguments`. Errors: no list of formats.
ConvertGridOptions ParseConvertGridOptions(Arguments &arguments, float gameAmbientFactor, Log &log);

} // namespace q3
