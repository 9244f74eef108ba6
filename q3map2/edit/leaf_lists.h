// GPL-2.0-or-later. Lists of surfaces and brushes in leafs, to which more are added.
#pragma once

#include "libs/math/bounds.h"
#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <vector>

namespace q3 {

/// The lists of a map with room to grow.
class LeafLists {
  public:
    explicit LeafLists(const Bsp &bsp);
    /// Adds the number to every open leaf that the box reaches into. An empty box is in none.
    void AddSurface(int number, const Boundsf &box);
    /// Adds the number to every leaf that the box reaches into.
    void AddBrush(int number, const Boundsf &box);
    /// Writes the lists of all leafs anew.
    void Store(Bsp &bsp) const;

  private:
    std::vector<std::size_t> LeafsIn(const Boundsf &box) const;

    const Bsp &bsp_;
    std::vector<std::vector<int>> surfaces_, brushes_; ///< by leaf
};

} // namespace q3
