// GPL-2.0-or-later. Convex hulls in a plane.
#include "libs/math/winding.h"

#include <gtest/gtest.h>

#include <random>

namespace q3 {
namespace {

constexpr double kTolerance = 0.01;

/// Points of a slanted plane, and its normal.
struct Scattered {
    Vec3d normal;
    std::vector<Vec3d> points;
};
Scattered Scatter(std::mt19937 &random, int count) {
    std::uniform_real_distribution<double> number(-100, 100);
    const auto vector = [&] { return Vec3d{number(random), number(random), number(random)}; };
    Scattered scattered{Normalize(vector()), {}};
    const Vec3d right = Normalize(Cross(vector(), scattered.normal)), up = Cross(scattered.normal, right);
    const Vec3d origin = vector();
    for (int i = 0; i < count; ++i)
        scattered.points.push_back(origin + right * number(random) + up * number(random));
    return scattered;
}

TEST(ConvexHullTest, HoldsAllPointsAndTurnsClockwise) {
    std::mt19937 random(3);
    for (int run = 0; run < 500; ++run) {
        const auto [normal, points] = Scatter(random, 3 + run % 30);
        const Winding<double> hull = ConvexHull(points, normal, kTolerance);
        ASSERT_GE(hull.size(), 3u);
        for (std::size_t i = 0; i < hull.size(); ++i) {
            const Vec3d &a = hull[i], &b = hull[(i + 1) % hull.size()];
            const Vec3d inward = Normalize(Cross(b - a, normal));
            for (const Vec3d &p : points)
                EXPECT_GE(Dot(inward, p - a), -2 * kTolerance);
        }
    }
}

TEST(ConvexHullTest, LeavesOutCornersOnEdges) {
    const std::vector<Vec3d> points = {{0, 0, 5},  {10, 0, 5}, {20, 0.001, 5}, {30, 0, 5}, {30, 30, 5},
                                       {0, 30, 5}, {0, 10, 5}, {30, 30, 5},    {15, 15, 5}};
    const Winding<double> hull = ConvexHull(points, {0, 0, 1}, kTolerance);
    EXPECT_EQ(hull.size(), 4u);
    EXPECT_DOUBLE_EQ(WindingArea(hull), 900);
}

TEST(ConvexHullTest, APointOrALineHasNone) {
    EXPECT_TRUE(ConvexHull({}, {0, 0, 1}, kTolerance).empty());
    EXPECT_TRUE(ConvexHull({{1, 2, 3}}, {0, 0, 1}, kTolerance).empty());
    EXPECT_TRUE(ConvexHull({{0, 0, 0}, {1, 1, 0}, {2, 2, 0}, {5, 5, 0}}, {0, 0, 1}, kTolerance).empty());
}

} // namespace
} // namespace q3
