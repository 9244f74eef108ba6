// GPL-2.0-or-later. Draw surfaces of brush sides and patches, their classification and subdivision.
#include "common/error.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "q3map2/map/map_texture.h"
#include "tests/geometry/faces/face_scene.h"

#include <algorithm>
#include <cmath>

namespace q3::test {
namespace {

class SideTest : public FaceTest {
  protected:
    SideTest() { entity.brushes.emplace_back(); }
    /// The first brush's side with this polygon as its winding and hull.
    BrushSide &AddSide(const Polygon &w, const ShaderInfo &of) {
        BrushSide side;
        side.shader = &of;
        side.winding = side.visibleHull = w;
        const Vec3d normal = Normalize(-WindingAreaVector(w));
        side.planeNum = planes.Find(normal, Dot(normal, Vec3d(w.front())));
        side.texture.vecs = {{{1. / 64, 0, 0, 0.5}, {0, -1. / 32, 0, 0}}};
        entity.brushes.front().sides.push_back(side);
        return entity.brushes.front().sides.back();
    }
    void Make() { MakeFaceSurfaces(entity, geometry, planes, context); }
    const DrawSurface &Surface(std::size_t i) const { return geometry.surfaces[i]; }
    MapEntity entity;
};

const Polygon kSquare{{0, 0, 64.07f}, {0, 64, 64.07f}, {64, 64, 64.07f}, {64, 0, 64.07f}};

TEST_F(SideTest, VerticesSnapToEighths) {
    AddSide(kSquare, shader);
    Make();
    ASSERT_EQ(geometry.surfaces.size(), 1u);
    EXPECT_EQ(entity.brushes[0].sides[0].surface, 0);
    for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(Surface(0).verts[i].xyz, (Vec3f{kSquare[i].x, kSquare[i].y, 64.125f}));
    EXPECT_FLOAT_EQ(Surface(0).verts[2].st[0], 1.5f);
    EXPECT_FLOAT_EQ(Surface(0).verts[2].st[1], -2);
    EXPECT_EQ(Surface(0).verts[0].normal, (Vec3f{0, 0, 1}));
    options.snapVertices = false;
    Make();
    EXPECT_EQ(Surface(1).verts[0].xyz, kSquare[0]);
}

TEST_F(SideTest, TextureStaysWithTheOriginBrush) {
    entity.brushes.front().textureOrigin = {64, 32, 0};
    AddSide(kSquare, shader);
    Make();
    EXPECT_FLOAT_EQ(Surface(0).verts[0].st[0], 1.5f);
    EXPECT_FLOAT_EQ(Surface(0).verts[0].st[1], -1);
}

TEST_F(SideTest, HiddenAndInvisibleSidesMakeNone) {
    ShaderInfo invisible = shader;
    invisible.compileFlags |= C_NODRAW;
    AddSide(kSquare, shader).culled = true;
    AddSide(kSquare, invisible);
    AddSide(kSquare, shader).visibleHull.clear();
    AddSide(kSquare, shader).shader = nullptr;
    Make();
    EXPECT_TRUE(geometry.surfaces.empty());
}

TEST_F(SideTest, WholeFaceOfShadersThatAreNotClipped) {
    ShaderInfo whole = shader;
    whole.geometry.noClip = true;
    AddSide(kSquare, whole).visibleHull = {{0, 0, 64}, {0, 32, 64}, {32, 32, 64}};
    Make();
    EXPECT_EQ(Surface(0).verts.size(), 4u);
}

TEST_F(SideTest, FogIsSeenFromBothSides) {
    ShaderInfo fog = shader;
    fog.compileFlags |= C_FOG;
    AddSide(kSquare, fog);
    Make();
    ASSERT_EQ(geometry.surfaces.size(), 2u);
    EXPECT_EQ(Surface(1).planeNum, Surface(0).planeNum ^ 1);
    EXPECT_EQ(Surface(1).verts[0].normal, (Vec3f{0, 0, -1}));
    EXPECT_EQ(Surface(1).verts[0].xyz, Surface(0).verts[3].xyz);
}

TEST_F(SideTest, TessellationCutsAlongTheWorldGrid) {
    shader.geometry.tessSize = 64;
    AddSide({{-256, -256, 0}, {-256, 256, 0}, {256, 256, 0}, {256, -256, 0}}, shader);
    Make();
    geometry.surfaces[0].fogNum = 3;
    SubdivideFaces(entity, geometry, 0, planes, context);
    EXPECT_EQ(std::ranges::count_if(geometry.surfaces, [](const DrawSurface &s) { return !s.Empty(); }), 64);
    for (std::size_t i = 1; i < geometry.surfaces.size(); ++i) {
        EXPECT_EQ(Surface(i).fogNum, 3);
        EXPECT_EQ(Surface(i).verts.size(), 4u);
        for (const DrawVert &v : Surface(i).verts)
            EXPECT_EQ(std::fmod(v.xyz.x, 64.f), 0);
    }
}

TEST_F(SideTest, TessellationCutsFacesThatBeginBesideTheGrid) {
    shader.geometry.tessSize = 64;
    AddSide({{-0.05f, 0, 0}, {-0.05f, 64, 0}, {256, 64, 0}, {256, 0, 0}}, shader);
    Make();
    SubdivideFaces(entity, geometry, 0, planes, context);
    std::vector<float> ends;
    for (const DrawSurface &s : geometry.surfaces)
        if (!s.Empty())
            ends.push_back(s.bounds.maxs.x);
    EXPECT_THAT(ends, testing::UnorderedElementsAre(64, 128, 192, 256));
}

TEST_F(SideTest, SkyAndSmallFacesAreNotCut) {
    ShaderInfo sky = shader;
    sky.compileFlags |= C_SKY;
    sky.geometry.tessSize = 16;
    shader.geometry.tessSize = 64;
    AddSide(kSquare, sky);
    AddSide(kSquare, shader);
    Make();
    SubdivideFaces(entity, geometry, 0, planes, context);
    EXPECT_EQ(geometry.surfaces.size(), 2u);
}

TEST_F(SideTest, TooFineAGridIsAnError) {
    options.maxDrawSurfaces = 100;
    shader.geometry.tessSize = 1;
    AddSide(kSquare, shader);
    Make();
    EXPECT_THROW(SubdivideFaces(entity, geometry, 0, planes, context), Error);
}

class ClassTest : public FaceTest {
  protected:
    DrawSurface &Classified() {
        ClassifySurface(geometry.surfaces.back(), planes, context);
        return geometry.surfaces.back();
    }
};

TEST_F(ClassTest, LightmapAxisIsTheDominantOneOfTheNormal) {
    const std::array<std::pair<Vec3d, Vec3f>, 5> cases{{{{0.1, 0.2, -1}, {0, 0, -1}},
                                                        {{1, 0, 1}, {0, 0, 1}},
                                                        {{-1, 1, 0}, {-1, 0, 0}},
                                                        {{0.3, -1, 0.2}, {0, -1, 0}},
                                                        {{1, 0.5, -1.1}, {0, 0, -1}}}};
    for (const auto &[direction, axis] : cases) {
        const Vec3d n = Normalize(direction), u = Normalize(Cross(n, Vec3d{0.3, 0.9, 0.1})), v = Cross(n, u);
        AddFace({Vec3f(u * 64), Vec3f(v * -64), Vec3f(u * -64)});
        EXPECT_EQ(Classified().lightmapAxis, axis);
    }
}

TEST_F(ClassTest, SampleSizeOfShaderEntityOrOption) {
    options.sampleSize = 8;
    AddFloor(0, 0, 64, 64);
    EXPECT_EQ(Classified().sampleSize, 8);
    geometry.surfaces.back().settings.sampleSize = 24;
    EXPECT_EQ(Classified().sampleSize, 24);
    geometry.surfaces.back().settings.lightmapScale = 0.5f;
    EXPECT_EQ(Classified().sampleSize, 12);
    EXPECT_EQ(Classified().sampleSize, 12) << "scaled once, however often it is asked for";
    shader.lightmap.sampleSize = 4;
    EXPECT_EQ(Classified().sampleSize, 2);
    options.minSampleSize = 6;
    EXPECT_EQ(Classified().sampleSize, 6);
    geometry.surfaces.back().settings.lightmapScale = 1e9f;
    EXPECT_EQ(Classified().sampleSize, 16384);
}

TEST_F(ClassTest, CurvedSurfaceHasTheAxisThatAllNormalsFace) {
    DrawSurface &s = AddFloor(0, 0, 64, 64);
    s.kind = SurfaceKind::ForcedMeta, s.planeNum = -1;
    s.verts[0].xyz.z = 20;
    s.verts[1].normal = Normalize(Vec3f{1, 0, 1});
    EXPECT_EQ(Classified().lightmapAxis, Vec3f{});
    s.kind = SurfaceKind::Patch;
    EXPECT_EQ(Classified().lightmapAxis, (Vec3f{0, 0, 1}));
    EXPECT_FALSE(s.planar);
    EXPECT_EQ(s.lightmapVecs[2], Vec3f{});
    s.verts[1].normal = {1, 0, 0};
    EXPECT_EQ(Classified().lightmapAxis, Vec3f{});
}

TEST_F(ClassTest, FlatSurfaceWithoutPlaneGetsOne) {
    DrawSurface &s = AddFloor(0, 0, 64, 64, 32);
    s.kind = SurfaceKind::Triangles, s.planeNum = -1;
    const DrawSurface &c = Classified();
    EXPECT_TRUE(c.planar);
    ASSERT_GE(c.planeNum, 0);
    EXPECT_EQ(planes[c.planeNum].dist, 32);
    EXPECT_EQ(c.lightmapAxis, Vec3f{}) << "models are lit at vertices";
    EXPECT_EQ(c.sampleSize, 0);
}

TEST_F(ClassTest, FlatPatchLiesInAPlane) {
    for (const float bump : {0.f, 16.f}) {
        MapEntity entity;
        Patch patch;
        patch.shader = &shader;
        patch.width = patch.height = 3;
        for (int i = 0; i < 9; ++i) {
            DrawVert v;
            v.xyz = {float(32 * (i % 3)), float(32 * (i / 3)), i == 4 ? bump : 0};
            patch.verts.push_back(v);
        }
        patch.lodBounds.Add(Vec3f{-8, -8, -8}), patch.lodBounds.Add(Vec3f{80, 80, 8});
        entity.patches.push_back(patch);
        geometry.surfaces.clear();
        MakePatchSurfaces(entity, geometry, planes, context);
        ASSERT_EQ(geometry.surfaces.size(), 1u);
        const DrawSurface &s = geometry.surfaces[0];
        EXPECT_EQ(s.kind, SurfaceKind::Patch);
        EXPECT_EQ(s.planar, bump == 0);
        EXPECT_EQ(s.lightmapVecs[0], (Vec3f{-8, -8, -8}));
        EXPECT_EQ(s.lightmapVecs[1], (Vec3f{80, 80, 8}));
        EXPECT_EQ(s.lightmapVecs[2], bump == 0 ? (Vec3f{0, 0, 1}) : Vec3f{});
        EXPECT_EQ(s.verts.size(), 9u);
    }
}

TEST_F(SideTest, GeneratedCoordinatesOfPatchesAndBrushesAgree) {
    ShaderInfo generated = shader;
    generated.geometry.hasTexGen = true;
    generated.geometry.texGen = {Vec3f{1.f / 64, 0, 0}, Vec3f{0, 1.f / 32, 1.f / 16}};
    Patch patch;
    patch.shader = &generated;
    patch.width = patch.height = 3;
    for (int i = 0; i < 9; ++i) {
        DrawVert v;
        v.xyz = {float(32 * (i % 3)), float(32 * (i / 3)), 64};
        patch.verts.push_back(v);
    }
    // An origin brush at 64 32 8, and a key of its own besides, which moves the entity in the game only.
    entity.brushOrigin = entity.brushes.front().textureOrigin = {64, 32, 8};
    entity.origin = entity.brushOrigin + Vec3f{100, 200, 300};
    BrushSide &side = AddSide({{0, 0, 64}, {0, 64, 64}, {64, 64, 64}, {64, 0, 64}}, generated);
    side.texture = FinalProjection(side.texture, generated.geometry, false);
    entity.patches.push_back(patch);
    Make();
    MakePatchSurfaces(entity, geometry, planes, context);
    ASSERT_EQ(geometry.surfaces.size(), 2u);
    int shared = 0;
    for (const DrawVert &a : Surface(0).verts)
        for (const DrawVert &b : Surface(1).verts)
            if (a.xyz == b.xyz) {
                EXPECT_FLOAT_EQ(a.st[0], (a.xyz.x + 64) / 64);
                EXPECT_FLOAT_EQ(a.st[1], (a.xyz.y + 32) / 32 + (a.xyz.z + 8) / 16);
                EXPECT_FLOAT_EQ(b.st[0], a.st[0]);
                EXPECT_FLOAT_EQ(b.st[1], a.st[1]);
                ++shared;
            }
    EXPECT_EQ(shared, 4);
}

} // namespace
} // namespace q3::test
