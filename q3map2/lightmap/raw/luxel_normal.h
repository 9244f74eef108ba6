// GPL-2.0-or-later. Normals and tangents of luxels: normal maps, texture axes, debug colors.
#pragma once

#include "common/image/image.h"
#include "libs/math/vec.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace q3 {

/// Unit vectors along which the texture coordinates s and t grow.
struct TangentAxes {
    Vec3f s, t;
};

/// The texture axes of a triangle; none if it has no area in texture space.
inline std::optional<TangentAxes> TangentAxesOf(const SurfaceVertex &a, const SurfaceVertex &b,
                                                const SurfaceVertex &c) {
    constexpr float kLeastTwiceArea = 1e-8f; // in square textures
    const float s1 = b.st[0] - a.st[0], t1 = b.st[1] - a.st[1], s2 = c.st[0] - a.st[0], t2 = c.st[1] - a.st[1];
    const float twiceArea = s1 * t2 - s2 * t1;
    if (!(std::abs(twiceArea) >= kLeastTwiceArea))
        return std::nullopt;
    // Solves ab = s1 S + t1 T and ac = s2 S + t2 T for the axes S and T.
    const Vec3f ab = b.xyz - a.xyz, ac = c.xyz - a.xyz;
    const TangentAxes axes{Normalize((ab * t2 - ac * t1) / twiceArea), Normalize((ac * s1 - ab * s2) / twiceArea)};
    if (!IsFinite(axes.s) || !IsFinite(axes.t))
        return std::nullopt;
    return axes;
}

/// A unit vector as a color: components -1 to 1 become 0 to 255.
inline Vec3f VectorColor(const Vec3f &v) {
    return (v + Vec3f{1, 1, 1}) * 127.5f;
}

/// A position as a color: its coordinates in the box, 0 to 255.
inline Vec3f PositionColor(const Vec3f &position, const Boundsf &box) {
    Vec3f color;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float size = box.maxs[axis] - box.mins[axis];
        color[axis] = size > 0 ? 255 * std::clamp((position[axis] - box.mins[axis]) / size, 0.0f, 1.0f) : 0;
    }
    return color;
}

/// The normal map of one triangle.
class NormalMap {
  public:
    /// Not active without an image, or if the triangle has no area in texture space. Keeps a pointer to the image.
    NormalMap(const NormalImage &normals, const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c);
    bool Active() const { return image_ != nullptr; }
    /// The vertex normal N perturbed by the nearest texel; call only if active. S and T are the texture axes.
    /// q3map_normalImage: Normalize(N + r S + g T + b N), with r, g, b in [-1, 1] from red, green and blue.
    /// q3map_ssbumpImage: Normalize(x S + y T + z N), with (x, y, z) the sum of the basis vectors of
    /// libs/math/rnm_basis.h times the channels; N where all are black.
    Vec3f Perturbed(const SurfaceVertex &v) const;

  private:
    const Image *image_;
    bool ssbump_;
    Vec3f s_, t_; ///< unit vectors along which the texture coordinates s and t grow
};

/// Sets the tangents of the raw lightmaps that have basis channels: the mean texture axis of the triangles that pass
/// through a luxel. Mapped luxels that no triangle covers take the mean of their neighbors. Call after MapLuxels.
void FindTangents(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
