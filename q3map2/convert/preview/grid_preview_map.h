// GPL-2.0-or-later. Open space of a map, and sample positions in it. Internal to the grid preview.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"

#include <functional>
#include <vector>

namespace q3 {

/// The space of a map that players can be in: open leafs that a player start or an item can see by the visibility data
/// (all open leafs without such entities or data), without the solid brushes in them. What lies behind skies or in
/// separate rooms counts as solid. The Bsp must outlive it.
class PreviewMap {
  public:
    explicit PreviewMap(const Bsp &bsp);

    bool IsOpen(const Vec3f &position) const;
    /// Open, with solid other than sky at most 128 units below: where things can stand.
    bool IsOverFloor(const Vec3f &position) const;
    /// Height at which the largest area is over a floor; the middle of the space when none is.
    float BestHeight() const;
    /// Rectangle (in x and y) of what is open at that height; the whole space when nothing is.
    Boundsf OpenArea(float height) const;

    /// Up to `count` open positions, spread over the map by farthest-point choice; distances count more where
    /// `strength` (of a position, >= 0) is large. In reading order: north first.
    std::vector<Vec3f> ChoosePositions(std::size_t count, const std::function<float(const Vec3f &)> &strength) const;

  private:
    const bspLeaf_t &LeafAt(const Vec3f &position) const;
    /// Solid brush of the leaf that holds the position; null when there is none.
    const bspBrush_t *BrushAt(const bspLeaf_t &leaf, const Vec3f &position) const;
    /// Lowers `budget` by the number of planes it tests; false when it runs out.
    bool InBrush(const bspBrush_t &brush, const Vec3f &position, std::int32_t &budget) const;
    bool HasClearance(const Vec3f &position) const;
    std::vector<Vec3f> Candidates() const;

    const Bsp &bsp_;
    std::vector<bool> arena_; ///< by cluster: players can see it; empty: all
    Boundsf space_;           ///< around player starts and items; the world bounds when there are none
};

} // namespace q3
