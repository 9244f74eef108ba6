// GPL-2.0-or-later. Texture projections as numbers of the three forms of the map language.
#pragma once

#include "q3map2/map/map.h"

#include <span>
#include <string>
#include <vector>

namespace q3 {

/// How the sides of brushes say where their texture is.
enum class MapForm {
    Classic,   ///< shift, rotation and scale along world axes; cannot shear
    Primitive, ///< brush primitives: a matrix in the plane
    Valve      ///< Valve 220: two axes
};

/// A side whose texture is to be written.
struct TextureRequest {
    TextureProjection projection;
    Plane plane;  ///< through the points that are written
    Vec3d normal; ///< that the plane table has for it: readers choose axes by it
    const GeometryDirectives &shader;
    std::span<const Vec3d> corners; ///< where coordinates must agree; none: the numbers get all their digits
    double tolerance = 1e-6;        ///< texels
};

/// Numbers in the order in which the form has them.
struct TextureWords {
    std::vector<std::string> words;
    double error = 0; ///< largest difference at a corner, texels
};

/// The numbers, with as few digits as the tolerance allows. A texture without extent, which the classic and the Valve
/// form cannot hold, gets default axes and an infinite error.
TextureWords TextureInForm(MapForm form, const TextureRequest &request);
/// What a side gets whose texture is unknown: `scale` game units a texel, for an image of 64 texels.
std::vector<std::string> DefaultTexture(MapForm form, const Vec3d &normal, double scale);

/// The number without an exponent, rounded to so many decimals, without zeros at the end.
std::string FixedText(double value, int decimals);
/// The shortest text that reads as the same number, without an exponent.
std::string ExactText(double value);
std::string ExactText(float value);

} // namespace q3
