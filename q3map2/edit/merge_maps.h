// GPL-2.0-or-later. Two maps in one.
#pragma once

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/edit/edit_options.h"

#include <string_view>

namespace q3 {

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
