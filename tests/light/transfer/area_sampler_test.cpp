// GPL-2.0-or-later. Moments for sixteen receivers at once: as for each alone.
#include "q3map2/light/transfer/area_sampler.h"

#include <gtest/gtest.h>

#include <random>

namespace q3 {
namespace {

/// Worst difference of two sets of moments.
double Off(const PolygonMoments &a, const PolygonMoments &b) {
    double worst = std::max(std::abs(a.solidAngle - b.solidAngle), Length(a.first - b.first));
    for (const double d : {a.xx - b.xx, a.yy - b.yy, a.zz - b.zz, a.xy - b.xy, a.yz - b.yz, a.xz - b.xz})
        worst = std::max(worst, std::abs(d));
    return worst;
}

TEST(MomentLanesTest, NearPlacesGetWhatEachGetsAlone) {
    std::mt19937 random(17);
    std::uniform_real_distribution<float> any(-1, 1);
    for (int round = 0; round < 500; ++round) {
        // A convex polygon in a random plane: points on an ellipse, clockwise from below.
        const Vec3f right = Normalize(Vec3f{any(random), any(random), any(random)});
        const Vec3f up = Normalize(Cross(right, Normalize(Vec3f{any(random), any(random), any(random)})));
        const Vec3f normal = Cross(right, up), middle{1000 * any(random), 1000 * any(random), 1000 * any(random)};
        const float width = 8 + 200 * std::abs(any(random)), height = 8 + 200 * std::abs(any(random));
        std::vector<Vec3f> corners;
        const int count = 3 + round % 6;
        for (int i = 0; i < count; ++i) {
            const float angle = 6.2831853f * float(i) / float(count);
            corners.push_back(middle + right * (width * std::cos(angle)) + up * (height * std::sin(angle)));
        }
        Lanes3 receivers;
        LaneMask all;
        for (const std::size_t i : kEachLane) {
            const float off = (0.02f + std::abs(any(random))) * (width + height);
            receivers.Set(i,
                          middle + right * (2 * width * any(random)) + up * (2 * height * any(random)) - normal * off);
            all[i] = -1;
        }
        MomentLanes lanes;
        lanes.Measure(corners, receivers, all);
        for (const std::size_t i : kEachLane) {
            const PolygonMoments alone = MomentsOfPolygon(corners, Vec3d(receivers[i]));
            ASSERT_GT(alone.solidAngle, 0);
            EXPECT_LT(Off(lanes.Of(i), alone), 1e-11) << round;
            EXPECT_NEAR(lanes.FirstLength(i), Length(alone.first), 1e-11);
        }
    }
}

TEST(MomentLanesTest, FarPlacesGetTheLightThatEachGetsAlone) {
    const std::vector<Vec3f> corners = {{0, 0, 0}, {0, 32, 0}, {32, 32, 0}, {32, 0, 0}};
    for (const float away : {64.0f, 500.0f, 4000.0f, 30000.0f}) {
        Lanes3 receivers;
        LaneMask all;
        for (const std::size_t i : kEachLane) {
            receivers.Set(i, {16 + away * (float(i) - 8) / 8, 16, -away});
            all[i] = -1;
        }
        MomentLanes lanes;
        lanes.Measure(corners, receivers, all);
        std::array<Lanes, 9> projections;
        lanes.Project(1, all, projections);
        for (const std::size_t i : kEachLane) {
            const PolygonMoments alone = MomentsOfPolygon(corners, Vec3d(receivers[i]));
            EXPECT_LT(Off(lanes.Of(i), alone), 2e-14 + 1e-10 * alone.solidAngle) << away;
            for (std::size_t k = 0; k < 9; ++k)
                EXPECT_NEAR(double(projections[k][i]), alone.Projection()[k], 3e-14 + 1e-7 * alone.solidAngle);
        }
    }
}

TEST(MomentLanesTest, OtherPlacesKeepTheirs) {
    const std::vector<Vec3f> floor = {{0, 0, 0}, {64, 0, 0}, {64, 64, 0}, {0, 64, 0}};
    const std::vector<Vec3f> ceiling = {{0, 64, 128}, {64, 64, 128}, {64, 0, 128}, {0, 0, 128}};
    Lanes3 receivers;
    receivers.Fill({32, 32, 50});
    LaneMask even, odd;
    for (const std::size_t i : kEachLane)
        even.Set(i, i % 2 == 0), odd.Set(i, i % 2 != 0);
    MomentLanes lanes;
    lanes.Measure(std::vector<Vec3f>(floor.rbegin(), floor.rend()), receivers, even);
    lanes.Measure(std::vector<Vec3f>(ceiling.rbegin(), ceiling.rend()), receivers, odd);
    const double below = lanes.Of(0).first.z, above = lanes.Of(1).first.z;
    EXPECT_LT(below, 0);
    EXPECT_GT(above, 0);
    EXPECT_EQ(lanes.Of(14).first.z, below);
    EXPECT_EQ(lanes.Of(15).first.z, above);
}

TEST(MomentLanesTest, FromBehindAndInAPlaneThereIsNothing) {
    const std::vector<Vec3f> floor = {{0, 64, 0}, {64, 64, 0}, {64, 0, 0}, {0, 0, 0}};
    Lanes3 receivers;
    for (const std::size_t i : kEachLane)
        receivers.Set(i, {32, 32, i % 2 == 0 ? -50.0f : 50.0f});
    LaneMask all;
    all.fill(-1);
    MomentLanes lanes;
    lanes.Measure(floor, receivers, all);
    const bool above = lanes.Of(1).solidAngle > 0;
    for (const std::size_t i : kEachLane) {
        const bool front = (i % 2 == 1) == above;
        EXPECT_EQ(lanes.Of(i).solidAngle > 0, front);
        EXPECT_EQ(lanes.FirstLength(i) > 0, front);
    }
}

} // namespace
} // namespace q3
