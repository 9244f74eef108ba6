// GPL-2.0-or-later. The last step over luxels: floodlight, dirt, luxels filled from their neighbors; debug modes.
#include "q3map2/lightmap/direct/lightmap_average.h"
#include "q3map2/lightmap/direct/luxel_light.h"
#include "tests/support/surface_case.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

/// One lightmap of 4 x 3 luxels, set by hand: luxel i has light 10 (i + 1).
class FinishTest : public testing::Test {
  protected:
    static constexpr int kWidth = 4, kHeight = 3;

    FinishTest() : case_(EmptyRoom(), folder_) {
        surfaces_.lightmaps.resize(1);
        RawLightmap &m = Luxels();
        m.width = kWidth, m.height = kHeight;
        const std::size_t count = kWidth * kHeight;
        m.luxelClusters.assign(count, 0);
        m.positions.assign(count, {});
        m.normals.assign(count, {0, 0, 1});
        m.light[0].resize(count);
        m.filled[0].assign(count, 1);
        for (std::size_t i = 0; i < count; ++i)
            m.light[0][i] = Vec3f{1, 1, 1} * (10 * float(i + 1));
    }
    RawLightmap &Luxels() { return surfaces_.lightmaps[0]; }
    void Unmap(std::size_t i, NoCluster code = kUnmapped) {
        Luxels().luxelClusters[i] = code;
        Luxels().light[0][i] = {};
        Luxels().filled[0][i] = 0;
    }
    void Finish(const SurfacePass &pass = {}) { FinishLuxels(case_.Inputs(), pass, surfaces_); }
    float Light(std::size_t i) { return Luxels().light[0][i].x; }

    GameFolder folder_;
    SurfaceCase case_;
    SurfaceLight surfaces_;
};

TEST_F(FinishTest, LuxelsInTheOpenStayAsTheyAre) {
    Finish();
    for (std::size_t i = 0; i < 12; ++i)
        EXPECT_EQ(Light(i), 10 * float(i + 1));
}

TEST_F(FinishTest, UnmappedLuxelsGetTheMeanOfMappedNeighbors) {
    Unmap(0), Unmap(1, kOccluded);
    Finish();
    // Neighbors of the corner: 1 (no), 4, 5. Of its neighbor: 2, 4, 5, 6.
    EXPECT_FLOAT_EQ(Light(0), (50 + 60) / 2.0f);
    EXPECT_FLOAT_EQ(Light(1), (30 + 50 + 60 + 70) / 4.0f);
    EXPECT_EQ(Luxels().luxelClusters[0], kFlooded);
    EXPECT_EQ(Luxels().luxelClusters[1], kFlooded);
    EXPECT_EQ(Luxels().filled[0][0], 1);
}

TEST_F(FinishTest, LuxelsWithoutNeighborsStayUnmapped) {
    for (const std::size_t i : {0u, 1u, 4u, 5u})
        Unmap(i);
    Finish();
    EXPECT_EQ(Luxels().luxelClusters[0], kUnmapped);
    EXPECT_EQ(Luxels().filled[0][0], 0);
    EXPECT_EQ(Luxels().luxelClusters[1], kFlooded);
}

TEST_F(FinishTest, DarkFillsLeanTowardsAmbient) {
    case_.settings.lightmap.dark = true;
    Luxels().ambient = {4, 4, 4};
    Unmap(0);
    Finish();
    EXPECT_FLOAT_EQ(Light(0), (20 + 50 + 60 + 2 * 4) / 5.0f);
}

TEST_F(FinishTest, SplotchesAreFilledFromBrighterNeighbors) {
    Luxels().splotchFix = true;
    Luxels().ambient = {5, 5, 5};
    Luxels().light[0][0] = {5, 5, 5}, Luxels().light[0][1] = {5, 5, 5};
    Finish();
    EXPECT_FLOAT_EQ(Light(0), (50 + 60) / 2.0f);
    // Row by row: the repaired corner counts already.
    EXPECT_FLOAT_EQ(Light(1), (55 + 30 + 50 + 60 + 70) / 5.0f);
    EXPECT_EQ(Luxels().luxelClusters[0], 0);
}

TEST_F(FinishTest, DirtDarkensFloodlightToo) {
    Luxels().dirt.assign(12, 0.5f);
    Luxels().floodlight.assign(12, {8, 16, 24});
    Finish();
    EXPECT_FLOAT_EQ(Light(0), 0.5f * (10 + 8));
    EXPECT_FLOAT_EQ(Luxels().light[0][0].z, 0.5f * (10 + 24));
    // A bounce has no floodlight, but is dirty again.
    Finish({.bounce = true});
    EXPECT_FLOAT_EQ(Light(0), 0.25f * (10 + 8));
}

TEST_F(FinishTest, FloodlightComesAlongTheNormal) {
    case_.settings.lightmap.deluxe = true;
    Luxels().directions.assign(12, {});
    Luxels().floodlight.assign(12, {51, 51, 51});
    Luxels().floodDirectionScale = 0.5f;
    Finish();
    EXPECT_NEAR(Luxels().directions[3].z, 51.0f / 255 * 0.5f, 1e-4f);
    EXPECT_EQ(Luxels().directions[3].x, 0);
}

TEST_F(FinishTest, NormalsAreShownAsColors) {
    case_.settings.lightmap.debugNormals = true;
    Luxels().normals[2] = {-1, 0, 0};
    Finish();
    EXPECT_EQ(Luxels().light[0][2], (Vec3f{0, 127.5f, 127.5f}));
}

TEST_F(FinishTest, DebugModesReplaceTheLight) {
    Luxels().normals[1] = {1, 0, 0};
    Luxels().luxelClusters[2] = 1;
    Luxels().styles = {0, kNoStyle, kNoStyle, kNoStyle};
    const auto shown = [&](DebugView show) {
        case_.settings.lightmap.show = show;
        ContributionCounts counts;
        LightLuxels(case_.Inputs(), {}, {}, surfaces_, counts);
        return Luxels().light[0];
    };
    EXPECT_EQ(shown(DebugView::NormalMap)[1], (Vec3f{255, 127.5f, 127.5f}));
    EXPECT_EQ(shown(DebugView::Cluster)[2], (Vec3f{192, 128, 128}));
    EXPECT_EQ(shown(DebugView::Cluster)[1], (Vec3f{255, 0, 0}));
    EXPECT_EQ(shown(DebugView::Light)[1], (Vec3f{}));
}

} // namespace

} // namespace q3::test
