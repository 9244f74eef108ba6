// GPL-2.0-or-later. Which surfaces rays need to meet besides solids.
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/scene/shadow_casters.h"
#include "tests/support/light_fixture.h"
#include "tests/support/surface_case.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

double Area(const Triangles &triangles) {
    double area = 0;
    for (std::size_t i = 0; i < triangles.Count(); ++i)
        area += WindingArea(triangles.Corners(i));
    return area;
}

class CastersTest : public testing::Test {
  protected:
    TrianglesByKind Casters(const SceneBuilder &scene) {
        SurfaceCase made(scene, folder);
        return ShadowCasters(made.bsp, made.table, made.settings.light);
    }
    GameFolder folder;
};

TEST_F(CastersTest, FacesOfSolidsAreMetAsSolidsAlone) {
    SceneBuilder scene = Room({0, 0, 0}, {512, 256, 128});
    scene.AddBox({64, 64, 32}, {128, 128, 96}, TestShader("textures/test/wall"), BoxKind::Structural);
    const TrianglesByKind casters = Casters(scene);
    const double room = 2.0 * (512 * 256 + 512 * 128 + 256 * 128), box = 6.0 * 64 * 64;
    EXPECT_EQ(casters[kSurfaces].Count(), 0u);
    EXPECT_EQ(casters[kLegacySurfaces].Count(), 0u);
    EXPECT_GE(Area(casters[kSolids]), room + box);
}

TEST_F(CastersTest, FacesInTheOpenAreMetThemselves) {
    SceneBuilder scene = Room({0, 0, 0}, {512, 256, 128});
    scene.AddBox({64, 64, 32}, {128, 128, 96}, TestShader("textures/test/wall"), BoxKind::Detail);
    const TrianglesByKind casters = Casters(scene);
    EXPECT_NEAR(Area(casters[kSurfaces]), 6.0 * 64 * 64, 1);
}

/// A face that only in part lies on a solid blocks rays beside that.
TEST_F(CastersTest, FacesThatOverhangSolidsAreMetThemselves) {
    SceneBuilder scene = Room({0, 0, 0}, {512, 256, 128});
    scene.AddBox({64, 64, 0}, {128, 128, 64}, TestShader("textures/test/wall"), BoxKind::Structural);
    scene.AddQuad({{{96, 64, 64}, {96, 128, 64}, {160, 128, 64}, {160, 64, 64}}}, TestShader("textures/test/wall"));
    const TrianglesByKind casters = Casters(scene);
    EXPECT_NEAR(Area(casters[kSurfaces]), 64 * 64, 1);
}

TEST_F(CastersTest, DirtMeetsFacesOfSolidsAsSolidsAlone) {
    SceneBuilder scene = Room({0, 0, 0}, {512, 256, 128});
    scene.AddBox({64, 64, 32}, {128, 128, 96}, TestShader("textures/test/wall"), BoxKind::Structural);
    scene.AddBox({256, 64, 32}, {288, 96, 64}, TestShader("textures/test/wall"), BoxKind::Detail);
    SurfaceCase made(scene, folder);
    TrianglesByKind casters;
    AddBlockers(made.bsp, made.table, made.settings.light, casters);
    EXPECT_NEAR(Area(casters[kBlockerSurfaces]), 6.0 * 32 * 32, 1);
    EXPECT_GE(Area(casters[kBlockerSolids]), 2.0 * (512 * 256 + 512 * 128 + 256 * 128) + 6.0 * 64 * 64);
}

/// Rays along x from x = 16 to 240; what stands in their way 32 or 128 units on.
TEST_F(CastersTest, TheLegacyGridIgnoresSurfacesThatAreNearButNoSolids) {
    SceneBuilder scene = Room({0, 0, 0}, {256, 512, 128});
    const auto quad = [&](float x, float y) {
        scene.AddQuad({{{x, y - 16, 32}, {x, y + 16, 32}, {x, y + 16, 96}, {x, y - 16, 96}}},
                      TestShader("textures/test/wall"));
    };
    quad(48, 64), quad(144, 160), quad(48, 256), quad(144, 256);
    scene.AddBox({40, 336, 16}, {48, 368, 112}, TestShader("textures/test/wall"), BoxKind::Structural);
    SurfaceCase made(scene, folder);
    const LightScene traced(made.bsp, made.table, made.settings.light, 64);
    const auto arrives = [&](ShadowRules rules) {
        RayPacket rays;
        std::size_t lane = 0;
        for (const float y : {64.0f, 160.0f, 256.0f, 352.0f, 448.0f})
            rays.Aim(lane++, {16, y, 64}, {240, y, 64});
        RayCounts counts;
        traced.TraceToLight(rays, rules, counts);
        return rays.live.Bits();
    };
    EXPECT_EQ(arrives(ShadowRules::LegacyGrid), 1u << 0 | 1u << 4) << "past the near quad, and with nothing in the way";
    EXPECT_EQ(arrives(ShadowRules::Exact), 1u << 4);
}

} // namespace

} // namespace q3::test
