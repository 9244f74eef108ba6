// GPL-2.0-or-later. Directions along which texture coordinates grow on a triangle.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <cmath>
#include <optional>

namespace q3 {

/// Unit vectors along which s and t grow.
struct TextureAxes {
    Vec3f s, t;
};

/// The texture axes of a triangle; none if it has no area in texture space.
inline std::optional<TextureAxes> TextureAxesOf(const SurfaceVertex &a, const SurfaceVertex &b,
                                                const SurfaceVertex &c) {
    constexpr float kLeastArea = 1e-8f; // in textures squared
    const float s1 = b.st[0] - a.st[0], t1 = b.st[1] - a.st[1], s2 = c.st[0] - a.st[0], t2 = c.st[1] - a.st[1];
    const float area = s1 * t2 - s2 * t1;
    if (!(std::abs(area) >= kLeastArea))
        return std::nullopt;
    const Vec3f ab = b.xyz - a.xyz, ac = c.xyz - a.xyz;
    const TextureAxes axes{Normalize((ab * t2 - ac * t1) / area), Normalize((ac * s1 - ab * s2) / area)};
    if (!IsFinite(axes.s) || !IsFinite(axes.t))
        return std::nullopt;
    return axes;
}

} // namespace q3
