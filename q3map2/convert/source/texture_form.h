// GPL-2.0-or-later. Texture projections as the numbers of the three forms of map text.
#pragma once

#include "q3map2/map/map.h"

#include <span>
#include <string>
#include <vector>

namespace q3 {

/// How brush sides in map text give their texture projection.
enum class MapForm {
    Classic,   ///< shift, rotation and scale along world axes; cannot shear
    Primitive, ///< brush primitives: a matrix along two axes in the side's plane
    Valve      ///< Valve 220: two free axes, with shift and scale
};

/// What TextureInForm needs of a side.
struct TextureRequest {
    TextureProjection projection;
    Plane plane;  ///< through the points that are written
    Vec3d normal; ///< of the plane in the plane table, by which readers choose texture axes
    const GeometryDirectives &shader;
    std::span<const Vec3d> corners; ///< where coordinates must agree; empty: numbers get all digits
    double tolerance = 1e-6;        ///< largest difference at a corner, texels
};

/// The numbers of a side's texture as text, in the order of the form.
struct TextureWords {
    std::vector<std::string> words;
    double error = 0; ///< largest difference at a corner, texels
};

/// The numbers, with as few digits as the tolerance allows. A projection with constant s or t, which the classic and
/// the Valve form cannot hold, gets default axes and an infinite error.
TextureWords TextureInForm(MapForm form, const TextureRequest &request);
/// For a side whose texture is unknown: `scale` game units a texel, which brush primitives have for images of 64 texels
/// only.
std::vector<std::string> DefaultTexture(MapForm form, const Vec3d &normal, double scale);

/// The number rounded to `decimals`, without an exponent or trailing zeros.
std::string FixedText(double value, int decimals);
/// The shortest text that reads as the same number, without an exponent.
std::string ExactText(double value);
std::string ExactText(float value);

} // namespace q3
