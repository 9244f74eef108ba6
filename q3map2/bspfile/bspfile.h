// GPL-2.0-or-later. A compiled map in memory, and its way from and to a file.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp_records.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// One named lump of the BSPX directory that may follow the header lumps.
struct BspxLump {
    std::string name; ///< at most 23 bytes; 24, without a NUL, are read and written back
    std::vector<std::byte> data;
};

inline constexpr std::string_view kBspxLightGridSH = "LIGHTGRID_SH";

/// The SH light grid, as in lump 18 or the BSPX lump of that name.
struct LightGridSH {
    bspGridSHHeader_t header{};
    std::vector<bspGridPointSH_t> points;
};

/// Where the SH light grid is stored.
enum class GridSHContainer {
    Lump, ///< lump 18 of a version 47 file with 19 slots: engines that know it only
    Bspx  ///< BSPX lump of a version 46 file: unmodified engines load it and see no SH grid
};

/// All lumps of an IBSP file as records. A value: copy, compare, edit. ReadBsp returns only validated data.
struct Bsp {
    std::string entities; ///< text of the lump without the final NUL
    std::vector<bspShader_t> shaders;
    std::vector<bspPlane_t> planes;
    std::vector<bspNode_t> nodes;
    std::vector<bspLeaf_t> leafs;
    std::vector<std::int32_t> leafSurfaces, leafBrushes;
    std::vector<bspModel_t> models;
    std::vector<bspBrush_t> brushes;
    std::vector<bspBrushSide_t> brushSides;
    std::vector<bspDrawVert_t> drawVerts;
    std::vector<std::int32_t> drawIndexes;
    std::vector<bspFog_t> fogs;
    std::vector<bspDrawSurface_t> drawSurfaces;
    std::vector<std::uint8_t> lightmaps; ///< pages of 128 * 128 * 3 bytes
    std::vector<bspGridPoint_t> gridPoints;
    std::vector<std::uint8_t> visibility; ///< i32 clusters, i32 bytes per row, rows; empty: everything is visible
    std::vector<bspAdvertisement_t> advertisements;
    std::optional<LightGridSH> gridSH;
    GridSHContainer gridSHContainer = GridSHContainer::Lump;
    std::vector<BspxLump> bspx; ///< without LIGHTGRID_SH, which is in gridSH
};

/// Which header a file without an SH lump gets. Version 46: 17 slots. Version 47: 17 slots (Wolfenstein family) or 18
/// with the advertisement lump (Quake Live).
struct BspFormat {
    int version = 46;
    bool advertisements = false; ///< slot 17 belongs to the format
    bool force = false;          ///< ident and version mismatches, and ragged lumps, are warnings
};

/// Parses and validates a whole file image. `name` is for messages. Errors: Error, one line, for anything that a later
/// stage could trip over; recoverable oddities are warnings.
Bsp ReadBsp(std::span<const std::byte> file, std::string_view name, const BspFormat &format, Log &log);
/// The same from disk, without the file image in memory.
Bsp ReadBspFile(const std::filesystem::path &path, const BspFormat &format, Log &log);

/// The exact bytes of the file. The same Bsp always gives the same bytes. Errors: 2^31 bytes or more, a bad SH grid.
std::vector<std::byte> WriteBsp(const Bsp &bsp, const BspFormat &format);
/// Writes them piece by piece, without a second copy in memory. Replaces the file by a complete one or leaves the old
/// one whole. Announces path and size.
void WriteBspFile(const std::filesystem::path &path, const Bsp &bsp, const BspFormat &format, Log &log);

/// Checks every index, count and float that ReadBsp promises to have checked; for a Bsp that came another way. Not
/// promised, because valid files break it: bounds of nodes and leafs, an even count of planes, finite texture and
/// lightmap coordinates of vertices, lightmapNum and lightmap rectangle (a warning), entity text that parses (a
/// warning), a light grid of the expected length (a warning).
void ValidateBsp(const Bsp &bsp, std::string_view name, Log &log);

/// Legacy light grid placement of a world model: cell, first point, points per axis.
struct GridLayout {
    Float3 mins{}, size{};
    Int3 bounds{};
    std::int64_t Count() const { return std::int64_t(bounds[0]) * bounds[1] * bounds[2]; }
    /// Number of point (x, y, z) in the lump.
    std::int64_t Index(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return x + bounds[0] * (y + bounds[1] * z);
    }
    /// World position of point (x, y, z), in float arithmetic as engines do it.
    Float3 Position(int x, int y, int z) const {
        return {mins[0] + float(x) * size[0], mins[1] + float(y) * size[1], mins[2] + float(z) * size[2]};
    }
};
/// mins = size * ceil(worldMins / size), bounds = (size * floor(worldMaxs / size) - mins) / size + 1, each at least 1
/// (a world thinner than a cell may hold no point). Errors: a cell size that is not above 0, counts that no int32
/// holds, a product above 2^62.
GridLayout LayoutGrid(const Float3 &worldMins, const Float3 &worldMaxs, const Float3 &size);

/// Name of a 64-byte field: up to the first NUL.
template <std::size_t N> std::string_view FieldName(const std::array<char, N> &field) {
    const std::string_view all(field.data(), N);
    return all.substr(0, all.find('\0'));
}

} // namespace q3
