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

/// Cell size of the legacy grid of the map: the key gridsize, else 64 64 128. Game units.
Vec3f LegacyCell(const Bsp &bsp);

/// A uniform grid with the values of a sparse one at its points; zero where that has none.
LightGridSH ExpandSparseGrid(const SparseGridSH &sparse, const GridLayout &layout);

/// The uniform SH grid of the map; if it has a sparse one only, the values of that at the points that the light stage
/// has by default. Errors: it has neither.
StoredGridSH SourceGrid(const Bsp &bsp);

/// An SH grid with its coefficients convolved with the cosine, and which of its points are void.
class GridSource {
  public:
    /// `isSolid` of each point of the grid, in its order.
    GridSource(const StoredGridSH &stored, const std::vector<bool> &isSolid);

    const GridLayout &Layout() const { return layout_; }
    const bspGridPointSH_t &Point(std::size_t index) const { return points_[index]; }
    /// In solid space and black: the bake did not fill it.
    bool IsVoid(std::size_t index) const { return void_[index]; }
    const std::vector<bool> &Voids() const { return void_; }
    /// Trilinear blend at a world position, clamped to the grid. Void points are left out and the other weights
    /// scaled to a sum of 1. False: all eight are void, `light` is zero.
    bool Sample(const Vec3f &position, bspGridPointSH_t &light) const;

  private:
    GridLayout layout_;
    std::vector<bspGridPointSH_t> points_;
    std::vector<bool> void_;
};

} // namespace q3
