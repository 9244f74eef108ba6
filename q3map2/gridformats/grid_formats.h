// GPL-2.0-or-later. The formats in which a map can hold its light grid: -gridformats and -convertgrid.
#pragma once

#include "common/arguments.h"
#include "common/jobs.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/light/sparse/sparse_bake.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Documentation of -gridformats: its words.
inline constexpr std::string_view kGridFormatsDetails =
    "LIST consists of words separated by commas. `sh` and `shbspx` are the SH grid in lump 18 or in a BSPX lump. "
    "`sparse` is the SH grid with cells of different sizes. `legacy` is the legacy grid fitted to the SH grid, and "
    "`legacy-ioq3` and `legacy-daemon` are the same for what these engines make of it. `raw-ioq3` and `raw-rend2` are "
    "the fitted legacy grid and its floats in `maps/x/lightgrid.raw`. `octree` and `grids` are the BSPX lumps "
    "LIGHTGRID_OCTREE and LIGHTGRIDS. [Grid formats](../engines/grid_formats.md) says which engine reads what.";

/// Values of the options of -convertgrid.
struct ConvertGridOptions {
    std::string formats;
    std::string output;      ///< path of the map to write; empty: the input
    float ambientFactor = 1; ///< of lump 15 and raw files; product of the game's default and the option
    SparseGoal sparse;
    bool remakesSparse = false; ///< an option of the sparse grid was given: it is made again
    bool fixBotFiles = false;   ///< enter the written map into bot files beside it
};

/// The options of the -convertgrid stage, declared.
std::vector<SettingGroup<ConvertGridOptions>> ConvertGridSettings();
/// Takes them off `arguments`. Errors: no list of formats.
ConvertGridOptions ParseConvertGridOptions(Arguments &arguments, float gameAmbientFactor, Log &log);

// ---- The table of formats, and the conversion ----

class GridConversion;

/// A file beside the map.
struct GridFile {
    std::string name; ///< within maps/x
    std::vector<std::byte> bytes;
};

/// Where a format stores its grid. A map has each once, so two formats of the same place exclude each other.
enum class GridPlace {
    Uniform,    ///< the uniform SH grid, in lump 18 or in a BSPX lump
    Sparse,     ///< the sparse SH grid
    Lump15,     ///< the legacy grid
    RawFile,    ///< lightgrid.raw
    OctreeLump, ///< BSPX LIGHTGRID_OCTREE
    GridsLump   ///< BSPX LIGHTGRIDS
};

/// A row of the table of formats.
struct GridFormat {
    /// Whether the map can be converted again from what the format writes.
    enum class Convertible { No, Yes };

    std::string_view word;
    GridPlace place;
    Convertible convertible;
    /// Stores the grid in the map, or adds a file.
    void (*store)(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &files);
};

using GridFormats = std::vector<const GridFormat *>;

/// All formats.
std::span<const GridFormat> AllGridFormats();
/// Words separated by commas. Errors: no word, an unknown one, two for one place.
GridFormats ParseGridFormats(std::string_view list);
bool HasPlace(const GridFormats &formats, GridPlace place);
/// Whether one of them can be converted again.
bool AnyConvertible(const GridFormats &formats);
/// Whether lump 15 is written, by its own format or for a raw file.
bool AnyWritesLegacyGrid(const GridFormats &formats);

/// How the grids are made.
struct GridStoring {
    double ambientFactor = 1; ///< of the ambient light of lump 15 and of raw files
    /// Goal of the sparse grid, which is made from the uniform one. None: a sparse grid of the map stays as it is; if
    /// it has none, the default goal counts.
    std::optional<SparseGoal> sparse{};
};

/// Replaces the light grids of the map by these formats, made from its SH grid; lump 15 stays if none writes it.
/// Returns the files to write. Errors: no SH grid, a legacy grid of too many points.
std::vector<GridFile> StoreGridFormats(Bsp &bsp, const GridFormats &formats, const GridStoring &storing,
                                       const JobPool &jobs, Log &log);

/// Drops the lumps LIGHTGRID_OCTREE and LIGHTGRIDS: new light makes them wrong.
void DropGridLumps(Bsp &bsp);

/// Name of the file of the raw formats, in maps/x.
inline constexpr std::string_view kRawGridFile = "lightgrid.raw";

} // namespace q3
