// GPL-2.0-or-later. Texture axes of brush sides, in the three forms of the map language.
#pragma once

#include "q3map2/map/map.h"

#include <array>

namespace q3 {

/// Numbers of a classic side or, where axes are given, of a Valve 220 side.
struct TextureAxes {
    bool hasAxes = false;
    std::array<Vec3d, 2> axes{};   ///< of s and t, when given
    std::array<double, 2> shift{}; ///< texels
    double rotate = 0;             ///< degrees; classic only
    std::array<double, 2> scale{}; ///< game units per texel; 0 counts as 1
};

/// Rows (s, t) of a brush primitive's texture matrix, in units of the image.
using TextureMatrix = std::array<std::array<double, 3>, 2>;

/// `normal` is that of the plane table.
TextureProjection ProjectClassic(const TextureAxes &texture, const Vec3d &normal, const GeometryDirectives &shader);
TextureProjection ProjectValve(const TextureAxes &texture, const GeometryDirectives &shader);
TextureProjection ProjectMatrix(const TextureMatrix &matrix, const Vec3d &normal);
/// The side's own projection, or what the shader or -flat replaces it by. Numbers beyond the range of float become 0.
TextureProjection FinalProjection(TextureProjection own, const GeometryDirectives &shader, bool flat);

} // namespace q3
