// GPL-2.0-or-later. Samples of spherical triangles against closed forms.
#include "libs/math/sampling.h"
#include "libs/sh/polygon_moments.h"

#include <gtest/gtest.h>

#include <random>

namespace q3 {
namespace {

/// The mean of many samples times the solid angle is the closed form, for all moments up to the second.
void ExpectMoments(const Vec3d &a, const Vec3d &b, const Vec3d &c) {
    const bool turn = Dot(Cross(b - a, c - a), a) < 0;
    const std::array<Vec3f, 3> corners = {Vec3f(a), Vec3f(turn ? c : b), Vec3f(turn ? b : c)};
    const PolygonMoments exact = MomentsOfPolygon(corners, {});
    ASSERT_GT(exact.solidAngle, 0);
    const SphericalTriangle triangle(a, b, c);
    EXPECT_NEAR(triangle.SolidAngle(), exact.solidAngle, 1e-6 * (1 + exact.solidAngle));
    constexpr std::uint32_t kSamples = 20000;
    PolygonMoments sampled;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
        const Vec3d d = triangle.Sample(PlasticSample(i, 1));
        EXPECT_NEAR(Length(d), 1, 1e-12);
        sampled.Add(d, triangle.SolidAngle() / kSamples);
    }
    const double close = 1e-3 * exact.solidAngle;
    EXPECT_LT(Length(sampled.first - exact.first), close);
    EXPECT_NEAR(sampled.xx, exact.xx, close);
    EXPECT_NEAR(sampled.yy, exact.yy, close);
    EXPECT_NEAR(sampled.xy, exact.xy, close);
    EXPECT_NEAR(sampled.yz, exact.yz, close);
    EXPECT_NEAR(sampled.xz, exact.xz, close);
}

TEST(SphericalTriangleTest, SamplesAreUniformInSolidAngle) {
    ExpectMoments({0, 0, 1}, {0, 1, 0}, {1, 0, 0});             // an eighth of the sphere
    ExpectMoments({-100, -90, 1}, {-80, 100, 1}, {120, 10, 1}); // nearly a hemisphere
    ExpectMoments({1, 1, 30}, {1, 4, 30}, {3, 1, 31});          // small
    ExpectMoments({0, 0, 10}, {0, 0.05, 10}, {20, 0, 10});      // a sliver
    ExpectMoments({5, -3, 2}, {-4, -3, 2}, {-4, -3, 20});       // far off the axes
}

TEST(SphericalTriangleTest, CornersOfThePatternAreInTheTriangle) {
    const Vec3d a{0, 0, 1}, b{0, 1, 0}, c{1, 0, 0};
    const SphericalTriangle triangle(a, b, c);
    for (const double u : {0.0, 1.0})
        for (const double v : {0.0, 1.0}) {
            const Vec3d d = triangle.Sample({u, v});
            EXPECT_GE(std::min({d.x, d.y, d.z}), -1e-7);
        }
}

} // namespace
} // namespace q3
