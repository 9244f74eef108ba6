// GPL-2.0-or-later. Moments of polygons: random ones against quadrature, and those with known values.
#include "libs/math/winding.h"
#include "q3map2/light/transfer/area_sampler.h"
#include "tests/libs/sh/polygon_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numbers>

namespace q3::test {

namespace {

constexpr double kPi = std::numbers::pi;

/// What the stated bound is made of.
struct Measures {
    double farthest = 0;                              ///< corner
    double edge = std::numeric_limits<double>::max(); ///< nearest
    double size = 0;                                  ///< from the first corner
    double distance = 0;                              ///< of the first corner
};

Measures Measure(const PolygonCase &polygon) {
    Measures m;
    const auto &c = polygon.corners;
    m.distance = Length(Vec3d(c[0]) - polygon.p);
    for (std::size_t i = 0; i < c.size(); i++) {
        const Vec3d a = Vec3d(c[i]) - polygon.p, way = Vec3d(c[(i + 1) % c.size()]) - Vec3d(c[i]);
        m.farthest = std::max(m.farthest, Length(a));
        m.size = std::max(m.size, Length(Vec3d(c[i]) - Vec3d(c[0])));
        m.edge = std::min(m.edge, Length(a + way * std::clamp(-Dot(a, way) / Dot(way, way), 0.0, 1.0)));
    }
    return m;
}

double StatedError(const Measures &m, double solidAngle) {
    const double near = 1e-14 * m.farthest / m.edge;
    if (m.size * 64 > m.distance * 0.999)
        return near;
    return std::min(near, std::max(1e-10 * solidAngle, 1e-14 * m.size * m.size / (m.distance * m.distance)));
}

/// Largest differences of the moments of order 0, 1 and 2.
std::array<double, 3> Differences(const Moments10 &a, const Moments10 &b) {
    std::array<double, 3> off{};
    for (std::size_t k = 0; k < 10; k++) {
        double &order = off[k == 0 ? 0 : k < 4 ? 1 : 2];
        const auto difference = double(std::abs(a[k] - b[k]));
        order = difference <= order ? order : difference;
    }
    return off;
}

/// STRESS_POLYGONS in the environment sets the number of random polygons.
std::uint64_t RandomCount() {
    const char *text = std::getenv("STRESS_POLYGONS");
    return text ? std::strtoull(text, nullptr, 10) : 20'000;
}

/// Worst errors over some polygons, per order.
struct Worst {
    std::array<double, 3> error{};
    std::array<std::uint64_t, 3> at{};
    void Add(const std::array<double, 3> &errors, double scale, std::uint64_t index) {
        for (std::size_t order = 0; order < 3; order++)
            if (!(errors[order] / scale <= error[order]))
                error[order] = errors[order] / scale, at[order] = index;
    }
    void Print(const char *what) const {
        std::printf("%-44s", what);
        for (std::size_t order = 0; order < 3; order++)
            std::printf("  %8.2g (%llu)", error[order], (unsigned long long)at[order]);
        std::printf("\n");
    }
};

/// 1, and a failure, where polygon i errs by more than its bound.
std::uint64_t Exceeds(std::uint64_t i, const std::array<double, 3> &off, double bound) {
    if (std::max({off[0], off[1], off[2]}) <= bound)
        return 0;
    ADD_FAILURE() << "polygon " << i << ": errors " << off[0] << ' ' << off[1] << ' ' << off[2] << " over " << bound;
    return 1;
}

TEST(PolygonMoments, RandomPolygonsStayWithinTheStatedError) {
    Worst absolute, relative, clear, share;
    std::uint64_t failures = 0;
    const GaussRule gauss;
    for (std::uint64_t i = 0; i < RandomCount() && failures < 10; i++) {
        const PolygonCase polygon = RandomPolygon(i);
        Moments10 exact = ReferenceMoments(polygon.corners, polygon.p, gauss);
        if (!(exact[0] > 0)) // seen from behind by most of it
            exact = {};
        const auto off = Differences(exact, ToArray(MomentsOfPolygon(polygon.corners, polygon.p)));
        const Measures m = Measure(polygon);
        const double bound = StatedError(m, double(exact[0]));
        share.Add(off, bound, i);
        absolute.Add(off, 1, i);
        if (exact[0] > 1e-6L)
            relative.Add(off, double(exact[0]), i);
        if (m.edge * 1e4 > m.farthest)
            clear.Add(off, 1, i);
        failures += Exceeds(i, off, bound);
    }
    std::printf("worst errors of order 0, 1, 2 and the numbers of their polygons, of %llu\n",
                (unsigned long long)RandomCount());
    absolute.Print("absolute");
    clear.Print("absolute, edges over 1e-4 of corners away");
    relative.Print("relative, solid angles over 1e-6");
    share.Print("share of the stated bound");
}

/// What the baker takes: receivers are floats, and at least this far in front of the polygon's plane.
constexpr double kClearance = 1.0 / 64;

Moments10 LaneMoments(const PolygonCase &polygon, const Vec3f &p, std::size_t lane) {
    Lanes3 receivers;
    receivers.Fill(polygon.corners[0]); // a corner, where nothing is defined, must not disturb the others
    receivers.Set(lane, p);
    LaneMask those{};
    those.Set(lane, true);
    MomentLanes lanes;
    lanes.Measure(polygon.corners, receivers, those);
    return ToArray(lanes.Of(lane));
}

TEST(PolygonMoments, LanesOfRandomPolygonsStayWithinTheStatedError) {
    Worst absolute, clear, share;
    std::uint64_t failures = 0, used = 0;
    const GaussRule gauss;
    for (std::uint64_t i = 0; i < RandomCount() && failures < 10; i++) {
        const PolygonCase polygon = RandomPolygon(i);
        const Vec3f place(polygon.p);
        const Vec3d p(place);
        if (!(PolygonAspect(polygon.corners, p).height >= kClearance))
            continue;
        Moments10 exact = ReferenceMoments(polygon.corners, p, gauss);
        if (!(exact[0] > 0)) // seen from behind by most of it
            exact = {};
        const auto off = Differences(exact, LaneMoments(polygon, place, i % kPacketSize));
        const Measures m = Measure({polygon.view, polygon.corners, p});
        const double bound = 1e-14 * m.farthest / m.edge;
        used++;
        share.Add(off, bound, i);
        absolute.Add(off, 1, i);
        if (m.edge * 1e4 > m.farthest)
            clear.Add(off, 1, i);
        failures += Exceeds(i, off, bound);
    }
    EXPECT_GT(used, RandomCount() / 4);
    std::printf("lanes: worst errors of order 0, 1, 2 and the numbers of their polygons, of %llu\n",
                (unsigned long long)used);
    absolute.Print("absolute");
    clear.Print("absolute, edges over 1e-4 of corners away");
    share.Print("share of the stated bound");
}

TEST(PolygonMoments, ClosedBoxFillsTheSphere) {
    // Moments of the whole sphere: 4 pi, 0, a third of 4 pi on the diagonal.
    const double whole = 4 * kPi, third = whole / 3;
    const Moments10 sphere = {whole, 0, 0, 0, third, third, third, 0, 0, 0};
    for (const double scale : {1e-3, 1.0, 1e5})
        for (const Vec3d &p : {Vec3d{0, 0, 0}, {0.3, -0.7, 0.9}, {0.999999, 0.999999, 0.999999}, {0, 0, -0.999999}}) {
            Moments10 sum{};
            for (const int axis : {0, 1, 2})
                for (const float side : {-1.0f, 1.0f}) {
                    Winding<float> face;
                    for (const auto &[u, v] : {std::pair(-1.0f, -1.0f), {-1.0f, 1.0f}, {1.0f, 1.0f}, {1.0f, -1.0f}}) {
                        Vec3f corner;
                        corner[std::size_t(axis)] = side;
                        corner[std::size_t(axis + 1) % 3] = u * side;
                        corner[std::size_t(axis + 2) % 3] = v;
                        face.push_back(corner * float(scale));
                    }
                    const Vec3d at = p * double(float(scale));
                    if (Dot(WindingAreaVector(face), Vec3d(face[0]) - at) < 0)
                        std::reverse(face.begin(), face.end());
                    const Moments10 part = ToArray(MomentsOfPolygon(face, at));
                    EXPECT_GT(part[0], 0);
                    for (std::size_t k = 0; k < 10; k++)
                        sum[k] += part[k];
                }
            const auto off = Differences(sum, sphere);
            // The nearest edges are a millionth of the box away.
            EXPECT_LE(std::max({off[0], off[1], off[2]}), 1e-7) << scale << ' ' << p.x;
        }
}

TEST(PolygonMoments, NothingFromItsOwnPlaneOrBehind) {
    const Vec3f far{65536, -65536, 65536};
    for (const Vec3f &origin : {Vec3f{}, far})
        for (const float size : {1.0f, 1024.0f}) {
            const std::array<Vec3f, 4> square = {origin, origin + Vec3f{0, size, 0}, origin + Vec3f{size, size, 0},
                                                 origin + Vec3f{size, 0, 0}};
            const auto inPlane = [&](double u, double v) { return Vec3d(origin) + Vec3d{u, v, 0} * double(size); };
            for (const Vec3d &p : {inPlane(0, 0), inPlane(1, 1), inPlane(0.5, 0), inPlane(0.3, 0.6), inPlane(0.5, 0.5),
                                   inPlane(2, 0), inPlane(-1, -1), inPlane(7, 0.5)}) {
                EXPECT_EQ(ToArray(MomentsOfPolygon(square, p)), Moments10{});
                const double front = MomentsOfPolygon(square, p - Vec3d{0, 0, 1e-6}).solidAngle,
                             back = MomentsOfPolygon(square, p + Vec3d{0, 0, 1e-6}).solidAngle;
                EXPECT_EQ(std::min(front, back), 0);
                EXPECT_GT(std::max(front, back), 0);
            }
            // From just over the inside, an edge and a corner: a half, a quarter and an eighth of the sphere.
            const auto solidAngle = [&](const Vec3d &p) {
                const double off = 1e-7 * double(size);
                return std::max(MomentsOfPolygon(square, p + Vec3d{0, 0, off}).solidAngle,
                                MomentsOfPolygon(square, p - Vec3d{0, 0, off}).solidAngle);
            };
            EXPECT_NEAR(solidAngle(inPlane(0.5, 0.5)), 2 * kPi, 2e-6);
            EXPECT_NEAR(solidAngle(inPlane(0.5, 0)), kPi, 2e-6);
            EXPECT_NEAR(solidAngle(inPlane(1, 1)), kPi / 2, 2e-6);
        }
}

TEST(PolygonMoments, PolygonsWithoutAreaOrWithoutNumbersGiveZero) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
    const std::vector<std::vector<Vec3f>> polygons = {
        {},
        {{1, 2, 3}},
        {{1, 2, 3}, {4, 5, 6}},
        {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}},
        {{0, 0, 5}, {1, 0, 5}, {2, 0, 5}},
        {{0, 0, 5}, {1, 0, 5}, {0, 0, 5}, {1, 0, 5}},
        {{kNan, 0, 5}, {1, 0, 5}, {1, 1, 5}},
        {{0, 0, 5}, {1, 0, kNan}, {1, 1, 5}, {0, 1, 5}},
        {{0, 0, 5}, {1, kInf, 5}, {1, 1, 5}},
    };
    for (const auto &corners : polygons)
        for (const Vec3d &p : {Vec3d{0, 0, 0}, {1, 0, 5}, {1, 2, 3}, {1e6, 0, 0}})
            EXPECT_EQ(ToArray(MomentsOfPolygon(corners, p)), Moments10{});
    const std::array<Vec3f, 3> triangle = {Vec3f{0, 0, 5}, {0, 1, 5}, {1, 0, 5}};
    EXPECT_EQ(ToArray(MomentsOfPolygon(triangle, {double(kNan), 0, 0})), Moments10{});
    EXPECT_EQ(ToArray(MomentsOfPolygon(triangle, {0, 0, -double(kInf)})), Moments10{});
}

} // namespace

} // namespace q3::test
