// GPL-2.0-or-later. Derived surfaces: copies, fog hull, portals, flares, fur, sky box, patch meshes, terrain.
#include "q3map2/geometry/effects/fog.h"
#include "q3map2/geometry/effects/surface_effects.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "q3map2/map/index_map.h"
#include "tests/geometry/extra_scene.h"

#include <array>

#include <gmock/gmock.h>

namespace q3::test {
namespace {

using testing::SizeIs;

class DerivedTest : public ExtraTest {
  protected:
    DrawSurface &AddTriangle(const ShaderInfo &shader) {
        DrawSurface s;
        s.kind = SurfaceKind::Triangles;
        s.shader = &shader;
        for (const Vec3f p : {Vec3f{0, 0, 0}, Vec3f{0, 64, 0}, Vec3f{64, 0, 0}}) {
            DrawVert vert;
            vert.xyz = p, vert.normal = {0, 0, 1};
            s.verts.push_back(vert);
        }
        s.indexes = {0, 1, 2};
        geometry.surfaces.push_back(s);
        return geometry.surfaces.back();
    }
};

TEST_F(DerivedTest, CloneShadersCloneAgainBackShadersDoNot) {
    Script("textures/test/a\n{\nq3map_cloneShader textures/test/b\nq3map_backShader textures/test/c\n}\n"
           "textures/test/b\n{\nq3map_cloneShader textures/test/d\n}\n"
           "textures/test/c\n{\nq3map_cloneShader textures/test/d\n}\n");
    AddTriangle(Shader("textures/test/a"));
    MakeDerivedSurfaces(geometry, 0, Context());
    std::vector<std::pair<std::string, bool>> made;
    for (const DrawSurface &s : geometry.surfaces)
        made.emplace_back(s.shader->name, s.backSide);
    EXPECT_THAT(made,
                testing::UnorderedElementsAre(std::pair{"textures/test/a", false}, std::pair{"textures/test/b", false},
                                              std::pair{"textures/test/c", true}, std::pair{"textures/test/d", false}));
}

TEST_F(DerivedTest, ShadersThatCloneEachOtherEnd) {
    Script("textures/test/a\n{\nq3map_cloneShader textures/test/b\n}\n"
           "textures/test/b\n{\nq3map_cloneShader textures/test/a\n}\n");
    AddTriangle(Shader("textures/test/a"));
    MakeDerivedSurfaces(geometry, 0, Context());
    EXPECT_THAT(geometry.surfaces, SizeIs(testing::Le(32u)));
}

TEST_F(DerivedTest, CelShadersCopyWhatIsSolidToTheEye) {
    Script("textures/test/glass\n{\nsurfaceparm trans\n}\n");
    AddTriangle(Shader("textures/test/wall")).settings.celShader = &Shader("textures/cel");
    AddTriangle(Shader("textures/test/glass")).settings.celShader = &Shader("textures/cel");
    MakeDerivedSurfaces(geometry, 0, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(3));
    EXPECT_EQ(geometry.surfaces[2].shader->name, "textures/cel");
}

TEST_F(DerivedTest, TheFogHullFacesInwardsFromAllSides) {
    AddBox({0, 0, 0}, {256, 128, 64}, "textures/test/wall");
    map.World().pairs.Set("_foghull", "sky/haze");
    MakeFogHull(map, geometry, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(1));
    const DrawSurface &hull = geometry.surfaces[0];
    EXPECT_EQ(hull.kind, SurfaceKind::FogHull);
    EXPECT_EQ(hull.shader->name, "textures/sky/haze");
    EXPECT_EQ(BoundsOf(hull).mins, (Vec3f{-128, -128, -128}));
    EXPECT_EQ(BoundsOf(hull).maxs, (Vec3f{384, 256, 192}));
    ASSERT_THAT(hull.indexes, SizeIs(36));
    std::array<double, 6> area{};
    for (std::size_t t = 0; t < 12; ++t) {
        const Vec3d n = TriangleNormal(hull, t);
        const Vec3d corner(hull.verts[std::size_t(hull.indexes[3 * t])].xyz);
        EXPECT_GT(Dot(n, Vec3d{128, 64, 32} - corner), 0) << "triangle " << t;
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (n[axis] != 0)
                area[axis * 2 + (n[axis] > 0)] += 1;
    }
    EXPECT_THAT(area, testing::Each(2));
}

TEST_F(DerivedTest, FlaresOfLightsAndShaders) {
    Script("textures/test/lamp\n{\nq3map_flareShader flares/lamp\n}\n");
    AddEntity({{"classname", "light"},
               {"_flareshader", "flares/a"},
               {"origin", "0 0 64"},
               {"target", "x"},
               {"_color", "1 0.5 0"}});
    AddEntity({{"classname", "light"}, {"_flare", "1"}, {"origin", "8 0 64"}});
    AddEntity({{"classname", "light"}});
    AddEntity({{"classname", "info_null"}, {"targetname", "x"}, {"origin", "64 0 64"}});
    MakeFlares(map, geometry, Context());
    EXPECT_THAT(geometry.surfaces, SizeIs(0));
    options.flares = true;
    MakeFlares(map, geometry, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(2));
    EXPECT_EQ(geometry.surfaces[0].shader->name, "flares/a");
    EXPECT_EQ(geometry.surfaces[0].lightmapOrigin, (Vec3f{0, 0, 64}));
    EXPECT_EQ(geometry.surfaces[0].lightmapVecs[0], (Vec3f{1, 0.5, 0}));
    EXPECT_EQ(geometry.surfaces[0].lightmapVecs[2], (Vec3f{1, 0, 0}));
    EXPECT_EQ(geometry.surfaces[1].lightmapVecs[2], (Vec3f{0, 0, -1}));
    AddTriangle(Shader("textures/test/lamp"));
    MakeShaderFlare(2, {100, 0, 0}, geometry, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(4));
    EXPECT_NEAR(geometry.surfaces[3].lightmapOrigin.x, 100 + 64. / 3, 1e-3);
    EXPECT_NEAR(geometry.surfaces[3].lightmapOrigin.z, 2, 1e-5);
}

TEST_F(DerivedTest, FlaresHaveTheShaderOfTheGameAndTheStyleOfTheirLight) {
    gameName = "ja";
    Script("textures/test/lamp\n{\nlight 1\nq3map_lightStyle 5\n}\n");
    AddEntity({{"classname", "light"}, {"_flare", "1"}, {"style", "33"}});
    options.flares = true;
    MakeFlares(map, geometry, Context());
    AddTriangle(Shader("textures/test/lamp"));
    MakeShaderFlare(1, {}, geometry, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(3));
    EXPECT_EQ(geometry.surfaces[0].shader->name, "gfx/misc/flare");
    EXPECT_EQ(geometry.surfaces[0].lightStyle, 33);
    EXPECT_EQ(geometry.surfaces[2].shader->name, "gfx/misc/flare");
    EXPECT_EQ(geometry.surfaces[2].lightStyle, 5);
}

TEST_F(DerivedTest, PortalsToLookAtAreThePassableOnes) {
    Tree tree;
    tree.nodes.resize(4); // a split, two open leafs, a solid one
    tree.nodes[0].planeNum = map.planes.Find({1, 0, 0}, 0);
    tree.nodes[0].children = {1, 2};
    tree.nodes[3].opaque = true;
    for (const std::array<int, 2> leafs : {std::array{1, 2}, std::array{1, 3}}) {
        TreePortal portal;
        portal.polygon = {{0, 0, 0}, {0, 0, 64}, {0, 64, 64}, {0, 64, 0}};
        portal.plane = {{1, 0, 0}, 0};
        portal.onNode = 0;
        portal.nodes = leafs;
        tree.portals.push_back(portal);
    }
    MakePortalSurfaces(tree, geometry, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(1));
    EXPECT_EQ(geometry.surfaces[0].shader->name, "debugportals");
    EXPECT_THAT(geometry.surfaces[0].verts, SizeIs(4));
    EXPECT_EQ(geometry.surfaces[0].verts[0].color[3], 32);
    EXPECT_THAT(geometry.surfaces[0].indexes, testing::ElementsAre(0, 1, 2, 0, 2, 3));
}

TEST_F(DerivedTest, FurStacksLayersByAlpha) {
    Script("textures/test/fur\n{\nq3map_fur 4 2 0.25\n}\n");
    AddTriangle(Shader("textures/test/fur")).verts[1].color[3] = 0;
    MakeFur(0, geometry);
    ASSERT_THAT(geometry.surfaces, SizeIs(4));
    for (int layer = 0; layer < 4; ++layer) {
        const DrawSurface &s = geometry.surfaces[std::size_t(layer)];
        EXPECT_FLOAT_EQ(s.verts[0].xyz.z, 2 + 2 * float(layer));
        EXPECT_FLOAT_EQ(s.verts[1].xyz.z, 0);
        EXPECT_EQ(s.verts[0].color[3], layer == 0 ? 255 : 191);
    }
    MakeFur(2, geometry);
    EXPECT_THAT(geometry.surfaces, SizeIs(4));
}

TEST_F(DerivedTest, SkyBoxCopiesAreSeenFromTheEntity) {
    AddEntity({{"classname", "_skybox"}, {"origin", "16 0 0"}, {"_scale", "10"}, {"angle", "90"}});
    const auto transform = ReadSkyBox(map);
    ASSERT_TRUE(transform);
    const DrawSurface copy = SkyBoxCopy(AddTriangle(Shader("textures/test/wall")), 7, *transform);
    EXPECT_EQ(copy.parent, 7);
    // (64 0 0) is 48 to the right of the entity: 480, then turned to y
    EXPECT_NEAR(copy.verts[2].xyz.x, 0, 1e-3);
    EXPECT_NEAR(copy.verts[2].xyz.y, 480, 1e-3);
    EXPECT_NEAR(copy.verts[0].normal.z, 1, 1e-6);
}

TEST_F(DerivedTest, PatchMeshesCoverTheirPatches) {
    options.meta = options.patchMeta = true;
    Script("textures/test/web\n{\nsurfaceparm nonsolid\n}\n");
    map.World().patches = {FlatPatch(0, 0, 64, 64, 0, Shader("textures/test/wall")),
                           FlatPatch(0, 0, 64, 64, 8, Shader("textures/test/web"))};
    MakePatchSurfaces(map.World(), geometry, map.planes, Context());
    MakePatchMeshes(map.World(), geometry, 0, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(4));
    EXPECT_TRUE(geometry.surfaces[0].collisionOnly);
    EXPECT_TRUE(geometry.surfaces[1].Empty());
    for (std::size_t i = 2; i < 4; ++i) {
        const DrawSurface &mesh = geometry.surfaces[i];
        EXPECT_EQ(mesh.kind, SurfaceKind::ForcedMeta);
        EXPECT_EQ(BoundsOf(mesh).maxs.x, 64);
        for (std::size_t t = 0; t < mesh.indexes.size() / 3; ++t)
            EXPECT_NEAR(TriangleNormal(mesh, t).z, 1, 1e-6);
    }
}

TEST_F(DerivedTest, WithoutMetaPatchesStayPatches) {
    options.patchMeta = true;
    map.World().patches = {FlatPatch(0, 0, 64, 64, 0, Shader("textures/test/wall"))};
    MakePatchSurfaces(map.World(), geometry, map.planes, Context());
    MakePatchMeshes(map.World(), geometry, 0, Context());
    ASSERT_THAT(geometry.surfaces, SizeIs(1));
    EXPECT_FALSE(geometry.surfaces[0].collisionOnly);
}

/// A 2 x 2 grey picture, rows from the top: 0 128 / 128 255.
std::string GreyTga() {
    std::string file(18, '\0');
    file[2] = 3, file[12] = 2, file[14] = 2, file[16] = 8, file[17] = 0x20;
    for (const int value : {0, 128, 128, 255})
        file += char(value);
    return file;
}

class TerrainTest : public DerivedTest {
  protected:
    TerrainTest() {
        Script("textures/test/ground\n{\nq3map_indexed\nq3map_nonplanar\nq3map_forceMeta\n}\n");
        folder.Write("maps/index.tga", GreyTga());
    }
    MapEntity &World() {
        AddBox({0, 0, -8}, {128, 128, 0}, "textures/test/ground");
        Entity &pairs = map.World().pairs;
        pairs.Set("_indexmap", "maps/index.tga");
        pairs.Set("_layers", "2");
        pairs.Set("_shader", "hills");
        return map.World();
    }
};

TEST_F(TerrainTest, LayersComeFromThePictureSeenFromAbove) {
    const auto index = ReadIndexMap(World(), {}, Context());
    ASSERT_TRUE(index);
    EXPECT_EQ(index->LayerAt({1, 127, 0}), 0);   // top left
    EXPECT_EQ(index->LayerAt({127, 127, 0}), 1); // top right
    EXPECT_EQ(index->LayerAt({1, 1, 0}), 1);
    EXPECT_EQ(index->LayerAt({-500, 9999, 0}), 0); // clamped
}

TEST_F(TerrainTest, FacesTakeShaderAlphaAndHeight) {
    World().pairs.Set("_offsets", "0 32");
    const auto index = ReadIndexMap(map.World(), {}, Context());
    map.World().brushes[0].settings.indexMap = index;
    MakeFaceSurfaces(map.World(), geometry, map.planes, Context());
    ApplyIndexedTerrain(geometry, 0, Context());
    for (const DrawSurface &s : geometry.surfaces) {
        int high = 0;
        for (const DrawVert &vert : s.verts)
            high = std::max(high, index->LayerAt(vert.xyz));
        for (const DrawVert &vert : s.verts)
            EXPECT_EQ(vert.color[3], index->LayerAt(vert.xyz) == high ? 255 : 0);
        EXPECT_TRUE(s.shader->geometry.nonPlanar && s.shader->geometry.forceMeta);
        if (s.verts[0].normal.z == 1) {
            EXPECT_EQ(s.shader->name, "textures/hills_0to1");
            for (const DrawVert &vert : s.verts)
                EXPECT_EQ(vert.xyz.z, index->LayerAt(vert.xyz) == 1 ? 32 : 0);
        }
    }
}

TEST_F(TerrainTest, MissingKeysWarnAndDoNothing) {
    World().pairs.Set("_layers", "0");
    EXPECT_FALSE(ReadIndexMap(map.World(), {}, Context()));
    EXPECT_THAT(out.text, testing::HasSubstr("Entity 0: its index map has no effect: expected \"_layers\""));
}

} // namespace
} // namespace q3::test
