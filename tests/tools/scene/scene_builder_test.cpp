// GPL-2.0-or-later. Maps made of boxes: what a stage that reads them relies on.
#include "common/error.h"
#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "tests/support/kept_log.h"
#include "tests/support/scene/demo_scene.h"
#include "tests/support/scene/scene_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <set>

namespace q3 {
namespace {

const SceneShader kWall{"textures/test/wall"};
const SceneShader kRed{"textures/test/red"};

/// The leaf an engine finds at p.
const bspLeaf_t &LeafOf(const Bsp &bsp, const Vec3f &p) {
    std::int32_t at = 0;
    while (at >= 0) {
        const bspNode_t &node = bsp.nodes[std::size_t(at)];
        const bspPlane_t &plane = bsp.planes[std::size_t(node.planeNum)];
        at = node.children[Dot(Vec3f(plane.normal), p) - plane.dist > 0 ? 0 : 1];
    }
    return bsp.leafs[std::size_t(-1 - at)];
}

double Volume(const bspLeaf_t &leaf) {
    double volume = 1;
    for (std::size_t axis = 0; axis < 3; axis++)
        volume *= leaf.maxs[axis] - leaf.mins[axis];
    return volume;
}

struct Boxes {
    Boundsf interior{{-256, -192, 0}, {256, 192, 256}};
    std::vector<Boundsf> solid, detail;
    SceneBuilder builder;

    explicit Boxes(unsigned seed, int count = 12) {
        std::mt19937 random(seed);
        builder.SetInterior(interior.mins, interior.maxs, kWall);
        const auto within = [&](float low, float high) {
            return std::floor(std::uniform_real_distribution(low, high)(random));
        };
        for (int i = 0; i < count; i++) {
            const Vec3f mins(within(-256, 200), within(-192, 150), within(0, 200));
            const Vec3f maxs = mins + Vec3f(within(4, 120), within(4, 120), within(4, 120));
            const bool isDetail = i % 4 == 3;
            builder.AddBox(mins, maxs, kRed, isDetail ? BoxKind::Detail : BoxKind::Structural);
            (isDetail ? detail : solid).push_back({mins, maxs});
        }
    }

    bool Solid(const Vec3f &p) const {
        return !interior.Contains(p) || std::ranges::any_of(solid, [&](const Boundsf &box) { return box.Contains(p); });
    }
};

TEST(SceneBuilder, ValidatesWithoutAWarning) {
    for (unsigned seed = 0; seed < 20; seed++) {
        Boxes boxes(seed);
        boxes.builder.SetVisibility({.writeLump = true});
        test::KeptLog log;
        EXPECT_NO_THROW(ValidateBsp(boxes.builder.Build(), "scene", log.log));
        EXPECT_EQ(log.text, "");
    }
}

TEST(SceneBuilder, SurvivesItsFile) {
    Boxes boxes(3);
    const Bsp bsp = boxes.builder.Build();
    test::KeptLog log;
    const Bsp back = ReadBsp(WriteBsp(bsp, {}), "scene", {}, log.log);
    EXPECT_EQ(back.nodes.size(), bsp.nodes.size());
    EXPECT_EQ(back.entities, bsp.entities);
    EXPECT_EQ(WriteBsp(back, {}), WriteBsp(bsp, {}));
}

TEST(SceneBuilder, LeafIsSolidExactlyWhereABoxIs) {
    for (unsigned seed = 0; seed < 10; seed++) {
        const Boxes boxes(seed);
        const Bsp bsp = boxes.builder.Build();
        std::mt19937 random(seed);
        std::uniform_real_distribution<float> x(-300, 300), z(-40, 300);
        for (int i = 0; i < 2000; i++) {
            const Vec3f p(x(random), x(random), z(random));
            const bspLeaf_t &leaf = LeafOf(bsp, p);
            EXPECT_EQ(leaf.cluster < 0, boxes.Solid(p)) << p.x << " " << p.y << " " << p.z;
            EXPECT_EQ(leaf.area, leaf.cluster < 0 ? -1 : 0);
        }
    }
}

TEST(SceneBuilder, OpenLeafsFillTheRoomOnce) {
    SceneBuilder builder;
    builder.SetInterior({0, 0, 0}, {256, 128, 64}, kWall);
    builder.AddBox({64, 32, 0}, {96, 64, 64}, kWall);               // a pillar
    builder.AddBox({80, 48, 16}, {128, 80, 32}, kWall);             // overlaps it by 16 x 16 x 16
    builder.AddBox({200, 100, 0}, {300, 228, 10}, kWall);           // partly in the wall: 56 x 28 x 10 inside
    builder.AddBox({8, 8, 8}, {24, 24, 24}, kRed, BoxKind::Detail); // no solid leaf
    const Bsp bsp = builder.Build();
    double open = 0;
    for (const bspLeaf_t &leaf : bsp.leafs)
        if (leaf.cluster >= 0)
            open += Volume(leaf);
    EXPECT_EQ(open, 256.0 * 128 * 64 - 32 * 32 * 64 - (48 * 32 * 16 - 16 * 16 * 16) - 56 * 28 * 10);
}

TEST(SceneBuilder, TreeIsNumberedDepthFirst) {
    const Bsp bsp = Boxes(5).builder.Build();
    std::int32_t nextNode = 0, nextLeaf = 1, nextCluster = 0;
    std::vector<std::int32_t> open{0};
    while (!open.empty()) {
        const std::int32_t at = open.back();
        open.pop_back();
        if (at < 0) {
            EXPECT_EQ(-1 - at, nextLeaf++);
            const bspLeaf_t &leaf = bsp.leafs[std::size_t(-1 - at)];
            if (leaf.cluster >= 0) {
                EXPECT_EQ(leaf.cluster, nextCluster++);
            } else {
                EXPECT_EQ(leaf.numBSPLeafSurfaces, 0);
                EXPECT_GT(leaf.numBSPLeafBrushes, 0);
            }
            continue;
        }
        EXPECT_EQ(at, nextNode++);
        const bspNode_t &node = bsp.nodes[std::size_t(at)];
        EXPECT_EQ(node.planeNum % 2, 0);
        open.push_back(node.children[1]);
        open.push_back(node.children[0]);
    }
    EXPECT_EQ(std::size_t(nextNode), bsp.nodes.size());
    EXPECT_EQ(std::size_t(nextLeaf), bsp.leafs.size());
    EXPECT_EQ(bsp.leafs[0].numBSPLeafBrushes, 0);
}

TEST(SceneBuilder, BrushSidesAreAxialAndFaceOut) {
    const Bsp bsp = Boxes(6).builder.Build();
    ASSERT_EQ(bsp.brushes.size(), 6u + 12u);
    for (const bspBrush_t &brush : bsp.brushes) {
        ASSERT_EQ(brush.numSides, 6);
        for (std::size_t side = 0; side < 6; side++) {
            const auto number = std::size_t(bsp.brushSides[std::size_t(brush.firstSide) + side].planeNum);
            Float3 normal{};
            normal[side / 2] = side % 2 ? 1.0f : -1.0f;
            EXPECT_EQ(bsp.planes[number].normal, normal);
            EXPECT_EQ(bsp.planes[number ^ 1].dist, -bsp.planes[number].dist);
        }
    }
}

// Clockwise seen from the front: (b - a) x (c - a) points to the back.
TEST(SceneBuilder, TrianglesAreClockwiseAndTheirFrontIsOpen) {
    const Boxes boxes(7);
    const Bsp bsp = boxes.builder.Build();
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
        const auto vert = [&](std::int32_t i) {
            return bsp.drawVerts[std::size_t(surface.firstVert + bsp.drawIndexes[std::size_t(surface.firstIndex + i)])];
        };
        for (std::int32_t i = 0; i < surface.numIndexes; i += 3) {
            const Vec3f a(vert(i).xyz), b(vert(i + 1).xyz), c(vert(i + 2).xyz), normal(vert(i).normal);
            const Vec3f cross = Cross(b - a, c - a);
            EXPECT_NEAR(Dot(Normalize(cross), normal), -1, 1e-6);
            EXPECT_EQ(Vec3f(surface.lightmapVecs[2]), normal);
        }
    }
}

TEST(SceneBuilder, EmptyRoomHasSixFacesOfItsArea) {
    SceneBuilder builder;
    builder.SetInterior({0, 0, 0}, {256, 128, 64}, kWall);
    builder.SetWallShader(BoxFace::PlusZ, kRed);
    const Bsp bsp = builder.Build();
    ASSERT_EQ(bsp.drawSurfaces.size(), 6u);
    double area = 0;
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
        const auto *verts = &bsp.drawVerts[std::size_t(surface.firstVert)];
        area += Length(Cross(Vec3d(verts[1].xyz) - Vec3d(verts[0].xyz), Vec3d(verts[2].xyz) - Vec3d(verts[0].xyz)));
        const Vec3f inside = Vec3f(verts[0].xyz) * 0.5f + Vec3f(verts[2].xyz) * 0.5f + Vec3f(verts[0].normal);
        EXPECT_GE(LeafOf(bsp, inside).cluster, 0) << "the front looks into the room";
        const bool ceiling = verts[0].normal[2] < 0;
        EXPECT_EQ(FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader), ceiling ? kRed.name : kWall.name);
    }
    EXPECT_EQ(area, 2 * (256 * 128 + 256 * 64 + 128 * 64));
    EXPECT_EQ(bsp.leafs.size(), 1u + 6u + 1u);
    EXPECT_EQ(bsp.nodes.size(), 6u);
    const bspLeaf_t &room = LeafOf(bsp, {10, 10, 10});
    EXPECT_EQ(room.numBSPLeafSurfaces, 6);
    EXPECT_EQ(room.numBSPLeafBrushes, 0);
    EXPECT_EQ(bsp.models[0].mins, (Float3{-16, -16, -16}));
    EXPECT_EQ(bsp.models[0].maxs, (Float3{272, 144, 80}));
}

TEST(SceneBuilder, HidesFacesThatCannotBeSeen) {
    SceneBuilder builder;
    builder.SetInterior({0, 0, 0}, {256, 128, 64}, kWall);
    builder.AddBox({64, 32, 0}, {96, 64, 64}, kWall);                                   // floor to ceiling: four faces
    builder.AddBox({200, 10, 8}, {210, 20, 18}, {"textures/test/clip", 0x80, 0x10000}); // nodraw
    EXPECT_EQ(builder.Build().drawSurfaces.size(), 6u + 4u);
}

TEST(SceneBuilder, SurfacesAreListedInTheLeafsTheyBound) {
    SceneBuilder builder;
    builder.SetInterior({-128, -64, 0}, {128, 64, 64}, kWall);
    builder.AddBox({-8, -64, 0}, {8, 64, 64}, kWall); // two separate rooms
    const Bsp bsp = builder.Build();
    const bspLeaf_t &west = LeafOf(bsp, {-60, 0, 30}), &east = LeafOf(bsp, {60, 0, 30});
    EXPECT_NE(west.cluster, east.cluster);
    EXPECT_EQ(west.numBSPLeafSurfaces, 6);
    EXPECT_EQ(east.numBSPLeafSurfaces, 6);
}

TEST(SceneBuilder, VisibilityFollowsTheCallback) {
    SceneBuilder builder;
    builder.SetInterior({-128, -64, 0}, {128, 64, 64}, kWall);
    builder.AddBox({-8, -64, 0}, {8, 64, 64}, kWall);
    EXPECT_TRUE(builder.Build().visibility.empty());
    const auto row = [&](const Bsp &bsp, float x) {
        return bsp.visibility[8 + std::size_t(LeafOf(bsp, {x, 0, 30}).cluster) * 8];
    };
    builder.SetVisibility({.writeLump = true});
    Bsp bsp = builder.Build();
    ASSERT_EQ(bsp.visibility.size(), 8u + 2 * 8);
    EXPECT_EQ(row(bsp, -60), 3);
    EXPECT_EQ(row(bsp, 60), 3);
    // Only what lies east is seen.
    builder.SetVisibility(
        {.writeLump = true, .sees = [](const Boundsf &, const Boundsf &to) { return to.mins.x > 0; }});
    bsp = builder.Build();
    const int east = LeafOf(bsp, {60, 0, 30}).cluster;
    EXPECT_EQ(row(bsp, -60), 3);
    EXPECT_EQ(row(bsp, 60), 1 << east);
    builder.SetVisibility({.clusterPerLeaf = false});
    EXPECT_EQ(LeafOf(builder.Build(), {-60, 0, 30}).cluster, LeafOf(builder.Build(), {60, 0, 30}).cluster);
}

TEST(SceneBuilder, InlineModelsFollowTheWorld) {
    Boxes boxes(8, 3);
    boxes.builder.AddInlineModel({0, 0, 0}, {32, 32, 32}, kRed, {{{"classname", "func_door"}}});
    boxes.builder.AddInlineModel({64, 0, 0}, {96, 32, 32}, kRed, {{{"classname", "func_static"}}});
    const Bsp bsp = boxes.builder.Build();
    ASSERT_EQ(bsp.models.size(), 3u);
    EXPECT_EQ(bsp.models[0].numBSPSurfaces + 12, std::int32_t(bsp.drawSurfaces.size()));
    EXPECT_EQ(bsp.models[2].firstBSPSurface, bsp.models[0].numBSPSurfaces + 6);
    EXPECT_EQ(bsp.models[2].firstBSPBrush, 6 + 3 + 1);
    EXPECT_EQ(bsp.leafs.back().numBSPLeafBrushes, 1);
    const auto entities = ParseEntities(bsp.entities, "scene");
    ASSERT_EQ(entities.size(), 3u);
    EXPECT_EQ(entities[2].Value("model"), "*2");
    EXPECT_GE(LeafOf(bsp, {16, 16, 16}).cluster, -1);
    std::set<std::int32_t> listed(bsp.leafSurfaces.begin(), bsp.leafSurfaces.end());
    EXPECT_EQ(listed.count(bsp.models[2].firstBSPSurface), 1u);
}

TEST(SceneBuilder, PatchFrontIsAlongColumnsCrossRows) {
    SceneBuilder builder;
    builder.SetInterior({0, 0, 0}, {256, 128, 64}, kWall);
    std::vector<Vec3f> points;
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 5; column++)
            points.push_back({float(column) * 8 + 20, float(row) * 8 + 20, 32});
    builder.AddPatch(5, 3, points, kRed);
    const Bsp bsp = builder.Build();
    const bspDrawSurface_t &patch = bsp.drawSurfaces.back();
    EXPECT_EQ(patch.surfaceType, MST_PATCH);
    EXPECT_EQ(patch.patchWidth, 5);
    EXPECT_EQ(patch.numVerts, 15);
    EXPECT_EQ(bsp.drawVerts[std::size_t(patch.firstVert)].normal, (Float3{0, 0, 1}));
}

TEST(SceneBuilder, RefusesWhatNoMapCanHold) {
    SceneBuilder builder;
    EXPECT_THROW(builder.Build(), Error);
    EXPECT_THROW(builder.SetInterior({0, 0, 0}, {1, 1, 0}, kWall), Error);
    builder.SetInterior({0, 0, 0}, {64, 64, 64}, kWall);
    EXPECT_THROW(builder.AddBox({0, 0, 0}, {1, NAN, 1}, kWall), Error);
    EXPECT_THROW(builder.AddBox({0, 0, 0}, {1, 1, 1}, {std::string(64, 'x')}), Error);
    EXPECT_THROW(builder.AddPatch(4, 3, std::vector<Vec3f>(12), kWall), Error);
    EXPECT_THROW(builder.AddPatch(3, 3, std::vector<Vec3f>(8), kWall), Error);
    EXPECT_THROW(builder.SetFaceShader(0, BoxFace::PlusX, kWall), Error);
    const std::array<Vec3f, 3> points{};
    EXPECT_THROW(builder.AddTriangles(points, std::array<std::int32_t, 3>{0, 1, 3}, kWall), Error);
    builder.AddBox({-8, -8, -8}, {72, 72, 72}, kWall);
    EXPECT_THROW(builder.Build(), Error) << "no open space";
}

TEST(DemoScene, IsAValidMapWithItsLightsInTheSource) {
    const DemoMap demo = DemoScene();
    test::KeptLog log;
    EXPECT_NO_THROW(ValidateBsp(demo.bsp, "demo", log.log));
    EXPECT_EQ(log.text, "");
    const auto inBsp = ParseEntities(demo.bsp.entities, "demo");
    for (const Entity &entity : inBsp)
        EXPECT_FALSE(entity.ClassName().starts_with("light"));
    int lights = 0;
    for (const Entity &entity : ParseMapEntities(demo.mapText, "demo.map")) {
        const auto origin = entity.Vector({"origin"});
        if (origin) {
            EXPECT_GE(LeafOf(demo.bsp, *origin).cluster, 0) << entity.Value("origin");
        }
        lights += entity.ClassName() == "light";
    }
    EXPECT_GE(lights, 3);
    for (const bspShader_t &shader : demo.bsp.shaders)
        EXPECT_NE(demo.shaderText.find(std::string(FieldName(shader.shader)) + "\n{"), std::string::npos);
    EXPECT_LT(LeafOf(demo.bsp, {200, 128, 100}).cluster, 0) << "the thin wall";
    EXPECT_GE(LeafOf(demo.bsp, {256, -128, 310}).cluster, 0) << "the opening in the ceiling";
}

} // namespace
} // namespace q3
