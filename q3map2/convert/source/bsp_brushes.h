// GPL-2.0-or-later. Brushes of a .bsp as convex solids.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"

#include <string_view>
#include <vector>

namespace q3 {

/// A side that bounds its brush.
struct RebuiltSide {
    std::string_view shader; ///< of the .bsp
    Plane plane;
    Winding<double> winding; ///< at least three corners
};

/// Whether the side has no shader of a map source: bevels, and what compilers add to brushes that they make.
bool IsUnnamed(std::string_view shader);
/// Name of the shader of side `i` of a valid .bsp.
std::string_view SideShader(const Bsp &bsp, std::size_t i);
/// A brush that the compiler made to clip a model: at most one side has a name.
bool IsModelClip(const Bsp &bsp, const bspBrush_t &brush);
/// The sides of a brush without bevels, with their polygons, in an order that compiles to that of the .bsp. Of model
/// clip all sides count, of others those with a name. Empty when they enclose nothing or reach out of the world.
std::vector<RebuiltSide> RebuildBrush(const Bsp &bsp, const bspBrush_t &brush);
/// For each brush whether a leaf that is not solid holds it: structural solids lie in solid leafs only.
std::vector<bool> BrushesInTheOpen(const Bsp &bsp);

} // namespace q3
