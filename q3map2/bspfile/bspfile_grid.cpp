// GPL-2.0-or-later. The uniform light grids: their placement, the lump of the SH grid, and its samples as engines take
// them.
#include "q3map2/bspfile/bspfile_grid.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Placement of the uniform light grids, and the lump of the SH grid ----

namespace {

constexpr double kMaxLayoutPoints = 4611686018427387904.0; ///< 2^62: the product of the counts fits an int64

} // namespace

GridLayout LayoutGrid(const Float3 &worldMins, const Float3 &worldMaxs, const Float3 &size) {
    GridLayout grid;
    grid.size = size;
    double points = 1;
    for (std::size_t i = 0; i < 3; i++) {
        if (!std::isfinite(size[i]) || size[i] <= 0)
            throw Error("light grid: the cell size {} {} {} is not three numbers above 0", size[0], size[1], size[2]);
        grid.mins[i] = size[i] * std::ceil(worldMins[i] / size[i]);
        const float last = size[i] * std::floor(worldMaxs[i] / size[i]);
        const float count = (last - grid.mins[i]) / size[i] + 1;
        constexpr float kCountLimit = 2147483648.0f; // 2^31, which no int32 holds
        if (!std::isfinite(grid.mins[i]) || !std::isfinite(count) || count >= kCountLimit)
            throw Error("light grid: cells of {} {} {} in a world from {} {} {} to {} {} {} cannot be counted", size[0],
                        size[1], size[2], worldMins[0], worldMins[1], worldMins[2], worldMaxs[0], worldMaxs[1],
                        worldMaxs[2]);
        grid.bounds[i] = std::int32_t(std::max(count, 1.0f));
        points *= grid.bounds[i];
    }
    if (points > kMaxLayoutPoints)
        throw Error("light grid: {} x {} x {} points are too many", grid.bounds[0], grid.bounds[1], grid.bounds[2]);
    return grid;
}

void CheckLightGridSH(const LightGridSH &grid, std::string_view name) {
    const bspGridSHHeader_t &head = grid.header;
    std::uint64_t product = 1;
    for (std::size_t i = 0; i < 3; i++) {
        if (!std::isfinite(head.gridMins[i]))
            throw Error("{}: SH light grid: gridMins[{}] is {}, not a finite number", name, i, head.gridMins[i]);
        if (!std::isfinite(head.gridSize[i]) || head.gridSize[i] <= 0)
            throw Error("{}: SH light grid: gridSize[{}] is {}, expected a number above 0", name, i, head.gridSize[i]);
        if (head.gridBounds[i] < 1)
            throw Error("{}: SH light grid: gridBounds[{}] is {}, expected at least 1", name, i, head.gridBounds[i]);
        // Capped at 2^31, so that the next multiplication cannot overflow.
        product = std::min<std::uint64_t>(product * std::uint64_t(head.gridBounds[i]), INT32_MAX + std::uint64_t(1));
    }
    if (head.numPoints < 0 || product != std::uint64_t(head.numPoints))
        throw Error("{}: SH light grid: numPoints is {}, but gridBounds are {} x {} x {}", name, head.numPoints,
                    head.gridBounds[0], head.gridBounds[1], head.gridBounds[2]);
    if (grid.points.size() != product)
        throw Error("{}: SH light grid: numPoints is {}, but the lump holds {} points", name, head.numPoints,
                    grid.points.size());
    for (std::size_t i = 0; i < grid.points.size(); i++)
        for (std::size_t k = 0; k < 9; k++)
            for (const float value : grid.points[i].coeffs[k])
                if (!std::isfinite(value))
                    throw Error("{}: SH light grid: point {}: coeffs[{}] is {}, not a finite number", name, i, k,
                                value);
}

LightGridSH ReadLightGridSH(const ByteSource &file, const FilePart &part, std::string_view name) {
    LightGridSH grid;
    constexpr std::int64_t head = sizeof grid.header;
    constexpr std::int64_t point = sizeof(bspGridPointSH_t);
    if (part.length <= head || (part.length - head) % point != 0)
        throw Error("{}: SH light grid: length {} is not {} plus a multiple of {}", name, part.length, head, point);
    file.Fill(std::uint64_t(part.offset), std::span(&grid.header, 1));
    grid.points.resize(std::size_t((part.length - head) / point));
    file.Fill(std::uint64_t(part.offset + head), std::span(grid.points));
    CheckLightGridSH(grid, name);
    return grid;
}

ByteRanges GridRanges(const LightGridSH &grid) {
    ByteRanges bytes;
    bytes.Add(std::span(&grid.header, 1));
    bytes.Add(grid.points);
    return bytes;
}

// ---- The SH grids of a map as libs/shgrid samples them ----

shgrid_grid UniformReader(const LightGridSH &grid) {
    shgrid_grid reader{};
    std::ranges::copy(grid.header.gridMins, reader.mins);
    std::ranges::copy(grid.header.gridSize, reader.cell);
    std::ranges::copy(grid.header.gridBounds, reader.bounds);
    reader.count = grid.header.numPoints;
    reader.points = reinterpret_cast<const unsigned char *>(grid.points.data());
    return reader;
}

shgrid_grid SparseReader(std::span<const std::byte> lump) {
    shgrid_grid reader;
    if (const shgrid_result result = shgrid_parse(lump.data(), lump.size(), &reader); result != SHGRID_OK)
        throw Error("sparse SH light grid: {}", shgrid_message(result));
    return reader;
}

// ---- How many points of an SH light grid are in the open, filled or void ----

namespace {

bool InSolid(const Bsp &bsp, const Float3 &position) {
    return bsp.leafs[std::size_t(LeafAt(bsp, Vec3f(position)))].cluster < 0;
}

bool IsZero(const bspGridPointSH_t &point) {
    return std::ranges::all_of(point.coeffs, [](const Float3 &rgb) { return rgb == Float3{}; });
}

} // namespace

GridPointCounts CountGridPoints(const Bsp &bsp, const LightGridSH &grid) {
    const bspGridSHHeader_t &head = grid.header;
    const GridLayout layout{head.gridMins, head.gridSize, head.gridBounds};
    GridPointCounts counts;
    std::size_t index = 0;
    for (int z = 0; z < head.gridBounds[2]; z++)
        for (int y = 0; y < head.gridBounds[1]; y++)
            for (int x = 0; x < head.gridBounds[0]; x++, index++) {
                if (!InSolid(bsp, layout.Position(x, y, z)))
                    counts.open++;
                else if (IsZero(grid.points[index]))
                    counts.darkVoid++;
                else
                    counts.filled++;
            }
    return counts;
}

} // namespace q3
