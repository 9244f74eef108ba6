// GPL-2.0-or-later. The SH light grid of a map as the source of other grids: its light, split into ambient and
// directed, in the tone of the lightmaps.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_sparse.h"

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

namespace q3 {

/// Light ambient + directed * max(0, n . direction) on a surface with the normal n; 1 is byte 255. No part is negative.
struct AmbientDirected {
    Vec3d ambient, directed;
    Vec3d direction{0, 0, 1}; ///< toward the light, unit
};

/// The nearest such light by least squares over all normals, channel by channel, to convolved coefficients. The
/// direction is that of band 1's luminance; +z if that is zero. minAmbient: the least ambient light that an engine
/// shows; where the fit has less on a channel, directed light is fitted to this.
AmbientDirected FitAmbientDirected(const bspGridPointSH_t &light, double minAmbient = 0);

/// The same with ambient + directedWeight * directed equal to the mean of the light over all normals, for engines that
/// keep one color. directedWeight above 0.
AmbientDirected FitMeanAndDirected(const bspGridPointSH_t &light, double directedWeight);

/// Mean of convolved coefficients over all normals. May be negative after lights that take light away.
Vec3d MeanLight(const bspGridPointSH_t &light);
/// Light on a surface with this unit normal, at least 0.
Vec3d LightOn(const bspGridPointSH_t &light, const Vec3d &normal);

/// Turns linear light, where 1 is byte 255, into what lightmaps would store.
class GridTone {
  public:
    /// The entities text of a map, whose key _q3map2_tone counts. A key that cannot be read warns and is plain.
    GridTone(std::string_view entities, Log &log);
    /// `tone`: a value of that key; empty: plain. Errors: it cannot be read.
    explicit GridTone(const char *tone = "");

    bool IsPlain() const;
    /// From 0 to 255, or to `_maxlight`; brighter colors are scaled down with their hue.
    Vec3d Limited(const Vec3d &light) const;
    /// The same without the upper limit, unless `_maxlight` sets one below 255.
    Vec3d Unlimited(const Vec3d &light) const;
    /// Limited, rounded.
    std::array<std::uint8_t, 3> Bytes(const Vec3d &light) const;

  private:
    shgrid_tone tone_{};
};

/// The SH grid of a file as it is stored.
struct StoredGridSH {
    LightGridSH grid;
    bool isRadiance = false; ///< not convolved with the cosine: -shradiance
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
