// GPL-2.0-or-later. Samples of triangles in the grid of a lightmap.
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

/// A vertex of a surface that lies in the grid.
SurfaceVertex At(float s, float t) {
    SurfaceVertex v;
    v.xyz = {16 * s, 16 * t, 8}, v.normal = {0, 0, 1}, v.luxel = {s, t};
    return v;
}

constexpr int kWide = 40, kTall = 33;

std::vector<LuxelTriangle> SomeTriangles() {
    std::mt19937 random(7);
    std::uniform_real_distribution<float> across(0, kWide), down(0, kTall);
    std::vector<LuxelTriangle> triangles;
    for (int i = 0; i < 50; ++i)
        triangles.push_back(
            {{{across(random), down(random)}, {across(random), down(random)}, {across(random), down(random)}}});
    return triangles;
}

/// Times that ForCoveredLuxels names each luxel.
std::vector<int> Named(const LuxelTriangle &triangle) {
    std::vector<int> times(kWide * kTall);
    ForCoveredLuxels(triangle, kWide, kTall, [&](int x, int y) { ++times[std::size_t(y * kWide + x)]; });
    return times;
}

/// The triangle cut by the four sides of a luxel, and its area there.
double AreaIn(const LuxelTriangle &triangle, int x, int y) {
    std::vector<std::array<double, 2>> w;
    for (const auto &p : triangle)
        w.push_back({p[0], p[1]});
    const auto cut = [&](std::size_t axis, double sign, double limit) {
        std::vector<std::array<double, 2>> in;
        for (std::size_t i = 0; i < w.size(); ++i) {
            const auto &p = w[i], &q = w[(i + 1) % w.size()];
            const double a = sign * p[axis] - limit, b = sign * q[axis] - limit;
            if (a <= 0)
                in.push_back(p);
            if ((a < 0 && b > 0) || (a > 0 && b < 0))
                in.push_back({p[0] + (q[0] - p[0]) * a / (a - b), p[1] + (q[1] - p[1]) * a / (a - b)});
        }
        w = in;
    };
    cut(0, 1, x + 1), cut(0, -1, -x), cut(1, 1, y + 1), cut(1, -1, -y);
    double area = 0;
    for (std::size_t i = 0; i < w.size(); ++i) {
        const auto &p = w[i], &q = w[(i + 1) % w.size()];
        area += (p[0] * q[1] - p[1] * q[0]) / 2;
    }
    return std::abs(area);
}

double Distance(const std::array<float, 2> &p, const LuxelTriangle &triangle) {
    double least = 1e9;
    bool left = true, right = true;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto &a = triangle[i], &b = triangle[(i + 1) % 3];
        const double dx = b[0] - a[0], dy = b[1] - a[1], px = p[0] - a[0], py = p[1] - a[1];
        const double side = dx * py - dy * px;
        left = left && side >= 0, right = right && side <= 0;
        const double t = std::clamp((px * dx + py * dy) / (dx * dx + dy * dy), 0.0, 1.0);
        least = std::min(least, std::hypot(px - dx * t, py - dy * t));
    }
    return left || right ? 0 : least;
}

TEST(LuxelRasterTest, ALuxelThatHoldsPartOfATriangleIsNamedOnce) {
    for (const LuxelTriangle &triangle : SomeTriangles()) {
        const std::vector<int> times = Named(triangle);
        for (int y = 0; y < kTall; ++y)
            for (int x = 0; x < kWide; ++x) {
                const double area = AreaIn(triangle, x, y);
                const int named = times[std::size_t(y * kWide + x)];
                EXPECT_LE(named, 1);
                EXPECT_TRUE(area < 1e-6 || named == 1) << x << " " << y << " holds " << area;
                EXPECT_TRUE(area > 0 || named == 0) << x << " " << y << " holds nothing";
            }
    }
}

TEST(LuxelRasterTest, MiddlesLieInTheLuxelAndOnTheTriangle) {
    for (const LuxelTriangle &triangle : SomeTriangles())
        ForCoveredLuxels(triangle, kWide, kTall, [&](int x, int y) {
            const auto [across, down] = ClippedCenter(triangle, x, y);
            EXPECT_LT(Distance({across, down}, triangle), 1e-4);
            EXPECT_NEAR(across, float(x) + 0.5f, 0.5001f);
            EXPECT_NEAR(down, float(y) + 0.5f, 0.5001f);
        });
    const LuxelTriangle tip = {{{52.6f, 115.5f}, {0.6f, 103.7f}, {0.5f, 115.5f}}};
    EXPECT_GE(ClippedCenter(tip, 1, 103)[0], 1) << "beside the corner, which is in the luxel before";
}

TEST(LuxelRasterTest, MiddlesOfTrianglesThatOnlyTouchALuxelLieWhereTheyDo) {
    const LuxelTriangle below = {{{6.5f, 5}, {1.5f, 9}, {23, 9}}};
    const std::array<float, 2> onEdge = ClippedCenter(below, 10, 9), atCorner = ClippedCenter(below, 23, 9);
    EXPECT_EQ(onEdge, (std::array<float, 2>{10.5f, 9}));
    EXPECT_EQ(atCorner, (std::array<float, 2>{23, 9}));
}

/// As SubdivideTriangle, which names luxels by the points that fall into them.
TEST(LuxelRasterTest, EdgesAndCornersOnLuxelBordersBelongToTheNextLuxel) {
    std::vector<int> expected(kWide * kTall);
    for (int y = 2; y <= 4; ++y)
        for (int x = 3; x <= 6; ++x)
            expected[std::size_t(y * kWide + x)] = 1;
    std::vector<int> both = Named({{{3, 2}, {6, 2}, {6, 4}}});
    const std::vector<int> other = Named({{{3, 2}, {6, 4}, {3, 4}}});
    for (std::size_t i = 0; i < both.size(); ++i)
        both[i] = both[i] + other[i] > 0 ? 1 : 0;
    EXPECT_EQ(both, expected);
}

TEST(LuxelRasterTest, ATriangleWithoutWidthNamesTheLuxelsAlongIt) {
    std::vector<int> expected(kWide * kTall);
    for (int x = 2; x <= 9; ++x)
        expected[std::size_t(5 * kWide + x)] = 1;
    EXPECT_EQ(Named({{{2.5f, 5.5f}, {9.25f, 5.5f}, {4, 5.5f}}}), expected);
}

TEST(LuxelRasterTest, CoordinatesThatNoIntHoldsAreLimited) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(LuxelOf(7.9f, 128), 7);
    for (const float large : {127.5f, 128.0f, 1e12f, kInfinity})
        EXPECT_EQ(LuxelOf(large, 128), 127) << large;
    for (const float small : {0.9f, -0.5f, -1e12f, -kInfinity, kNan})
        EXPECT_EQ(LuxelOf(small, 128), 0) << small;
}

TEST(LuxelRasterTest, EveryLuxelInsideATriangleGetsASample) {
    constexpr int kSide = 33;
    std::vector<int> hits(kSide * kSide);
    SubdivideTriangle<true>(At(0, 0), At(kSide, 0), At(0, kSide), 1.0f, [&](const SurfaceVertex &v) {
        EXPECT_FLOAT_EQ(v.xyz.x, 16 * v.luxel[0]);
        ++hits[std::size_t(int(v.luxel[1]) * kSide + int(v.luxel[0]))];
    });
    for (int t = 0; t < kSide; ++t)
        for (int s = 0; s + t + 2 < kSide; ++s)
            EXPECT_GT(hits[std::size_t(t * kSide + s)], 0) << s << " " << t;
}

} // namespace

} // namespace q3::test
