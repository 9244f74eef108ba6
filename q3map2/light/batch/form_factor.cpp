// GPL-2.0-or-later. Form factors of polygons, and directions in rings over a hemisphere.
#include "q3map2/light/batch/form_factor.h"

#include <cmath>
#include <numbers>

namespace q3 {

// ---- Form factors of one polygon for the receivers of a batch ----

namespace {

/// An edge of a polygon as a receiver sees it: u and v point to its ends.
struct SeenEdge {
    Vec3f cross; ///< u x v
    float sine, cosine;

    // u x v = u x edge, since v = u + edge; this avoids the cancellation in u x v when the receiver is far away.
    SeenEdge(const Vec3f &u, const Vec3f &v, const Vec3f &edge)
        : cross(Cross(u, edge)), sine(Length(cross)), cosine(Dot(u, v)) {}
    float Term(float along) const { return EdgeTerm(sine, cosine, along); }
};

} // namespace

void FormFactors(const Lanes3 &p, const Lanes3 &n, std::span<const Vec3f> polygon, Lanes &formFactors) {
    Vectorize([&]() Q3_INLINE {
        Lanes total{};
        LaneMask wrong{};
        Lanes3 u;
        Vec3f last = polygon.empty() ? Vec3f{} : polygon.back();
        for (const std::size_t i : kEachLane)
            u.Set(i, last - p[i]);
        for (const Vec3f &corner : polygon) {
            const Vec3f edge = corner - last;
            last = corner;
            for (const std::size_t i : kEachLane) {
                const Vec3f to = corner - p[i];
                const SeenEdge seen(u[i], to, edge);
                total[i] += seen.Term(Dot(n[i], seen.cross));
                wrong[i] |= std::abs(total[i]) > kMaxEdgeSum ? -1 : 0;
                u.Set(i, to);
            }
        }
        constexpr float kScale = 0.5f / std::numbers::pi_v<float>;
        for (const std::size_t i : kEachLane)
            formFactors[i] = wrong[i] != 0 ? 0 : total[i] * kScale;
    });
}

void FormFactorVectors(const Lanes3 &p, std::span<const Vec3f> polygon, Lanes3 &v) {
    Vectorize([&]() Q3_INLINE {
        Lanes3 u, sum{}; // summed apart from `v`, which may alias `p`
        Vec3f last = polygon.empty() ? Vec3f{} : polygon.back();
        for (const std::size_t i : kEachLane)
            u.Set(i, last - p[i]);
        constexpr float kScale = 0.5f / std::numbers::pi_v<float>;
        for (const Vec3f &corner : polygon) {
            const Vec3f edge = corner - last;
            last = corner;
            for (const std::size_t i : kEachLane) {
                const Vec3f to = corner - p[i];
                const SeenEdge seen(u[i], to, edge);
                const float angle = seen.Term(kScale);
                sum.x[i] += angle * seen.cross.x, sum.y[i] += angle * seen.cross.y, sum.z[i] += angle * seen.cross.z;
                u.Set(i, to);
            }
        }
        v = sum;
    });
}

void FormFactorVectorsAbove(const Lanes3 &p, const Lanes3 &n, std::span<const Vec3f> polygon, Lanes3 &v) {
    Vectorize([&]() Q3_INLINE {
        // A convex polygon leaves the half space above a horizon once and enters it once; an edge on the horizon joins
        // the two places.
        Lanes3 from, sum{}, left{}, entered{};
        Lanes fromHeight;
        const Vec3f last = polygon.empty() ? Vec3f{} : polygon.back();
        for (const std::size_t i : kEachLane) {
            from.Set(i, last - p[i]);
            fromHeight[i] = Dot(from[i], n[i]);
        }
        constexpr float kScale = 0.5f / std::numbers::pi_v<float>;
        const auto addEdge = [&](std::size_t i, const Vec3f &u, const Vec3f &w, float factor) {
            const SeenEdge seen(u, w, w - u);
            const float angle = seen.Term(kScale) * factor;
            sum.x[i] += angle * seen.cross.x, sum.y[i] += angle * seen.cross.y, sum.z[i] += angle * seen.cross.z;
        };
        for (const Vec3f &corner : polygon)
            for (const std::size_t i : kEachLane) {
                const Vec3f u = from[i], w = corner - p[i];
                const float hu = fromHeight[i], hw = Dot(w, n[i]);
                const bool uAbove = hu > 0, wAbove = hw > 0;
                const float fall = hu - hw, along = hu / (fall != 0 ? fall : 1);
                const Vec3f crossing = u + (w - u) * along;
                const Vec3f begin = uAbove ? u : crossing, end = wAbove ? w : crossing;
                addEdge(i, begin, end, (uAbove | wAbove) ? 1.0f : 0.0f);
                left.Set(i, (uAbove & !wAbove) ? crossing : left[i]);
                entered.Set(i, (!uAbove & wAbove) ? crossing : entered[i]);
                from.Set(i, w);
                fromHeight[i] = hw;
            }
        for (const std::size_t i : kEachLane)
            addEdge(i, left[i], entered[i], 1);
        v = sum;
    });
}

// ---- Directions in rings over a hemisphere ----

std::vector<Vec3f> HemisphereRings(int elevations, int azimuths) {
    std::vector<Vec3f> directions;
    const double step = kConeDegrees / elevations, radiansPerDegree = std::numbers::pi / 180;
    constexpr double kRounding = 1e-12; // smaller components are rounding error of 0
    const auto component = [](double c) { return std::abs(c) < kRounding ? 0.0f : float(c); };
    for (int e = 0; e < elevations; ++e)
        for (int a = 0; a < azimuths; ++a) {
            const double polarAngle = (e + 0.5) * step * radiansPerDegree,
                         azimuth = a * 2 * std::numbers::pi / azimuths;
            directions.emplace_back(component(std::sin(polarAngle) * std::cos(azimuth)),
                                    component(std::sin(polarAngle) * std::sin(azimuth)), float(std::cos(polarAngle)));
        }
    return directions;
}

} // namespace q3
