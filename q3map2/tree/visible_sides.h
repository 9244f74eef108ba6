// GPL-2.0-or-later. Which parts of brush sides are drawn: not those that other brushes cover, nor those outside.
#pragma once

#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map.h"
#include "q3map2/tree/tree.h"

#include <vector>

namespace q3 {

/// Sets `culled` of sides that other brushes of the entity cover.
void CullSides(MapEntity &entity, const PlaneTable &planes, const BspContext &context);

/// The convex hull of polygons in one plane, clockwise seen from the tip of its normal.
Polygon ConvexHull(std::vector<Polygon> pieces, const Vec3d &normal);

/// Sets the visible hull of each side: the convex hull of its parts in open leafs. Returns the sides that walls divide,
/// with their parts. Call it after CullSides.
SideParts ClipSidesIntoTree(MapEntity &entity, const Tree &tree, const PlaneTable &planes, const BspContext &context);

/// Finds brush sides whose visible part is divided by walls.
class VisibleParts {
  public:
    /// `brushes`: those of the entity, of which opaque detail brushes are walls. Keeps references.
    VisibleParts(const std::deque<Brush> &brushes, const PlaneTable &planes);

    /// The parts of a side between walls: the convex hulls of its connected pieces. Empty if it is in one part, or if
    /// hulls of its parts touch. `pieces`: the convex parts of the side in open leafs of the tree.
    std::vector<Polygon> Of(const Brush &brush, const BrushSide &side, std::vector<Polygon> pieces) const;

  private:
    std::vector<Polygon> OutsideOf(const Brush &wall, const Polygon &polygon) const;
    void CutOutDetail(const Brush &brush, const BrushSide &side, std::vector<Polygon> &pieces) const;

    const PlaneTable &planes_;
    std::vector<const Brush *> walls_; ///< opaque detail brushes, by the least x of their bounds
};

} // namespace q3
