// GPL-2.0-or-later. Skies as convex polygons: the same sky as triangle by triangle.
#include "q3map2/light/scene/sky_faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace q3 {
namespace {

/// Clockwise polygon as the triangles of a draw surface.
void AddFan(Triangles &skies, const std::vector<Vec3f> &w, int surface) {
    for (std::size_t i = 2; i < w.size(); ++i)
        skies.Add(w[0], w[i - 1], w[i], surface);
}

/// Ceiling and two walls of a box, clockwise from its inside; the ceiling has a corner in the middle of an edge and is
/// cut from there.
Triangles BoxOfSky() {
    Triangles skies;
    AddFan(skies, {{0, 64, 256}, {0, 512, 256}, {512, 512, 256}, {512, 0, 256}, {0, 0, 256}}, 3);
    AddFan(skies, {{0, 0, 0}, {0, 512, 0}, {0, 512, 256}, {0, 0, 256}}, 5);
    AddFan(skies, {{512, 0, 256}, {512, 512, 256}, {512, 512, 0}, {512, 0, 0}}, 8);
    return skies;
}
std::vector<int> IndexesOf(const Triangles &skies) {
    std::vector<int> indexes;
    for (const int surface : skies.surface)
        indexes.push_back(100 + surface);
    return indexes;
}

struct Slow {
    double distance;
    int skyIndex = -1;
    bool behind = false;
};
/// The nearest triangle, one after the other.
Slow NearestTriangle(const Triangles &skies, const Vec3d &origin, const Vec3d &direction, double nearest, double far) {
    Slow found{far};
    for (std::size_t i = 0; i < skies.Count(); ++i) {
        const float *c = &skies.corners[9 * i];
        const Vec3d a(Vec3f{c[0], c[1], c[2]}), b(Vec3f{c[3], c[4], c[5]}), d(Vec3f{c[6], c[7], c[8]});
        const Vec3d n = Cross(d - a, b - a);
        const double t = Dot(n, a - origin) / Dot(n, direction);
        const Vec3d p = origin + direction * t;
        const bool inside =
            Dot(Cross(p - a, b - a), n) >= 0 && Dot(Cross(p - b, d - b), n) >= 0 && Dot(Cross(p - d, a - d), n) >= 0;
        if (inside && t >= nearest && t < found.distance)
            found = {t, 100 + skies.surface[i], Dot(n, direction) > 0};
    }
    return found;
}

Vec3f RandomDirection(std::mt19937 &random) {
    std::normal_distribution<float> normal;
    return Normalize(Vec3f{normal(random), normal(random), normal(random)});
}

/// Random rays from in and around a box of sky find what a search of all triangles finds.
void ExpectNearest(float nearest) {
    const Triangles skies = BoxOfSky();
    const SkyFaces faces(skies, IndexesOf(skies));
    ASSERT_TRUE(faces.Few());
    std::mt19937 random(7);
    std::uniform_real_distribution<float> place(-300, 800);
    int met = 0, missed = 0, behind = 0;
    for (int packet = 0; packet < 4000; ++packet) {
        Lanes3 origin, direction;
        Lanes farthest;
        LaneMask live;
        for (const std::size_t i : kEachLane) {
            origin.Set(i, {place(random), place(random), place(random)});
            direction.Set(i, RandomDirection(random));
            farthest[i] = i % 4 == 0 ? 200.0f : 100000.0f;
            live.Set(i, i % 5 != 0);
        }
        SkyHits hits;
        faces.Find(origin, direction, farthest, live, nearest, hits);
        for (const std::size_t i : kEachLane) {
            EXPECT_TRUE(live[i] != 0 || hits.hit[i] == 0);
            if (live[i] == 0)
                continue;
            const Slow slow =
                NearestTriangle(skies, Vec3d(origin[i]), Vec3d(direction[i]), nearest, double(farthest[i]));
            // Rays that touch an edge may go either way.
            const Vec3f p = origin[i] + direction[i] * hits.distance[i];
            const auto near = [](float x, float edge) { return std::abs(x - edge) < 0.2f; };
            const int planes =
                (near(p.x, 0) || near(p.x, 512)) + (near(p.y, 0) || near(p.y, 512)) + (near(p.z, 0) || near(p.z, 256));
            if (planes > 1)
                continue;
            ASSERT_EQ(hits.hit[i] != 0, slow.skyIndex >= 0);
            (slow.skyIndex < 0 ? missed : slow.behind ? behind : met)++;
            if (slow.skyIndex < 0)
                continue;
            EXPECT_NEAR(double(hits.distance[i]), slow.distance, 1e-3 * (1 + slow.distance));
            EXPECT_EQ(hits.skyIndex[i], slow.skyIndex);
            EXPECT_EQ(hits.behind[i] != 0, slow.behind);
        }
    }
    EXPECT_GT(met, 1000);
    EXPECT_GT(missed, 1000);
    EXPECT_GT(behind, 1000);
}

TEST(SkyFacesTest, RaysMeetTheNearestSky) {
    ExpectNearest(0);
}
TEST(SkyFacesTest, SkiesNearerThanTheLimitAreIgnored) {
    ExpectNearest(64);
}

TEST(SkyFacesTest, NoRaySlipsThroughWhereFacesMeet) {
    const Triangles skies = BoxOfSky();
    const SkyFaces faces(skies, IndexesOf(skies));
    Lanes3 origin, direction;
    Lanes farthest;
    farthest.fill(10000);
    LaneMask live;
    live.fill(-1);
    for (int step = 0; step < 400; ++step) {
        for (const std::size_t i : kEachLane) {
            // Toward the edge of ceiling and wall.
            const Vec3f from{256, 100.0f + float(i), 32}, to{512, 1.0f + float(step) * 1.27f, 256};
            origin.Set(i, from), direction.Set(i, Normalize(to - from));
        }
        SkyHits hits;
        faces.Find(origin, direction, farthest, live, 0, hits);
        EXPECT_EQ(hits.hit.Bits(), kAllLanes);
    }
}

/// One surface around a hole, with teeth on one side, as compilers merge a ceiling of sky.
Triangles CeilingWithHole() {
    Triangles sky;
    const auto add = [&](float x0, float y0, float x1, float y1) {
        AddFan(sky, {{x0, y0, 128}, {x0, y1, 128}, {x1, y1, 128}, {x1, y0, 128}}, 4);
    };
    add(0, 0, 512, 128), add(0, 384, 512, 512);
    add(0, 128, 128, 384), add(384, 128, 512, 384);
    for (float x = 0; x < 512; x += 128)
        add(x, 512, x + 64, 640);
    return sky;
}

TEST(SkyFacesTest, ASkyOfAnyOutlineIsMetWhereItsTrianglesAre) {
    const Triangles skies = CeilingWithHole();
    const SkyFaces faces(skies, IndexesOf(skies));
    ASSERT_TRUE(faces.Few());
    std::mt19937 random(11);
    std::uniform_real_distribution<float> place(-100, 700);
    int met = 0, missed = 0;
    for (int packet = 0; packet < 3000; ++packet) {
        Lanes3 origin, direction;
        Lanes farthest;
        LaneMask live;
        live.fill(-1), farthest.fill(10000);
        for (const std::size_t i : kEachLane) {
            const Vec3f from{place(random), place(random), 0}, to{place(random), place(random), 128};
            origin.Set(i, from), direction.Set(i, Normalize(to - from));
        }
        SkyHits hits;
        faces.Find(origin, direction, farthest, live, 0, hits);
        for (const std::size_t i : kEachLane) {
            const Slow slow = NearestTriangle(skies, Vec3d(origin[i]), Vec3d(direction[i]), 0, 10000);
            const Vec3d p = Vec3d(origin[i]) + Vec3d(direction[i]) * (128 / double(direction[i].z));
            // All edges, also those between triangles, where the slow search may miss, are on multiples of 64 or on
            // diagonals.
            const auto nearEdge = [](double x) { return std::abs(std::remainder(x, 64)) < 0.2; };
            if (nearEdge(p.x) || nearEdge(p.y))
                continue;
            ASSERT_EQ(hits.hit[i] != 0, slow.skyIndex >= 0) << p.x << ' ' << p.y;
            (hits.hit[i] != 0 ? met : missed)++;
        }
    }
    EXPECT_GT(met, 5000);
    EXPECT_GT(missed, 5000);
}

TEST(SkyFacesTest, SkiesOfManyPiecesOrBentOnesAreLeftToTheTree) {
    Triangles scattered;
    for (int i = 0; i < 50; ++i)
        AddFan(scattered, {{0, float(4 * i), 0}, {0, float(4 * i + 2), 0}, {9, float(4 * i), 0}}, 1);
    EXPECT_FALSE(SkyFaces(scattered, IndexesOf(scattered)).Few());
    Triangles folded;
    AddFan(folded, {{0, 0, 0}, {0, 256, 0}, {256, 256, 32}, {256, 0, 0}}, 1);
    EXPECT_FALSE(SkyFaces(folded, IndexesOf(folded)).Few());
    Triangles many;
    for (int i = 0; i < 50; ++i)
        AddFan(many, {{0, 0, float(i)}, {0, 256, float(i)}, {256, 256, float(i)}, {256, 0, float(i)}}, i);
    EXPECT_FALSE(SkyFaces(many, IndexesOf(many)).Few());
    EXPECT_FALSE(SkyFaces(Triangles(), {}).Few());
}

} // namespace
} // namespace q3
