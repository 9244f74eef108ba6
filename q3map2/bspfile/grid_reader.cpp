// GPL-2.0-or-later. The SH grids of a map as libs/shgrid samples them.
#include "q3map2/bspfile/grid_reader.h"

#include "common/error.h"

#include <algorithm>

namespace q3 {

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

} // namespace q3
