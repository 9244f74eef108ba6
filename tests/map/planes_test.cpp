// GPL-2.0-or-later. The plane table, and how planes of maps snap to it.
#include "q3map2/map/planes.h"
#include "tests/map/map_fixture.h"

#include <random>

namespace q3::test {

namespace {

PlaneTable Table() {
    return PlaneTable(0.00005, 0.005);
}

/// The upper plane of a cube of 64 whose top has these heights at (0, 0), (0, 64), (64, 0).
std::string CubeWithTop(double a, double b, double c) {
    std::string text = "{\n";
    std::vector<Plane> planes = BoxPlanes({0, 0, 0}, {64, 64, 64});
    planes.erase(planes.begin() + 4);
    for (const Plane &plane : planes)
        text += SideText(plane);
    return text + fmt::format("( 0 0 {} ) ( 0 64 {} ) ( 64 0 {} ) wall 0 0 0 1 1 0 0 0\n}}\n", a, b, c);
}

} // namespace

TEST(PlaneTable, StoresOppositesInPairsAndPositiveAxesAtEvenNumbers) {
    PlaneTable planes = Table();
    const int down = planes.Find({0, 0, -1}, -64);
    EXPECT_EQ(down, 1);
    EXPECT_EQ(planes.Find({0, 0, 1}, 64), 0);
    const Vec3d slope = Normalize(Vec3d{-1, -2, -3});
    EXPECT_EQ(planes.Find(slope, 5), 2);
    EXPECT_EQ(planes.Find(-slope, -5), 3);
    EXPECT_EQ(planes.Count(), 4);
    EXPECT_EQ(planes[3].normal, -planes[2].normal);
    EXPECT_EQ(planes[3].dist, -planes[2].dist);
}

TEST(PlaneTable, DistancesOnAxesSnapToWholeNumbers) {
    PlaneTable planes = Table();
    EXPECT_EQ(planes[planes.Find({0, 0, 1}, 64.004)].dist, 64);
    EXPECT_FLOAT_EQ(float(planes[planes.Find({0, 0, 1}, 64.006)].dist), 64.006f);
}

TEST(PlaneTable, HoldsFloatValues) {
    for (const Vec3d &normal : {Vec3d{-0.0, 0.1, 1}, Vec3d{0.1, 0, 1}, Vec3d{0.1, 0.7, 1}}) {
        PlaneTable planes = Table();
        const Plane &plane = planes[planes.Find(Normalize(normal), 0.1)];
        EXPECT_EQ(plane.normal, Vec3d(Vec3f(Normalize(normal))));
        EXPECT_EQ(plane.dist, double(0.1f));
    }
}

TEST(PlaneTable, RefusesBadNormals) {
    PlaneTable planes = Table();
    EXPECT_EQ(planes.Find({0, 0, 0.4}, 0), -1);
    EXPECT_EQ(planes.Find({NAN, 0, 1}, 0), -1);
    EXPECT_EQ(planes.Find({0, 0, 1}, INFINITY), -1);
    EXPECT_EQ(planes.Find({0, 0, 1}, 1e60), -1);
    EXPECT_EQ(planes.Count(), 0);
}

TEST(PlaneTable, SnapsNormalsNearAnAxisOrACoordinatePlane) {
    const PlaneTable planes = Table();
    Vec3d near = Normalize(Vec3d{0.00024, -0.00024, 1});
    EXPECT_TRUE(planes.SnapNormal(near));
    EXPECT_EQ(near, (Vec3d{0, 0, 1}));
    Vec3d tilted = Normalize(Vec3d{0.00026, 0.00002, 1});
    EXPECT_TRUE(planes.SnapNormal(tilted));
    EXPECT_EQ(tilted.y, 0);
    EXPECT_GT(tilted.x, 0.00025);
    EXPECT_NEAR(Length(tilted), 1, 1e-12);
    Vec3d free = Normalize(Vec3d{1, 2, 3});
    const Vec3d before = free;
    EXPECT_FALSE(planes.SnapNormal(free));
    EXPECT_EQ(free, before);
}

TEST(PlaneTable, WhatWasFoundIsFoundAgain) {
    PlaneTable planes = Table();
    std::mt19937 random(1);
    std::normal_distribution<double> component;
    std::uniform_real_distribution<double> distance(-4000, 4000), small(-0.0004, 0.0004);
    for (int i = 0; i < 3000; ++i) {
        Vec3d normal = Normalize(Vec3d{component(random), component(random), component(random)});
        if (i % 3 == 0)
            normal = Normalize(Vec3d{small(random), small(random), 1});
        const int number = planes.Find(normal, distance(random));
        ASSERT_GE(number, 0);
        const Plane stored = planes[number];
        EXPECT_NEAR(Length(stored.normal), 1, 1e-6);
        EXPECT_EQ(planes.Find(stored.normal, stored.dist), number);
        EXPECT_EQ(planes.Find(-stored.normal, -stored.dist), number ^ 1);
    }
}

TEST(PlaneTable, MatchesOnlyPlanesThroughThePoints) {
    PlaneTable planes = Table();
    const Vec3d a = Normalize(Vec3d{0.3, 0.4, 1}), b = Normalize(Vec3d{0.30004, 0.4, 1});
    const int first = planes.Find(a, 0);
    EXPECT_EQ(planes.Find(b, 0), first) << "within the epsilons";
    const Vec3d far = Cross(b, Vec3d{0, 1, 0}) * 4000.0;
    EXPECT_NE(planes.Find(b, 0, std::array{far}), first) << "but 4000 units away it is another plane";
}

TEST_F(MapTest, TopOfACubeSnapsWithinFiveThousandths) {
    EXPECT_EQ(Read(WorldText(BoxText({0, 0, 0}, {64, 64, 64.004}))).World().brushes[0].bounds.maxs.z, 64.004f);
    const auto top = [this](double a, double b, double c) {
        Map map = Read(WorldText(CubeWithTop(a, b, c)));
        return map.planes[map.World().brushes.at(0).sides.at(5).planeNum];
    };
    EXPECT_EQ(top(64.004, 64.004, 64.004).dist, 64);
    EXPECT_FLOAT_EQ(float(top(64.006, 64.006, 64.006).dist), 64.006f);
}

TEST_F(MapTest, SlightTiltsOfATopVanish) {
    const double slight = 64 * 2.4e-4, more = 64 * 2.6e-4;
    Map snapped = Read(WorldText(CubeWithTop(64, 64, 64 + slight)));
    const Brush &level = snapped.World().brushes.at(0);
    EXPECT_EQ(level.sides.size(), 6u);
    EXPECT_EQ(snapped.planes[level.sides[5].planeNum].normal, (Vec3d{0, 0, 1}));
    EXPECT_NEAR(snapped.planes[level.sides[5].planeNum].dist, 64 + slight / 3, 1e-5);
    Map kept = Read(WorldText(CubeWithTop(64, 64, 64 + more)));
    const Brush &tilted = kept.World().brushes.at(0);
    EXPECT_EQ(tilted.sides.size(), 7u) << "an axial bevel above the tilted top";
    EXPECT_TRUE(tilted.sides[5].bevel);
}

} // namespace q3::test
