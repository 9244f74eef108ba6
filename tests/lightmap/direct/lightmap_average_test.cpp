// GPL-2.0-or-later. Super luxels to luxels, and passes added up.
#include "tests/support/store_fixture.h"

namespace q3::test {

namespace {

using AverageTest = StoreTest;

TEST_F(AverageTest, LuxelIsTheMeanOfItsOpenPlaces) {
    MakeLightmaps(2, 1, 2);
    RawLightmap &raw = surfaces.lightmaps[0];
    Fill(raw, [](int x, int y) { return Vec3f{float(10 * x), float(100 * y), 7}; });
    raw.luxelClusters[raw.SuperIndex(0, 0)] = kOccluded; // has light, but of a place that is not open
    raw.luxelClusters[raw.SuperIndex(1, 0)] = kFlooded;
    Average();
    EXPECT_EQ(raw.result[0][0], (Vec3f{20.0f / 3, 200.0f / 3, 7}));
    EXPECT_EQ(raw.result[0][1], (Vec3f{25, 50, 7}));
}

TEST_F(AverageTest, ClosedPlacesCountWhereNothingIsOpen) {
    MakeLightmaps(2, 1, 2);
    RawLightmap &raw = surfaces.lightmaps[0];
    Fill(raw, [](int x, int) { return Vec3f{float(x), 0, 0}; });
    raw.ambient = {3, 4, 5};
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 4; ++x)
            raw.luxelClusters[raw.SuperIndex(x, y)] = kOccluded, raw.filled[0][raw.SuperIndex(x, y)] = x < 2;
    Average();
    EXPECT_EQ(raw.result[0][0], (Vec3f{0.5f, 0, 0}));
    EXPECT_EQ(raw.result[0][1], (Vec3f{3, 4, 5})) << "a surface without light has the ambient light";
}

TEST_F(AverageTest, RingAroundTheSurfaceTakesItsNeighborsAndTheRestIsUnused) {
    MakeLightmaps(5, 1);
    RawLightmap &raw = surfaces.lightmaps[0];
    Fill(raw, [](int x, int) { return Vec3f{float(10 + x), 1, 2}; });
    for (const int x : {1, 2, 3})
        Unmap(raw, x, 0);
    Average();
    EXPECT_EQ(raw.result[0][1], (Vec3f{10, 1, 2}));
    EXPECT_LT(raw.result[0][2].x, 0);
    EXPECT_EQ(raw.result[0][3], (Vec3f{14, 1, 2}));
}

TEST_F(AverageTest, PassesAddUpAndRadiosityIsTheLatest) {
    MakeLightmaps(3, 3);
    lightmap.bounces = 1;
    RawLightmap &raw = surfaces.lightmaps[0];
    Fill(raw, [](int, int) { return Vec3f{100, 50, -1}; });
    Average({}, false);
    EXPECT_EQ(raw.radiosity[0][4], (Vec3f{100, 50, 0})) << "light below zero is none";
    Fill(raw, [](int, int) { return Vec3f{8, 4, 2}; });
    Average({.bounce = true}, true);
    EXPECT_EQ(raw.result[0][4], (Vec3f{108, 54, 2}));
    EXPECT_TRUE(raw.radiosity[0].empty()) << "nothing bounces any more";
}

TEST_F(AverageTest, BounceOnlyLeavesOutDirectLight) {
    MakeLightmaps(3, 3);
    lightmap.bounces = 1;
    lightmap.bounceOnly = true;
    RawLightmap &raw = surfaces.lightmaps[0];
    Fill(raw, [](int, int) { return Vec3f{100, 50, 25}; });
    Average({}, false);
    EXPECT_EQ(raw.radiosity[0][0], (Vec3f{100, 50, 25}));
    EXPECT_EQ(raw.result[0][0], Vec3f{});
    Fill(raw, [](int, int) { return Vec3f{8, 4, 2}; });
    Average({.bounce = true}, true);
    EXPECT_EQ(raw.result[0][0], (Vec3f{8, 4, 2}));
}

TEST_F(AverageTest, BounceOnlyWithoutBouncesStoresDirectLight) {
    MakeLightmaps(3, 3);
    lightmap.bounceOnly = true;
    Fill(surfaces.lightmaps[0], [](int, int) { return Vec3f{100, 50, 25}; });
    Average();
    EXPECT_EQ(surfaces.lightmaps[0].result[0][0], (Vec3f{100, 50, 25}));
}

TEST_F(AverageTest, DebugModesPaintWhatIsNoCluster) {
    MakeLightmaps(6, 6);
    RawLightmap &raw = surfaces.lightmaps[0];
    Fill(raw, [](int, int) { return Vec3f{9, 9, 9}; });
    raw.luxelClusters[raw.Index(2, 2)] = kUnmapped;
    raw.luxelClusters[raw.Index(3, 2)] = kOccluded;
    raw.luxelClusters[raw.Index(4, 2)] = kFlooded;
    lightmap.debug = lightmap.border = true;
    Average();
    EXPECT_EQ(raw.result[0][raw.Index(2, 2)], (Vec3f{255, 204, 0}));
    EXPECT_EQ(raw.result[0][raw.Index(3, 2)], (Vec3f{255, 0, 255}));
    EXPECT_EQ(raw.result[0][raw.Index(4, 2)], (Vec3f{0, 32, 255}));
    EXPECT_EQ(raw.result[0][raw.Index(0, 3)], (Vec3f{255, 0, 0}));
    EXPECT_EQ(raw.result[0][raw.Index(1, 3)], (Vec3f{9, 9, 9}));
}

} // namespace

} // namespace q3::test
