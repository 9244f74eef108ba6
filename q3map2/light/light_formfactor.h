// GPL-2.0-or-later. Point to polygon form factor of the established program.
#pragma once

#include "libs/math/winding.h"
#include "libs/sh/polygon_moments.h"
#include "q3map2/light/light_lanes.h"

#include <cmath>
#include <numbers>
#include <span>

namespace q3 {

/// Cosine-weighted share of the hemisphere around n that the polygon covers as seen from p, -1 to 1; positive in front
/// of a clockwise polygon. Not clipped to the horizon: parts behind the receiver count negatively.
inline float FormFactor(const Vec3f &p, const Vec3f &n, const Winding<float> &w) {
    if (w.empty())
        return 0;
    double total = 0;
    Vec3d u = Normalize(Vec3d(w[0]) - Vec3d(p));
    for (std::size_t i = 0; i < w.size(); ++i) {
        const Vec3d v = Normalize(Vec3d(w[(i + 1) % w.size()]) - Vec3d(p));
        const Vec3d c = Cross(u, v);
        const double length = Length(c);
        if (length >= 0.0001) {
            total += FastAtan2(length, Dot(u, v)) * Dot(Vec3d(n), c) / length;
            if (std::abs(total) > 6.3)
                return 0;
        }
        u = v;
    }
    return float(total / (2 * std::numbers::pi));
}

/// Edges of a polygon see no more than a full turn; more is rounding beside a degenerate one, and counts as nothing.
inline constexpr float kMostFormAngle = 6.3f;

/// atan2(y, x) for y >= 0 to 3e-7. Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49.
inline float AngleOf(float y, float x) {
    constexpr float kPi = std::numbers::pi_v<float>;
    const float across = std::abs(x), big = across > y ? across : y, small = across > y ? y : across;
    const float t = small / (big > 0 ? big : 1), t2 = t * t;
    const float series =
        -0.3333314528f +
        t2 * (0.1999355085f +
              t2 * (-0.1420889944f +
                    t2 * (0.1065626393f +
                          t2 * (-0.0752896400f + t2 * (0.0429096138f + t2 * (-0.0161657367f + t2 * 0.0028662257f))))));
    const float angle = t + t * t2 * series;
    const float acute = y > across ? 0.5f * kPi - angle : angle;
    return x < 0 ? kPi - acute : acute;
}

/// FormFactor for 16 places, in floats: f errs by about 1e-6.
void FormFactors(const Lanes3 &p, const Lanes3 &n, std::span<const Vec3f> w, Lanes &f);

} // namespace q3
