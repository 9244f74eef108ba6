// GPL-2.0-or-later. The uniform light grids: their placement, the lump of the SH grid, and its samples as engines take
// them.
#pragma once

#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_codec.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace q3 {

/// Cell size of the legacy grid of a map without the key gridsize. Game units.
inline constexpr Float3 kDefaultGridSize = {64, 64, 128};

/// Placement of the legacy or the uniform SH grid: first point, cell, points per axis.
struct GridLayout {
    Float3 mins{}, size{};
    Int3 bounds{};
    std::int64_t Count() const { return std::int64_t(bounds[0]) * bounds[1] * bounds[2]; }
    /// Number of point (x, y, z) in the lump.
    std::int64_t Index(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return x + bounds[0] * (y + bounds[1] * z);
    }
    /// x, y and z of a point by its number in the lump.
    Int3 Coordinates(std::int64_t index) const {
        const std::int64_t row = index / bounds[0];
        return {int(index % bounds[0]), int(row % bounds[1]), int(row / bounds[1])};
    }
    /// World position of point (x, y, z), in float arithmetic as engines do it.
    Float3 Position(int x, int y, int z) const {
        return {mins[0] + float(x) * size[0], mins[1] + float(y) * size[1], mins[2] + float(z) * size[2]};
    }
};
/// mins = size * ceil(worldMins / size), bounds = (size * floor(worldMaxs / size) - mins) / size + 1, each at least 1
/// (the single point of a world thinner than a cell may lie outside it). Errors: a cell size that is not above 0,
/// counts that no int32 holds, a product above 2^62.
GridLayout LayoutGrid(const Float3 &worldMins, const Float3 &worldMaxs, const Float3 &size);

/// Checks the header against the number of points, and that all floats are finite. Errors name the field.
void CheckLightGridSH(const LightGridSH &grid, std::string_view name);

/// Reads the lump, 18 or BSPX, from a part of the file. Errors: a bad length, and those of CheckLightGridSH.
LightGridSH ReadLightGridSH(const ByteSource &file, const FilePart &part, std::string_view name);
/// The bytes of the lump: its head, then its points.
ByteRanges GridRanges(const LightGridSH &grid);

/// A reader of the uniform grid, which must outlive it.
shgrid_grid UniformReader(const LightGridSH &grid);
/// A reader of the lump of a sparse grid (EncodeSparseGrid), which must outlive it. Errors: what shgrid_parse says.
shgrid_grid SparseReader(std::span<const std::byte> lump);

/// Numbers of SH grid points by position and value; each point is in one of the three. Printed by -light and -info.
struct GridPointCounts {
    std::size_t open = 0;     ///< in open space
    std::size_t filled = 0;   ///< in solid, not zero: light taken from points around
    std::size_t darkVoid = 0; ///< in solid, all zero
};

GridPointCounts CountGridPoints(const Bsp &bsp, const LightGridSH &grid);

} // namespace q3
