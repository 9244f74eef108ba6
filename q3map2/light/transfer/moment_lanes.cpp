// GPL-2.0-or-later. Moments of one polygon as the receivers of a batch see it: the formulas of polygon_moments.h,
// laid out for vector code.
#include "q3map2/light/transfer/moment_lanes.h"

#include "libs/math/lane_functions.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace q3 {

Q3_VECTOR void MomentLanes::SeenCorner::See(Vec3f corner, const Lanes3 &receivers) {
    Q3_INDEPENDENT
    for (const std::size_t i : kEachLane) {
        const double wx = double(corner.x) - double(receivers.x[i]), wy = double(corner.y) - double(receivers.y[i]),
                     wz = double(corner.z) - double(receivers.z[i]);
        const double l = std::sqrt(wx * wx + wy * wy + wz * wz), divisor = l > 0 ? l : 1;
        x[i] = wx, y[i] = wy, z[i] = wz;
        dx[i] = wx / divisor, dy[i] = wy / divisor, dz[i] = wz / divisor;
        length[i] = l;
    }
}

void MomentLanes::Clear() {
    for (DoubleLanes *row : {&solidAngle, &x, &y, &z, &xx, &yy, &zz, &xy, &yz, &xz})
        row->fill(0);
}

/// See AddEdge in polygon_moments.h.
Q3_VECTOR void MomentLanes::AddEdge(const SeenCorner &a, const SeenCorner &b, Vec3d normal, HalfSolidAngles &half) {
    Q3_INDEPENDENT
    for (const std::size_t i : kEachLane) {
        const Vec3d aw{a.x[i], a.y[i], a.z[i]}, bw{b.x[i], b.y[i], b.z[i]};
        const Vec3d ad{a.dx[i], a.dy[i], a.dz[i]}, bd{b.dx[i], b.dy[i], b.dz[i]};
        const double la = a.length[i], lb = b.length[i], lengths = la * lb;
        const Vec3d across = Cross(aw, bw - aw);
        const double sine = std::sqrt(Dot(across, across)), cosine = Dot(aw, bw);
        const Vec3d outward = across * (sine > 0 ? -1 / sine : 0);
        const Vec3d acute = (ad + bd) * (sine / (lengths + cosine)), obtuse = Cross(outward, bd - ad);
        const bool isAcute = cosine > 0;
        const double arcX = isAcute ? acute.x : obtuse.x, arcY = isAcute ? acute.y : obtuse.y,
                     arcZ = isAcute ? acute.z : obtuse.z;
        const double angle = AngleOf(sine, cosine) * 0.5;
        x[i] -= outward.x * angle, y[i] -= outward.y * angle, z[i] -= outward.z * angle;
        xx[i] -= arcX * outward.x * (1.0 / 3), yy[i] -= arcY * outward.y * (1.0 / 3);
        zz[i] -= arcZ * outward.z * (1.0 / 3);
        xy[i] -= (arcX * outward.y + arcY * outward.x) * (1.0 / 6);
        yz[i] -= (arcY * outward.z + arcZ * outward.y) * (1.0 / 6);
        xz[i] -= (arcX * outward.z + arcZ * outward.x) * (1.0 / 6);
        const double real = (lengths + Dot(normal, aw) * lb + cosine + Dot(bw, normal) * la) / lengths;
        const double imaginary = Dot(normal, across) / lengths;
        const double before = half.real[i];
        half.real[i] = before * real - half.imaginary[i] * imaginary;
        half.imaginary[i] = before * imaginary + half.imaginary[i] * real;
    }
}

Q3_VECTOR void MomentLanes::Finish(const HalfSolidAngles &half) {
    constexpr double kPi = std::numbers::pi;
    for (const std::size_t i : kEachLane) {
        // A negative imaginary part: with an angle above pi, rounding has pushed a solid angle near 2 pi past it; else
        // the polygon is seen from behind and counts as 0.
        const double angle = 2 * AngleOf(std::abs(half.imaginary[i]), half.real[i]);
        const double wrapped = angle > kPi ? 4 * kPi - angle : 0;
        const double solid = half.imaginary[i] < 0 ? wrapped : angle;
        const double on = solid > 0 ? 1 : 0, third = solid * (1.0 / 3);
        solidAngle[i] = on > 0 ? solid : 0;
        x[i] = on > 0 ? x[i] : 0, y[i] = on > 0 ? y[i] : 0, z[i] = on > 0 ? z[i] : 0;
        xx[i] = on > 0 ? xx[i] + third : 0, yy[i] = on > 0 ? yy[i] + third : 0, zz[i] = on > 0 ? zz[i] + third : 0;
        xy[i] = on > 0 ? xy[i] : 0, yz[i] = on > 0 ? yz[i] : 0, xz[i] = on > 0 ? xz[i] : 0;
    }
}

Q3_VECTOR void MomentLanes::Take(const MomentLanes &from, const LaneMask &lanes) {
    const auto take = [&](const DoubleLanes &a, DoubleLanes &b) {
        for (const std::size_t i : kEachLane)
            b[i] = lanes[i] != 0 ? a[i] : b[i];
    };
    take(from.solidAngle, solidAngle), take(from.x, x), take(from.y, y), take(from.z, z);
    take(from.xx, xx), take(from.yy, yy), take(from.zz, zz);
    take(from.xy, xy), take(from.yz, yz), take(from.xz, xz);
}

void MomentLanes::Measure(std::span<const Vec3f> corners, const Lanes3 &receivers, const LaneMask &lanes) {
    MomentLanes seen;
    seen.Clear();
    HalfSolidAngles half;
    half.real.fill(1), half.imaginary.fill(0);
    const Vec3d normal = PolygonAspect(corners, {}).normal;
    SeenCorner a, b;
    a.See(corners.back(), receivers);
    for (const Vec3f &corner : corners) {
        b.See(corner, receivers);
        seen.AddEdge(a, b, normal, half);
        std::swap(a, b);
    }
    seen.Finish(half);
    Take(seen, lanes);
}

Q3_VECTOR void MomentLanes::Project(double scale, const LaneMask &lanes, std::array<Lanes, 9> &projections) const {
    for (const std::size_t i : kEachLane) {
        const auto values =
            ShFromMoments<double>(solidAngle[i], {x[i], y[i], z[i]}, xy[i], yz[i], zz[i], xz[i], xx[i] - yy[i]);
        const auto put = [&](std::size_t k) {
            projections[k][i] = lanes[i] != 0 ? float(values[k] * scale) : projections[k][i];
        };
        put(0), put(1), put(2), put(3), put(4), put(5), put(6), put(7), put(8);
    }
}

PolygonMoments MomentLanes::Of(std::size_t i) const {
    PolygonMoments m;
    m.solidAngle = solidAngle[i];
    m.first = {x[i], y[i], z[i]};
    m.xx = xx[i], m.yy = yy[i], m.zz = zz[i], m.xy = xy[i], m.yz = yz[i], m.xz = xz[i];
    return m;
}

} // namespace q3
