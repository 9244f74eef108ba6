// GPL-2.0-or-later. Short rays among near triangles against a slow test of each in double.
#include "q3map2/lightmap/ao/near_triangles.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace q3::test {

namespace {

constexpr float kLength = 128, kNearest = 0.25f;
/// Hits as near as this to an edge, in shares of it, or to an end of the ray, in game units, may go either way.
constexpr double kEdge = 1e-3, kEnd = 0.01;

using Triangles = std::vector<LightScene::BlockerTriangle>;

struct Hit {
    double distance = kLength;
    int surface = -1;
    bool doubtful = false;
};

/// The first triangle beyond `nearest` on a ray, by solving for the point in the triangle's plane.
Hit FirstHit(const Triangles &triangles, const Vec3d &origin, const Vec3d &direction, double nearest) {
    Hit first;
    for (const LightScene::BlockerTriangle &triangle : triangles) {
        const Vec3d a(triangle.corners[0]), ab = Vec3d(triangle.corners[1]) - a, ac = Vec3d(triangle.corners[2]) - a;
        const Vec3d normal = Cross(ab, ac);
        const double t = Dot(a - origin, normal) / Dot(direction, normal);
        const Vec3d p = origin + direction * t - a;
        const double u = Dot(Cross(p, ac), normal) / Dot(normal, normal);
        const double v = Dot(Cross(ab, p), normal) / Dot(normal, normal);
        const double inside = std::min({u, v, 1 - u - v}), along = std::min(t - nearest, kLength - t);
        if (!(inside > -kEdge && along > -kEnd))
            continue;
        first.doubtful = first.doubtful || inside < kEdge || along < kEnd || std::abs(t - first.distance) < kEnd;
        if (t < first.distance)
            first.distance = t, first.surface = triangle.surface;
    }
    return first;
}

class NearTrianglesTest : public testing::TestWithParam<bool> {
  protected:
    Vec3f Within(float size) { return {share_(random_) * size, share_(random_) * size, share_(random_) * size}; }
    Vec3f Direction() {
        Vec3f d;
        do
            d = Within(1);
        while (Length(d) > 1 || Length(d) < 0.1f);
        return Normalize(d);
    }
    Triangles Some(int count) {
        Triangles triangles;
        for (int i = 0; i < count; ++i) {
            const Vec3f at = Within(150);
            triangles.push_back({{at, at + Within(80), at + Within(80)}, i, false});
        }
        return triangles;
    }
    /// Rays of neighbors: in one direction, or in one each.
    RayPacket Rays() {
        RayPacket rays;
        const Vec3f from = Within(60), direction = Direction();
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            rays.origin.Set(i, from + Within(16));
            rays.direction.Set(i, GetParam() ? direction : Direction());
            rays.distance[i] = kLength;
            rays.live.Set(i, i % 5 != 0);
        }
        return rays;
    }

    struct Counts {
        int hits = 0, misses = 0, doubtful = 0;
    };
    /// That live rays, and no others, were found to meet what is first beyond their `nearest`.
    static void ExpectFirst(const Triangles &triangles, const RayPacket &rays, const LaneMask &live,
                            const Lanes &nearest, NearTriangles::Outcome outcome, const LightScene::Blockers &blockers,
                            Counts &counts) {
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const bool hit = outcome == NearTriangles::Outcome::Traced && blockers.hit[i] != 0;
            if (live[i] == 0) {
                EXPECT_FALSE(hit);
                continue;
            }
            const Hit first = FirstHit(triangles, Vec3d(rays.origin[i]), Vec3d(rays.direction[i]), double(nearest[i]));
            if (first.doubtful) {
                ++counts.doubtful;
                continue;
            }
            ASSERT_EQ(hit, first.surface >= 0) << i;
            ++(hit ? counts.hits : counts.misses);
            if (!hit)
                continue;
            EXPECT_EQ(blockers.surface[i], first.surface);
            EXPECT_NEAR(blockers.distance[i], first.distance, 1e-2);
        }
    }

    std::mt19937 random_{11};
    std::uniform_real_distribution<float> share_{-1, 1};
};

TEST_P(NearTrianglesTest, TheFirstTriangleOfEachRayIsFound) {
    Lanes nearest;
    nearest.fill(kNearest);
    Counts counts;
    for (int round = 0; round < 300; ++round) {
        const Triangles triangles = Some(1 + round % 60);
        const RayPacket rays = Rays();
        NearTriangles all, near;
        for (const LightScene::BlockerTriangle &triangle : triangles)
            all.Add(triangle);
        Boundsf starts;
        for (std::size_t i = 0; i < kPacketSize; ++i)
            starts.Add(rays.origin[i]);
        near.Select(all, starts, kLength);
        LightScene::Blockers blockers;
        blockers.hit = {};
        const auto outcome = near.Trace(rays, rays.live, RayBounds(rays), kNearest, blockers);
        ASSERT_NE(outcome, NearTriangles::Outcome::Undecided);
        ExpectFirst(triangles, rays, rays.live, nearest, outcome, blockers, counts);
    }
    EXPECT_GT(counts.hits, 300);
    EXPECT_GT(counts.misses, 300);
    EXPECT_LT(counts.doubtful, 300);
}

TEST_P(NearTrianglesTest, RaysGoOnBehindWhatTheyMet) {
    Counts counts;
    for (int round = 0; round < 200; ++round) {
        const Triangles triangles = Some(20 + round % 40);
        const RayPacket rays = Rays();
        NearTriangles near;
        for (const LightScene::BlockerTriangle &triangle : triangles)
            near.Add(triangle);
        LightScene::Blockers blockers;
        if (near.Trace(rays, rays.live, RayBounds(rays), kNearest, blockers) != NearTriangles::Outcome::Traced)
            continue;
        const LaneMask on = blockers.hit;
        Lanes behind = blockers.distance;
        for (float &distance : behind)
            distance += 0.5f;
        const auto outcome = near.TraceNextHit(rays, on, behind, blockers);
        ExpectFirst(triangles, rays, on, behind, outcome, blockers, counts);
    }
    EXPECT_GT(counts.hits, 30);
    EXPECT_GT(counts.misses, 30);
    EXPECT_LT(counts.doubtful, 100);
}

TEST_P(NearTrianglesTest, SeeThroughTrianglesInTheWayAreLeftToTheScene) {
    const RayPacket rays = Rays();
    const Vec3f at = rays.origin[1] + rays.direction[1] * 50.0f;
    LightScene::BlockerTriangle wall{
        {at + Vec3f{-400, -300, 20}, at + Vec3f{400, -300, 20}, at + Vec3f{0, 400, -40}}, 3, true};
    NearTriangles near;
    near.Add(wall);
    LightScene::Blockers blockers;
    EXPECT_EQ(near.Trace(rays, rays.live, RayBounds(rays), kNearest, blockers), NearTriangles::Outcome::Undecided);
    wall.seeThrough = false;
    NearTriangles opaque;
    opaque.Add(wall);
    EXPECT_EQ(opaque.Trace(rays, rays.live, RayBounds(rays), kNearest, blockers), NearTriangles::Outcome::Traced);
}

INSTANTIATE_TEST_SUITE_P(Directions, NearTrianglesTest, testing::Bool(),
                         [](const auto &which) { return which.param ? "One" : "Many"; });

TEST(NearTrianglesSelectTest, OnlyTrianglesWithinReachAndInFrontAreSelected) {
    NearTriangles all;
    const auto add = [&](const Vec3f &at, int surface) {
        all.Add({{at, at + Vec3f{8, 0, 0}, at + Vec3f{0, 8, 0}}, surface, false});
    };
    for (int i = 0; i < 20; ++i)
        add({0, 0, 20.0f * float(i)}, i); // 0, 20, ... 380 over the start
    add({0, 0, -30}, 20);
    NearTriangles near;
    const Boundsf starts{{-4, -4, 0}, {4, 4, 0}};
    near.Select(all, starts, 100);
    EXPECT_EQ(near.Count(), 7u); // 0 to 100, and the one behind
    near.Select(all, starts, 100, {0, 0, 1}, 0);
    EXPECT_EQ(near.Count(), 6u);
    near.Select(all, {{-4, 200, 0}, {4, 200, 0}}, 100);
    EXPECT_EQ(near.Count(), 0u);
}

} // namespace

} // namespace q3::test
