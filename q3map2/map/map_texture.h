// GPL-2.0-or-later. Texture axes of brush sides, in the three forms of the map format.
#pragma once

#include "q3map2/map/map.h"

#include <array>

namespace q3 {

/// Numbers of a classic side or, where axes are given, of a Valve 220 side.
struct TextureAxes {
    bool hasAxes = false;
    std::array<Vec3d, 2> axes{};   ///< axes of s and t, if hasAxes
    std::array<double, 2> shift{}; ///< texels
    double rotate = 0;             ///< degrees; classic only
    std::array<double, 2> scale{}; ///< game units per texel; 0 counts as 1
};

/// Rows (s, t) of the texture matrix of brushDef and brushDef3, in units of the image size.
using TextureMatrix = std::array<std::array<double, 3>, 2>;

/// Two perpendicular unit vectors along which a side's texture coordinates are counted.
struct ProjectionAxes {
    Vec3d s, t;
};
/// Those of the classic form, before rotation: the world axis that s goes along, and the opposite of the one for t.
/// `normal`: as in the plane table, that is snapped, here and below.
ProjectionAxes ClassicAxes(const Vec3d &normal);
/// Those that the numbers of a brush primitive's texture matrix are factors of; they lie in the plane.
ProjectionAxes MatrixAxes(const Vec3d &normal);

TextureProjection ProjectClassic(const TextureAxes &texture, const Vec3d &normal, const GeometryDirectives &shader);
TextureProjection ProjectValve(const TextureAxes &texture, const GeometryDirectives &shader);
TextureProjection ProjectMatrix(const TextureMatrix &matrix, const Vec3d &normal);
/// The side's own projection unless the shader (tcGen) or -flat replaces it. Values of 1e30 and more become 0.
TextureProjection FinalProjection(TextureProjection own, const GeometryDirectives &shader, bool flat);

} // namespace q3
