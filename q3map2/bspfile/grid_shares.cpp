// GPL-2.0-or-later. How many points of an SH light grid are in the open.
#include "q3map2/bspfile/grid_shares.h"

#include "q3map2/bspfile/bsp_tree.h"

#include <algorithm>

namespace q3 {

namespace {

bool InSolid(const Bsp &bsp, const Float3 &position) {
    return bsp.leafs[std::size_t(LeafAt(bsp, Vec3f(position)))].cluster < 0;
}

bool IsZero(const bspGridPointSH_t &point) {
    return std::ranges::all_of(point.coeffs, [](const Float3 &rgb) { return rgb == Float3{}; });
}

} // namespace

GridShares CountGridShares(const Bsp &bsp, const LightGridSH &grid) {
    const bspGridSHHeader_t &head = grid.header;
    const GridLayout layout{head.gridMins, head.gridSize, head.gridBounds};
    GridShares shares;
    std::size_t index = 0;
    for (int z = 0; z < head.gridBounds[2]; z++)
        for (int y = 0; y < head.gridBounds[1]; y++)
            for (int x = 0; x < head.gridBounds[0]; x++, index++) {
                if (!InSolid(bsp, layout.Position(x, y, z)))
                    shares.open++;
                else if (IsZero(grid.points[index]))
                    shares.darkVoid++;
                else
                    shares.filled++;
            }
    return shares;
}

} // namespace q3
