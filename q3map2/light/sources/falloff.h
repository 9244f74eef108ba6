// GPL-2.0-or-later. How light falls off with distance, cones of spotlights, and the curves that keys ask for.
#pragma once

#include "common/log.h"
#include "libs/math/elementary.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/light/sources/light_sources.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace q3 {

/// Inverse square and linear lights: smaller distances count as this one. Game units.
inline constexpr float kNearest = 16;
/// Polynomial lights: the same. Game units.
inline constexpr float kNearestPolynomial = 1;
/// Light of a linear light per photon, before the fade.
inline constexpr float kLinearScale = 1.0f / 8000;
/// A spotlight fades over this much at the rim of its cone. Game units.
inline constexpr float kConeFade = 32;
/// A cone at its target is this much wider than the key radius of its entity, as in NetRadiant's q3map2. Game units.
inline constexpr float kConeMargin = 16;
/// Added around cones for rounding. Game units.
inline constexpr float kConeSlack = 1;

/// Light at distance d with a factor a for the angle of incidence (1 at points without a normal), byte scale for full
/// color, by the curve of the light. With d' = max(nearest, sqrt(d^2 + extraDist^2)):
///
///     InverseSquare: a photons / d'^2
///     Linear:        a photons / 8000 - d' fade
///     Windowed:      a photons / d'^2 (1 - (d' / end)^4)^2 up to the end, 0 beyond
///     Polynomial:    a photons / (c + l e + q e^2) S((end - d') / (end - fadeFrom)), e = min(d', flatFrom)
///
/// S is the quintic smoothstep, x^3 (6 x^2 - 15 x + 10) for x clamped to 0..1: its first and second derivatives are 0
/// at both ends. The angle does not scale the fade of linear lights, as in NetRadiant's q3map2: maps rely on it.
class Falloff {
  public:
    explicit Falloff(const Light &light)
        : curve_(light.curve), photons_(light.photons), fade_(light.fade),
          extraDist2_(light.extraDist * light.extraDist), attenuation_(light.attenuation),
          perEnd4_(1 / (light.attenuation.end * light.attenuation.end * light.attenuation.end * light.attenuation.end)),
          perFade_(1 / (light.attenuation.end - light.attenuation.fadeFrom)) {}

    FalloffCurve Curve() const { return curve_; }

    float At(float distance, float angleFactor = 1) const {
        switch (curve_) {
        case FalloffCurve::Linear:
            return Linear(distance, angleFactor);
        case FalloffCurve::Windowed:
            return Windowed(distance, angleFactor);
        case FalloffCurve::Polynomial:
            return Polynomial(distance, angleFactor);
        default:
            return InverseSquare(distance, angleFactor);
        }
    }

    float InverseSquare(float distance, float angleFactor) const {
        const float d = Effective(distance, kNearest);
        return photons_ / (d * d) * angleFactor;
    }
    float Linear(float distance, float angleFactor) const {
        return angleFactor * photons_ * kLinearScale - Effective(distance, kNearest) * fade_;
    }
    float Windowed(float distance, float angleFactor) const {
        const float d = Effective(distance, kNearest), d2 = d * d;
        const float window = std::max(0.0f, 1 - d2 * d2 * perEnd4_);
        return photons_ / d2 * (window * window) * angleFactor;
    }
    float Polynomial(float distance, float angleFactor) const {
        const Attenuation &k = attenuation_;
        const float d = Effective(distance, kNearestPolynomial), e = std::min(d, k.flatFrom);
        const float x = std::min(1.0f, std::max(0.0f, (k.end - d) * perFade_));
        const float smooth = x * x * x * (x * (6 * x - 15) + 10);
        return photons_ / (k.constant + e * (k.linear + e * k.quadratic)) * smooth * angleFactor;
    }

    /// The distance beyond which At is at most `least`, without extraDist. Inverse square never falls to 0.
    float Reach(float least) const {
        if (curve_ == FalloffCurve::Linear)
            return (photons_ * kLinearScale - least) / fade_;
        if (curve_ == FalloffCurve::Polynomial)
            return std::min(attenuation_.end, least > 0 ? PolynomialReach(photons_ / least) : kSunDistance);
        const float reach = least > 0 ? std::sqrt(photons_ / least) : kSunDistance;
        return curve_ == FalloffCurve::Windowed ? std::min(attenuation_.end, reach) : reach;
    }

  private:
    float Effective(float distance, float nearest) const {
        return std::max(nearest, std::sqrt(distance * distance + extraDist2_));
    }
    /// The distance at which the polynomial c + l d + q d^2 reaches a value, if it grows all the way; else
    /// kSunDistance.
    float PolynomialReach(float value) const {
        const float l = attenuation_.linear, q = attenuation_.quadratic, rise = value - attenuation_.constant;
        if (l < 0 || q < 0 || (l == 0 && q == 0 && rise > 0))
            return kSunDistance;
        if (rise <= 0 || rise <= l + q) // already reached at kNearestPolynomial, 1
            return 0;
        return std::min(kSunDistance,
                        2 * rise / (l + std::sqrt(l * l + 4 * q * rise))); // the root without cancellation
    }

    FalloffCurve curve_;
    float photons_, fade_, extraDist2_;
    Attenuation attenuation_;
    float perEnd4_, perFade_;
};

/// Fraction of a spotlight that its cone lets through toward a point; `toLight`: from there to the light, game units.
///
/// A cone by radius, with h the distance along the axis, r = h radiusByDist the radius of the cone there and s the
/// distance from the axis: 1 for s < r - 32, (r - s) / 32 up to the rim, 0 beyond.
///
/// A cone by angles, with c the cosine to the axis: c (min(1, (c - outer) / (inner - outer)))^exponent, 0 for c <=
/// outer.
inline float ConeFraction(const Light &light, const Vec3f &toLight) {
    const float along = -Dot(toLight, light.normal);
    if (along < 0)
        return 0;
    if (light.cone.byAngles) {
        const float distance = Length(toLight), cosine = distance > 0 ? along / distance : 0;
        const SpotCone &cone = light.cone;
        if (cosine <= cone.cosOuter)
            return 0;
        const float fringe = cosine < cone.cosInner ? (cosine - cone.cosOuter) / (cone.cosInner - cone.cosOuter) : 1;
        return cosine * (cone.exponent == 1 ? fringe : Pow(fringe, cone.exponent));
    }
    const float coneRadius = light.radiusByDist * along;
    const float off = Length(-toLight - light.normal * along);
    if (off >= coneRadius)
        return 0;
    return off > coneRadius - kConeFade ? (coneRadius - off) / kConeFade : 1;
}

/// Whether a cone by angles has no point in common with a sphere. Game units.
inline bool ConeMisses(const Light &light, const Vec3f &center, float radius) {
    if (!light.cone.byAngles)
        return false;
    const Vec3f offset = center - light.origin;
    const float along = Dot(offset, light.normal), off = Length(offset - light.normal * along),
                cosine = light.cone.cosOuter;
    // Distance of the center from the cone's side: off cos a - along sin a, a the half angle.
    return off * cosine - along * std::sqrt(1 - cosine * cosine) > radius + kConeSlack;
}

/// How messages name a light: editors find it by its position.
std::string LightLabel(const Entity &entity);

/// The curve of _fifty_percent_distance: 1 / polynomial is 1/2 at `fifty`. The polynomial is a multiple of that through
/// (0, 1), (fifty, m), (zero, 256) with m = 2, or the next larger m, in steps of 5 % of the way to the straight line,
/// whose slope at distance 1 is not negative. `hard`: a fade to nothing at `zero`; else a curve with its vertex at a
/// distance over 0 stays as it is there from the vertex on, and fades to nothing at 10 times its distance. Empty if the
/// polynomial is not positive at all distances that count, or `fifty` is below 1. The distances differ. Game units.
std::optional<Attenuation> FiftyPercentCurve(double fifty, double zero, bool hard);

/// Sets curve and attenuation of a light by the keys of kFalloffKeys, if there are any, and multiplies its photons by
/// what makes its intensity light in byte values; `byQuad`: the intensity is that of a color and brightness. True if
/// the photons are for byte values, false if they are still to be multiplied by the scale of point lights or
/// spotlights. Errors: distances without a curve.
bool SetCurve(const Entity &entity, bool byQuad, Light &light, Log &log);

/// Whether the brightness of a light is in byte values, as in Source: its _light is a color and a brightness, or keys
/// for falloff make it so.
bool CountsInBytes(const Entity &entity);

} // namespace q3
