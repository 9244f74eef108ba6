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

/// Game units per texel of sides whose own axes are unusable: the scale that editors give new sides.
inline constexpr double kDefaultTextureScale = 0.5;

/// Two perpendicular unit vectors along which the texture coordinates of a side are measured.
struct ProjectionAxes {
    Vec3d s, t;
};
/// Axes of the classic form, before rotation: s along a world axis, t against one. `normal`, here and below: as in the
/// plane table, that is snapped.
ProjectionAxes ClassicAxes(const Vec3d &normal);
/// Axes of brush primitives, in the plane of the side, as GtkRadiant defines them: the texture matrix maps coordinates
/// along them to s and t.
ProjectionAxes MatrixAxes(const Vec3d &normal);

/// The projection of a side by its numbers in each of the forms.
TextureProjection ProjectClassic(const TextureAxes &texture, const Vec3d &normal, const GeometryDirectives &shader);
TextureProjection ProjectValve(const TextureAxes &texture, const GeometryDirectives &shader);
TextureProjection ProjectMatrix(const TextureMatrix &matrix, const Vec3d &normal);
/// Whether the texture covers an area on a plane of that normal. It does not if its axes are parallel there, if one is
/// along the normal, or if they are too short or too long to be used.
bool HasExtent(const TextureProjection &projection, const Vec3d &normal);
/// The classic form without rotation and shift, at the scale of editors.
TextureProjection DefaultProjection(const Vec3d &normal, const GeometryDirectives &shader);
/// The side's own projection unless the shader (tcGen) or -flat replaces it. Values of 1e30 and more become 0.
TextureProjection FinalProjection(TextureProjection own, const GeometryDirectives &shader, bool flat);

} // namespace q3
