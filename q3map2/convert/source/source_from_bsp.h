// GPL-2.0-or-later. Decompiles a .bsp to a map source: its brushes as convex solids, their planes, entities and
// textures.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/convert/source/texture_form.h"
#include "q3map2/map/bsp_options.h"

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A plane as map text, and as readers get it back.
struct PlanePoints {
    std::array<std::string, 3> points; ///< "( x y z )"
    Plane plane;                       ///< through the points as printed
};

/// "( x y z )" with as many digits as it takes to read back the same numbers.
std::string PointText(const Vec3d &p);
/// The plane through three points of map text; its normal is zero if they are collinear.
Plane PlaneThrough(const std::array<Vec3d, 3> &points);
/// Points whose plane rounds to the same floats as `plane`, whose own values must be floats: corners of `winding` with
/// up to 6 decimals if they reproduce it, else points 256 game units apart with up to 12. `winding` may be empty.
PlanePoints PointsOfPlane(const Plane &plane, std::span<const Vec3d> winding);

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

/// How a .bsp is decompiled.
struct DecompileOptions {
    MapForm form = MapForm::Classic;
    bool withTextures = true;   ///< false: all sides get default texture axes
    bool keepModelClip = false; ///< write the brushes that clip models
    bool markUnknown = false;   ///< sides whose texture axes are unknown get the shader common/WTF
};

/// Map source with the entities, brushes and patches of a valid .bsp; `name`: of the file, for messages. Sides get the
/// texture axes of the surfaces that cover them. Errors: Error, for entity text that cannot be read.
std::string DecompiledSource(const Bsp &bsp, std::string_view name, const DecompileOptions &options,
                             const BspContext &context);

} // namespace q3
