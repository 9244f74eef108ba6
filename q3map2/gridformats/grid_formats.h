// GPL-2.0-or-later. The formats in which a map can hold its light grid: -gridformats and -convertgrid.
#pragma once

#include "common/jobs.h"
#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/light/sparse/sparse_bake.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

class GridConversion;

/// A file beside the map.
struct GridFile {
    std::string name; ///< within maps/x
    std::vector<std::byte> bytes;
};

/// Where a format stores its grid. A map has each once, so two formats of the same place exclude each other.
enum class GridPlace { Full, Sparse, Lump15, RawFile, OctreeLump, GridsLump };

/// A row of the table of formats.
struct GridFormat {
    std::string_view word;
    GridPlace place;
    bool isSource; ///< the map can be converted again from what it writes
    /// Stores the grid in the map, or adds a file.
    void (*store)(const GridConversion &from, Bsp &bsp, std::vector<GridFile> &files);
};

using GridFormats = std::vector<const GridFormat *>;

/// All formats.
std::span<const GridFormat> AllGridFormats();
/// Words separated by commas. Errors: none, an unknown one, two for one place.
GridFormats ParseGridFormats(std::string_view list);
bool HasPlace(const GridFormats &formats, GridPlace place);
/// Whether one of them can be converted again.
bool KeepSource(const GridFormats &formats);
/// Whether lump 15 is written, by its own format or for a raw file.
bool ReplaceLegacyGrid(const GridFormats &formats);

/// Options of the conversion.
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
