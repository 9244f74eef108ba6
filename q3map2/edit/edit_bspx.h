// GPL-2.0-or-later. What scaling, moving and merging do with each BSPX lump that Bsp has a member for.
#pragma once

#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/edit/edit_lumps.h"

#include <span>
#include <string_view>

namespace q3 {

/// What a lump says about places.
enum class LumpSpace {
    None,      ///< light at records of the map
    Directions ///< light by direction: that of another shape once axes are scaled by different factors
};

/// An edit of a lump. A null function leaves it as it is.
struct LumpEdit {
    BspxId id;
    LumpSpace space;
    void (*transform)(const AxisTransform &transform, Bsp &bsp); ///< only for maps that have the lump
    /// Makes the lump of LumpMerge::bsp, which begins as that of `main`.
    void (*merge)(const LumpMerge &maps);
};

/// A row for each lump, in the order in which they are merged.
std::span<const LumpEdit> LumpEdits();

/// Warns that light grids are those of the main map, if it lacks one that the other has. `what`: the grid.
void WarnOfLostGrid(const LumpMerge &maps, bool inMain, bool inAdded, std::string_view what);

/// Whether the map has lumps of LumpSpace::Directions.
bool HasDirections(const Bsp &bsp);

} // namespace q3
