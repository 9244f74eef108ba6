// GPL-2.0-or-later. Fog volumes: what is in them, and where faces and patches are cut.
#include "common/error.h"
#include "q3map2/geometry/effects/fog.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "tests/geometry/extra_scene.h"

#include <gmock/gmock.h>

namespace q3::test {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

class FogTest : public ExtraTest {
  protected:
    FogTest() {
        Script(
            "textures/test/fog\n{\nsurfaceparm fog\nsurfaceparm nonsolid\nsurfaceparm trans\nfogparms ( 1 1 1 ) 64\n}\n"
            "textures/test/slope\n{\nsurfaceparm fog\nsurfaceparm trans\nfogparms ( 1 1 1 ) 64\n"
            "q3map_fogDir ( 1 0 0 )\n}\n"
            "textures/test/clear\n{\nq3map_noFog\n}\n");
    }
    /// Fogs all surfaces of the world.
    void Fog() {
        geometry.fogs = CollectFogs(map, Context(), geometry.defaultFog);
        FogWorldSurfaces(map, geometry, map.planes, Context());
    }
    void MakeFaces() { MakeFaceSurfaces(map.World(), geometry, map.planes, Context()); }
    double FaceArea(const ShaderInfo &shader, int fog) const {
        double area = 0;
        for (const DrawSurface &s : geometry.surfaces) {
            Polygon w;
            for (const DrawVert &vert : s.verts)
                w.push_back(vert.xyz);
            if (s.shader == &shader && s.fogNum == fog)
                area += WindingArea(w);
        }
        return area;
    }
};

TEST_F(FogTest, AFaceIsCutAtTheBordersOfTheFog) {
    AddBox({0, 0, -16}, {256, 256, 0}, "textures/test/wall");
    AddBox({64, 64, -8}, {128, 192, 64}, "textures/test/fog");
    map.World().brushes[1].sides.at(0).culled = true; // its own faces are of no interest
    for (BrushSide &side : map.World().brushes[1].sides)
        side.visibleHull.clear();
    MakeFaces();
    const double before = FaceArea(Shader("textures/test/wall"), -1);
    Fog();
    const ShaderInfo &wall = Shader("textures/test/wall");
    EXPECT_NEAR(FaceArea(wall, 0), 64 * 128, 0.1);
    EXPECT_NEAR(FaceArea(wall, 0) + FaceArea(wall, -1), before, 0.1);
    int inFog = 0, top = 0;
    for (const DrawSurface &s : geometry.surfaces) {
        inFog += s.fogNum == 0;
        top += s.verts[0].normal == Vec3f{0, 0, 1};
        for (const DrawVert &vert : s.verts) // texture stays where it was
            EXPECT_EQ(vert.st[0], 0);
    }
    EXPECT_EQ(inFog, 1);
    EXPECT_EQ(top, 5); // four fragments around it
}

TEST_F(FogTest, FacesOnTheBorderBelongToTheSideTheyFace) {
    AddBox({0, 0, -16}, {64, 64, 0}, "textures/test/wall"); // its top is the floor of the fog
    AddBox({0, 0, 64}, {64, 64, 80}, "textures/test/wall"); // its bottom the ceiling
    AddBox({64, 0, 0}, {80, 64, 64}, "textures/test/wall"); // its -x side a wall
    AddBox({0, 0, 0}, {64, 64, 64}, "textures/test/fog");
    for (BrushSide &side : map.World().brushes[3].sides)
        side.visibleHull.clear();
    MakeFaces();
    Fog();
    for (const DrawSurface &s : geometry.surfaces) {
        const Vec3f &n = s.verts[0].normal;
        const bool faces = (s.brush == 0 && n.z == 1) || (s.brush == 1 && n.z == -1) || (s.brush == 2 && n.x == -1);
        EXPECT_EQ(s.fogNum, faces ? 0 : -1) << "brush " << s.brush << " normal " << n.x << n.y << n.z;
    }
}

TEST_F(FogTest, TheFogsOwnFacesFogOnlyTheirInnerTwins) {
    AddBox({0, 0, 0}, {64, 64, 64}, "textures/test/fog");
    MakeFaces();
    ASSERT_THAT(geometry.surfaces, SizeIs(12));
    Fog();
    for (const DrawSurface &s : geometry.surfaces) {
        const Vec3f outward = BoundsOf(s).Center() - Vec3f{32, 32, 32};
        EXPECT_EQ(s.fogNum, Dot(outward, s.verts[0].normal) > 0 ? -1 : 0);
    }
}

TEST_F(FogTest, ShadersWithoutFogStayWithout) {
    AddBox({0, 0, 0}, {32, 32, 32}, "textures/test/clear");
    AddBox({-64, -64, -64}, {64, 64, 64}, "textures/test/fog");
    MakeFaces();
    Fog();
    for (const DrawSurface &s : geometry.surfaces)
        if (s.brush == 0) {
            EXPECT_EQ(s.fogNum, -1);
        }
}

TEST_F(FogTest, TheGlobalFogTakesWhatNoOtherHas) {
    map.World().pairs.Set("_fog", "textures/test/fog");
    AddBox({0, 0, 0}, {32, 32, 32}, "textures/test/wall");
    AddBox({500, 0, 0}, {532, 32, 32}, "textures/test/wall");
    AddBox({-64, -64, -64}, {64, 64, 64}, "textures/test/fog");
    for (BrushSide &side : map.World().brushes[2].sides)
        side.visibleHull.clear();
    MakeFaces();
    Fog();
    ASSERT_THAT(geometry.fogs, SizeIs(2));
    EXPECT_EQ(geometry.fogs[1].brush, -1);
    EXPECT_EQ(geometry.defaultFog, 1);
    for (const DrawSurface &s : geometry.surfaces)
        EXPECT_EQ(s.fogNum, s.brush == 0 ? 0 : 1);
}

TEST_F(FogTest, AGlobalFogThatIsNoneIsAnError) {
    map.World().pairs.Set("_fog", "textures/test/wall");
    try {
        CollectFogs(map, Context(), geometry.defaultFog);
        FAIL() << "no error";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), HasSubstr("textures/test/wall"));
        EXPECT_THAT(error.what(), HasSubstr("fogparms"));
    }
}

TEST_F(FogTest, FogDirectionChoosesTheVisibleSide) {
    AddBox({0, 0, 0}, {64, 64, 64}, "textures/test/slope");
    AddBox({0, 0, 0}, {64, 64, 64}, "textures/test/fog");
    const auto fogs = CollectFogs(map, Context(), geometry.defaultFog);
    ASSERT_THAT(fogs, SizeIs(2));
    EXPECT_EQ(fogs[0].visibleSide, 0); // -x
    EXPECT_EQ(fogs[1].visibleSide, -1);
    options.noFog = true;
    EXPECT_THAT(CollectFogs(map, Context(), geometry.defaultFog), SizeIs(0));
}

TEST_F(FogTest, MovedModelsTakeTheFogTheyAreMostIn) {
    AddBox({0, 0, 0}, {100, 100, 100}, "textures/test/fog");
    AddBox({100, 0, 0}, {200, 100, 100}, "textures/test/fog");
    geometry.fogs = CollectFogs(map, Context(), geometry.defaultFog);
    DrawSurface s;
    for (const Vec3f p : {Vec3f{-20, -20, -20}, Vec3f{20, 20, 20}}) {
        DrawVert vert;
        vert.xyz = p;
        s.verts.push_back(vert);
    }
    EXPECT_EQ(FogOfModelSurface(s, {90, 50, 50}, map, geometry), 0);
    EXPECT_EQ(FogOfModelSurface(s, {110, 50, 50}, map, geometry), 1);
    EXPECT_EQ(FogOfModelSurface(s, {500, 50, 50}, map, geometry), -1);
}

class PatchCutTest : public FogTest {
  protected:
    /// A wall from z = 0 to 64 whose rows or columns rise.
    static DrawSurface Wall(bool rowsRise) {
        DrawSurface s;
        s.kind = SurfaceKind::Patch;
        s.width = s.height = 3;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) {
                const int up = rowsRise ? row : column, along = rowsRise ? column : row;
                DrawVert vert;
                vert.xyz = {float(along) * 32, 0, float(up) * 32};
                vert.st = {float(along), float(up)};
                s.verts.push_back(vert);
            }
        return s;
    }
};

TEST_F(PatchCutTest, KeepsOddSizesAndMeetsAtThePlane) {
    for (const bool rowsRise : {true, false}) {
        const PatchCut cut = CutPatchSurface(Wall(rowsRise), {{0, 0, 1}, 48}, 0.1);
        ASSERT_EQ(cut.result, PatchCut::Cut);
        for (const DrawSurface *s : {&cut.inside, &cut.outside}) {
            EXPECT_EQ(s->width % 2, 1);
            EXPECT_EQ(s->height % 2, 1);
            EXPECT_EQ(s->verts.size(), std::size_t(s->width * s->height));
            for (const DrawVert &vert : s->verts)
                EXPECT_FLOAT_EQ(vert.st[1], vert.xyz.z / 32);
        }
        EXPECT_EQ(BoundsOf(cut.inside).mins.z, 0);
        EXPECT_EQ(BoundsOf(cut.inside).maxs.z, 48);
        EXPECT_EQ(BoundsOf(cut.outside).mins.z, 48);
        EXPECT_EQ(BoundsOf(cut.outside).maxs.z, 64);
    }
}

TEST_F(PatchCutTest, TurningTheGridKeepsItsFront) {
    for (const bool rowsRise : {true, false}) {
        const DrawSurface wall = Wall(rowsRise);
        const PatchCut cut = CutPatchSurface(wall, {{0, 0, 1}, 48}, 0.1);
        for (const DrawSurface *s : {&cut.inside, &cut.outside}) {
            const auto at = [&](int column, int row) { return s->verts[std::size_t(row * s->width + column)].xyz; };
            const Vec3f front = Cross(at(s->width - 1, 0) - at(0, 0), at(0, s->height - 1) - at(0, 0));
            EXPECT_GT(rowsRise ? -front.y : front.y, 0);
        }
    }
}

TEST_F(PatchCutTest, KnowsWhatLiesOnOneSide) {
    EXPECT_EQ(CutPatchSurface(Wall(true), {{0, 0, 1}, 65}, 0.1).result, PatchCut::Inside);
    EXPECT_EQ(CutPatchSurface(Wall(true), {{0, 0, 1}, -1}, 0.1).result, PatchCut::Outside);
    EXPECT_EQ(CutPatchSurface(Wall(true), {{0, 0, 1}, 0}, 0.1).result, PatchCut::Outside);
}

TEST_F(PatchCutTest, SlantedCutsAreImpossible) {
    const Vec3d slant = Normalize(Vec3d{1, 0, 1});
    EXPECT_EQ(CutPatchSurface(Wall(true), {slant, Dot(slant, Vec3d{32, 0, 36})}, 0.1).result, PatchCut::Impossible);
}

TEST_F(PatchCutTest, APatchThroughTheTopOfAFogIsFoggedBelowIt) {
    AddBox({-64, -64, -64}, {128, 64, 48}, "textures/test/fog");
    Patch patch = FlatPatch(0, 0, 64, 64, 0, Shader("textures/test/wall"));
    for (DrawVert &vert : patch.verts) {
        vert.xyz.z = vert.xyz.y;
        vert.xyz.y = 0;
    }
    map.World().patches = {patch};
    MakePatchSurfaces(map.World(), geometry, map.planes, Context());
    Fog();
    ASSERT_THAT(geometry.surfaces, SizeIs(2));
    for (const DrawSurface &s : geometry.surfaces)
        EXPECT_EQ(s.fogNum, BoundsOf(s).maxs.z <= 48 ? 0 : -1);
}

} // namespace
} // namespace q3::test
