// GPL-2.0-or-later. Form factors of one polygon for the receivers of a batch.
#include "q3map2/light/batch/form_factor.h"

namespace q3 {

Q3_VECTOR void FormFactors(const Lanes3 &p, const Lanes3 &n, std::span<const Vec3f> polygon, Lanes &f) {
    Lanes total{};
    LaneMask wrong{};
    Lanes3 u;
    Vec3f last = polygon.empty() ? Vec3f{} : polygon.back();
    for (const std::size_t i : kEachLane)
        u.x[i] = last.x - p.x[i], u.y[i] = last.y - p.y[i], u.z[i] = last.z - p.z[i];
    for (const Vec3f &corner : polygon) {
        const Vec3f edge = corner - last;
        last = corner;
        for (const std::size_t i : kEachLane) {
            const float ux = u.x[i], uy = u.y[i], uz = u.z[i];
            const float vx = corner.x - p.x[i], vy = corner.y - p.y[i], vz = corner.z - p.z[i];
            // u x v = u x edge, since v = u + edge; this avoids the cancellation in u x v when the receiver is far
            // away.
            const float cx = uy * edge.z - uz * edge.y, cy = uz * edge.x - ux * edge.z, cz = ux * edge.y - uy * edge.x;
            const float sine = std::sqrt(cx * cx + cy * cy + cz * cz), cosine = ux * vx + uy * vy + uz * vz;
            total[i] += EdgeTerm(sine, cosine, n.x[i] * cx + n.y[i] * cy + n.z[i] * cz);
            wrong[i] |= std::abs(total[i]) > kMaxEdgeSum ? -1 : 0;
            u.x[i] = vx, u.y[i] = vy, u.z[i] = vz;
        }
    }
    constexpr float kScale = 0.5f / std::numbers::pi_v<float>;
    for (const std::size_t i : kEachLane)
        f[i] = wrong[i] != 0 ? 0 : total[i] * kScale;
}

Q3_VECTOR void FormFactorVectors(const Lanes3 &p, std::span<const Vec3f> polygon, Lanes3 &v) {
    Lanes3 u, sum{}; // summed apart from `v`, which may alias `p`

    Vec3f last = polygon.empty() ? Vec3f{} : polygon.back();
    for (const std::size_t i : kEachLane)
        u.x[i] = last.x - p.x[i], u.y[i] = last.y - p.y[i], u.z[i] = last.z - p.z[i];
    constexpr float kScale = 0.5f / std::numbers::pi_v<float>;
    for (const Vec3f &corner : polygon) {
        const Vec3f edge = corner - last;
        last = corner;
        for (const std::size_t i : kEachLane) {
            const float ux = u.x[i], uy = u.y[i], uz = u.z[i];
            const float vx = corner.x - p.x[i], vy = corner.y - p.y[i], vz = corner.z - p.z[i];
            const float cx = uy * edge.z - uz * edge.y, cy = uz * edge.x - ux * edge.z, cz = ux * edge.y - uy * edge.x;
            const float sine = std::sqrt(cx * cx + cy * cy + cz * cz), cosine = ux * vx + uy * vy + uz * vz;
            const float angle = EdgeTerm(sine, cosine, kScale);
            sum.x[i] += angle * cx, sum.y[i] += angle * cy, sum.z[i] += angle * cz;
            u.x[i] = vx, u.y[i] = vy, u.z[i] = vz;
        }
    }
    v = sum;
}

} // namespace q3
