// GPL-2.0-or-later. Point to polygon form factor of the established program.
#pragma once

#include "libs/math/winding.h"
#include "libs/sh/polygon_moments.h"
#include "q3map2/light/batch/lanes.h"

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

/// FormFactor for 16 receivers, in floats: f errs by about 1e-6.
void FormFactors(const Lanes3 &p, const Lanes3 &n, std::span<const Vec3f> w, Lanes &f);

} // namespace q3
