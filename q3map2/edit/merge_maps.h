// GPL-2.0-or-later. Two maps in one.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/edit/scale_shift.h"

#include <cstddef>
#include <string_view>
#include <vector>

namespace q3 {

/// The surfaces and brushes that each leaf of a map lists, to which more can be added.
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

/// A map and its name in messages.
struct NamedBsp {
    const Bsp &bsp;
    std::string_view name;
};

/// `main` with the entities and inline models of `added` and, with MergeOptions::world, its world: surfaces and brushes
/// are listed in the leafs of `main` that they reach into. Tree, visibility, light grids and world bounds are those of
/// `main`. Without the world nothing of it is taken but the brushes of fogs.
Bsp MergeMaps(const NamedBsp &main, const NamedBsp &added, const MergeOptions &options, Log &log);

} // namespace q3
