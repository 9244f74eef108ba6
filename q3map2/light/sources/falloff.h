// GPL-2.0-or-later. How light falls off with distance, and cones of spotlights.
#pragma once

#include "q3map2/light/sources/light_sources.h"

#include <algorithm>
#include <cmath>

namespace q3 {

/// Smaller distances count as this one. Game units.
inline constexpr float kNearest = 16;
/// Light of a linear light per photon, before the fade.
inline constexpr float kLinearScale = 1.0f / 8000;
/// A spotlight fades over this much at the rim of its cone. Game units.
inline constexpr float kConeFade = 32;

/// Light at distance d with a factor a for the angle of incidence (1 at points without a normal), byte scale for full
/// color. With d' = max(16, sqrt(d^2 + extraDist^2)):
///
///     inverse square: a photons / d'^2
///     linear:         a photons / 8000 - d' fade
///
/// The angle does not scale the fade, as in the established program: maps rely on it.
class Falloff {
  public:
    explicit Falloff(const Light &light)
        : linear_(light.linear), photons_(light.photons), fade_(light.fade),
          extraDist2_(light.extraDist * light.extraDist) {}

    float At(float distance, float angle = 1) const {
        const float d = std::max(kNearest, std::sqrt(distance * distance + extraDist2_));
        return linear_ ? angle * photons_ * kLinearScale - d * fade_ : photons_ / (d * d) * angle;
    }
    /// The distance beyond which At is at most `least`, without extraDist. Inverse square never falls to 0.
    float Reach(float least) const {
        if (linear_)
            return (photons_ * kLinearScale - least) / fade_;
        return least > 0 ? std::sqrt(photons_ / least) : kSunDistance;
    }

  private:
    bool linear_;
    float photons_, fade_, extraDist2_;
};

/// Share of a spotlight that its cone lets through toward a point; `toLight`: from there to the light, game units. With
/// h the distance along the axis, r = h radiusByDist the radius of the cone there and s the distance from the axis:
/// 1 for s < r - 32, (r - s) / 32 up to the rim, 0 beyond.
inline float ConeShare(const Light &light, const Vec3f &toLight) {
    const float along = -Dot(toLight, light.normal);
    if (along < 0)
        return 0;
    const float coneRadius = light.radiusByDist * along;
    const float off = Length(-toLight - light.normal * along);
    if (off >= coneRadius)
        return 0;
    return off > coneRadius - kConeFade ? (coneRadius - off) / kConeFade : 1;
}

} // namespace q3
