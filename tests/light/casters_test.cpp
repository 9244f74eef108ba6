// GPL-2.0-or-later. Which surfaces rays need to meet besides solids.
#include "q3map2/light/shadow_casters.h"
#include "tests/light/light_test.h"
#include "tests/lightmap/surface_case.h"

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
    EXPECT_NEAR(Area(casters[kCoveredSurfaces]) + Area(casters[kOpenedSurfaces]), room + box, 1);
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

} // namespace

} // namespace q3::test
