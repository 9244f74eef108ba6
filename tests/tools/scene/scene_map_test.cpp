// GPL-2.0-or-later. Scenes of boxes as map sources: what they say, and that the bsp stage makes the same room of them.
#include "common/error.h"
#include "tests/support/compiled_map.h"
#include "tests/support/light_fixture.h"

#include <random>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

int ClusterAt(const Bsp &bsp, const Vec3d &p) {
    int node = 0;
    while (node >= 0) {
        const bspNode_t &at = bsp.nodes[std::size_t(node)];
        const bspPlane_t &plane = bsp.planes[std::size_t(at.planeNum)];
        double d = -double(plane.dist);
        for (std::size_t axis = 0; axis < 3; axis++)
            d += double(plane.normal[axis]) * p[axis];
        node = at.children[d >= 0 ? 0 : 1];
    }
    return bsp.leafs[std::size_t(-1 - node)].cluster;
}

Bsp Compiled(const SceneBuilder &scene) {
    KeptLog quiet;
    VirtualFileSystem vfs(quiet.log);
    vfs.Mount(TEST_DATA "/vectors/baseq3", "pk3");
    return CompiledScene(scene, vfs);
}

TEST(SceneMap, SolidIsWhatTheBoxesFill) {
    std::mt19937 random(5);
    const auto below = [&](int most) { return float(random() % unsigned(most)); };
    for (int round = 0; round < 20; round++) {
        SceneBuilder scene = Room();
        std::vector<Boundsf> solids;
        for (int i = 0; i < 8; i++) {
            const Vec3f mins{-250 + below(400), -186 + below(300), 4 + below(180)};
            const Boundsf box{mins, mins + Vec3f{8 + below(200), 8 + below(200), 8 + below(200)}};
            const bool detail = i % 4 == 3;
            scene.AddBox(box.mins, box.maxs, TestShader("textures/test/box"),
                         detail ? BoxKind::Detail : BoxKind::Structural);
            if (!detail)
                solids.push_back(box);
        }
        ASSERT_TRUE(scene.HasMapText());
        const Bsp bsp = Compiled(scene);
        for (int i = 0; i < 500; i++) {
            const Vec3d p{-259.5 + double(below(520)), -195.5 + double(below(390)), -5.5 + double(below(267))};
            const bool solid = !Inside(p, RoomBounds(), 0) ||
                               std::ranges::any_of(solids, [&](const Boundsf &box) { return Inside(p, box, 0); });
            ASSERT_EQ(ClusterAt(bsp, p) < 0, solid) << round << ": " << p.x << ' ' << p.y << ' ' << p.z;
        }
    }
}

TEST(SceneMap, RoomsApartFromEachOtherStayOpen) {
    SceneBuilder scene = Room({-256, -64, 0}, {256, 64, 128});
    scene.AddBox({-8, -64, 0}, {8, 64, 128}, TestShader("textures/test/wall"));
    const Bsp bsp = Compiled(scene);
    EXPECT_GE(ClusterAt(bsp, {-100, 1, 64}), 0);
    EXPECT_GE(ClusterAt(bsp, {100, 1, 64}), 0);
    EXPECT_LT(ClusterAt(bsp, {1, 1, 64}), 0);
}

TEST(SceneMap, ModelsAndFacesKeepTheirShaders) {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/test/ceiling"));
    scene.AddInlineModel({0, 0, 100}, {32, 32, 132}, TestShader("textures/test/door"),
                         MakeEntity("func_door", {{"angle", "90"}}));
    const Bsp bsp = Compiled(scene);
    ASSERT_EQ(bsp.models.size(), 2u);
    EXPECT_EQ(bsp.models[1].numBSPSurfaces, 6);
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        if (FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader) == "textures/test/ceiling") {
            EXPECT_EQ(bsp.drawVerts[std::size_t(surface.firstVert)].xyz[2], RoomBounds().maxs.z);
        }
    EXPECT_THAT(bsp.entities, testing::HasSubstr("\"model\" \"*1\""));
}

TEST(SceneMap, WhatNoSourceSaysIsRefused) {
    SceneBuilder quad = Room();
    quad.AddQuad({{{0, 0, 50}, {0, 40, 50}, {40, 40, 50}, {40, 0, 50}}}, TestShader("textures/test/quad"));
    EXPECT_FALSE(quad.HasMapText());
    EXPECT_THROW((void)quad.MapText(), Error);
    SceneBuilder fine = Room();
    fine.AddBox({0, 0, 50.01f}, {8, 8, 60}, TestShader("textures/test/box"));
    EXPECT_FALSE(fine.HasMapText()) << "draw vertices are rounded to eighths";
    SceneBuilder outside = Room();
    outside.AddEntity(MakeEntity("light", {{"origin", "0 0 9000"}}));
    EXPECT_FALSE(outside.HasMapText()) << "it would leak";
}

} // namespace

} // namespace q3::test
