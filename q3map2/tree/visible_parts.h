// GPL-2.0-or-later. Brush sides whose visible parts lie apart.
#pragma once

#include "q3map2/map/map.h"

#include <vector>

namespace q3 {

/// Finds brush sides whose visible part is divided by walls.
class VisibleParts {
  public:
    /// brushes: those of the entity, of which opaque detail brushes are walls. Keeps references.
    VisibleParts(const std::deque<Brush> &brushes, const PlaneTable &planes);

    /// The parts of a side between walls: the convex hulls of its connected pieces. Empty if it is in one part, or if
    /// hulls of its parts touch. pieces: the convex parts of the side in open leafs of the tree.
    std::vector<Polygon> Of(const Brush &brush, const BrushSide &side, std::vector<Polygon> pieces) const;

  private:
    std::vector<Polygon> OutsideOf(const Brush &wall, const Polygon &polygon) const;
    void CutOutDetail(const Brush &own, const BrushSide &side, std::vector<Polygon> &pieces) const;

    const PlaneTable &planes_;
    std::vector<const Brush *> walls_; ///< opaque detail brushes, by the least x of their bounds
};

} // namespace q3
