// GPL-2.0-or-later. The SH light grid of a map as the source of other grids.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/sparse_grid.h"

#include <vector>

namespace q3 {

/// The SH grid of a file as it is stored.
struct StoredGridSH {
    LightGridSH grid;
    bool radiance = false; ///< not convolved with the cosine: -shradiance
};

/// Values of a sparse grid at the points of another; outside its cells with light, zero.
LightGridSH ExpandSparseGrid(const SparseGridSH &sparse, const GridLayout &layout);

/// The SH grid of the map, in whichever form the file has it: a sparse one, without a uniform one beside it, at the
/// points of the light stage's defaults. Errors: there is none.
StoredGridSH SourceGrid(const Bsp &bsp);

/// Coefficients convolved with the cosine, and which points hold no light because they are in solid space.
class GridSource {
  public:
    /// `isSolid` of each point of the grid, in its order.
    GridSource(const StoredGridSH &stored, const std::vector<bool> &isSolid);

    const GridLayout &Layout() const { return layout_; }
    const bspGridPointSH_t &Point(std::size_t index) const { return points_[index]; }
    /// In solid space, without a value that keeps interpolation right beside walls.
    bool IsVoid(std::size_t index) const { return void_[index]; }
    /// Trilinear blend at a world position, clamped to the grid. Void points are left out and the other weights
    /// scaled to a sum of 1. False: all eight are void, `light` is zero.
    bool Sample(const Vec3f &position, bspGridPointSH_t &light) const;

  private:
    GridLayout layout_;
    std::vector<bspGridPointSH_t> points_;
    std::vector<bool> void_;
};

} // namespace q3
