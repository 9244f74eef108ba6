// GPL-2.0-or-later. Hashed look-ups give what a search in order of addition gives.
#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/geometry/faces/tjunctions.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace q3::test {
namespace {

TEST(PointTableTest, FindsTheFirstOfTheNearPoints) {
    std::mt19937 random(1);
    std::vector<Vec3f> points;
    PointTable table(0.001);
    for (int i = 0; i < 4000; ++i) {
        // Steps of 0.0007 around the borders of cells: chains of points, each near to the next.
        const auto coordinate = [&] { return float(random() % 3) * 0.5f - 0.0625f + 0.0007f * float(random() % 5); };
        const Vec3f p{coordinate(), coordinate(), coordinate()};
        int expected = -1;
        for (std::size_t k = 0; k < points.size() && expected < 0; ++k) {
            const Vec3d d = Vec3d(points[k]) - Vec3d(p);
            if (std::abs(d.x) <= 0.001 && std::abs(d.y) <= 0.001 && std::abs(d.z) <= 0.001)
                expected = int(k);
        }
        if (expected < 0) {
            expected = int(points.size());
            points.push_back(p);
        }
        ASSERT_EQ(table.FindOrAdd(p), expected);
    }
    EXPECT_EQ(table.Count(), int(points.size()));
}

TEST(EdgeLinesTest, FindsTheFirstOfTheNearLines) {
    std::mt19937 random(2);
    Boundsf bounds;
    bounds.Add(Vec3f{-512, -512, -64}), bounds.Add(Vec3f{512, 512, 64});
    EdgeLines lines(bounds, 1500);
    const auto near = [&](int line, const Vec3f &p) {
        return std::abs(lines[line].planes[0].Distance(Vec3d(p))) < 0.25 &&
               std::abs(lines[line].planes[1].Distance(Vec3d(p))) < 0.25;
    };
    for (int i = 0; i < 1500; ++i) {
        const auto grid = [&](int steps, float step) {
            return (float(random() % unsigned(2 * steps + 1)) - float(steps)) * step;
        };
        const Vec3f a{grid(8, 64), grid(8, 64), grid(2, 32)};
        Vec3f b = i % 3 == 0 ? Vec3f{a.x, a.y, grid(2, 32)} : Vec3f{grid(8, 64), grid(8, 64), grid(2, 32)};
        b.z += 0.125f * float(random() % 3);
        const double length = Length(Vec3d(b) - Vec3d(a));
        if (length < 0.1 || b.z > 64)
            continue;
        int expected = 0;
        while (expected < lines.Count() && !(near(expected, a) && near(expected, b)))
            ++expected;
        ASSERT_EQ(lines.Add(a, b, (Vec3d(b) - Vec3d(a)) / length), expected);
        for (std::size_t k = 1; k < lines[expected].points.size(); ++k)
            EXPECT_GE(lines[expected].points[k].along - lines[expected].points[k - 1].along, 0.25);
    }
    EXPECT_GT(lines.Count(), 500);
}

} // namespace
} // namespace q3::test
