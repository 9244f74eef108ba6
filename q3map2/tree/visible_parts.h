// GPL-2.0-or-later. Brush sides whose visible parts lie apart.
#pragma once

#include "q3map2/map/map.h"

#include <vector>

namespace q3 {

/// Parts of a side that walls keep apart: the convex hulls of its connected pieces. Empty if the side is in one part,
/// or the hulls of its parts touch.
class VisibleParts {
  public:
    /// Keeps references; brushes: of the entity, for detail walls.
    VisibleParts(const std::deque<Brush> &brushes, const PlaneTable &planes);

    /// pieces: convex parts of the side in open leafs of the tree.
    std::vector<Polygon> Of(const Brush &brush, const BrushSide &side, std::vector<Polygon> pieces) const;

  private:
    void CutOutDetail(const Brush &own, const BrushSide &side, std::vector<Polygon> &pieces) const;

    const PlaneTable &planes_;
    std::vector<const Brush *> walls_; ///< opaque detail brushes, by the least x of their bounds
};

} // namespace q3
