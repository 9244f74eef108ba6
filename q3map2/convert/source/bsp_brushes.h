// GPL-2.0-or-later. Brushes of a .bsp as convex solids.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"

#include <string_view>
#include <vector>

namespace q3 {

/// A brush side with the polygon that the other sides leave of its plane.
struct RebuiltSide {
    std::string_view shader; ///< name in the .bsp
    Plane plane;
    Winding<double> winding; ///< at least three corners
};

/// Whether the shader name is a placeholder (empty, noshader, default): sides with one are bevels, or sides of brushes
/// that the compiler made.
bool IsUnnamed(std::string_view shader);
/// Shader name of brush side `i` of a valid .bsp.
std::string_view SideShader(const Bsp &bsp, std::size_t i);
/// Whether the compiler made the brush to clip a model: at most one side has a named shader.
bool IsModelClip(const Bsp &bsp, const bspBrush_t &brush);
/// The sides of a brush with their polygons, without bevels (model clip: all sides), in an order that compiles to the
/// order in the .bsp. Empty if they enclose no volume or reach outside the world.
std::vector<RebuiltSide> RebuildBrush(const Bsp &bsp, const bspBrush_t &brush);
/// For each brush whether a non-solid leaf lists it. Structural solids are in solid leafs only.
std::vector<bool> BrushesInTheOpen(const Bsp &bsp);

} // namespace q3
