// GPL-2.0-or-later. Decals on faces, patches and models.
#include "q3map2/geometry/effects/decals.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "tests/geometry/extra_scene.h"

#include <gmock/gmock.h>

namespace q3::test {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

class DecalTest : public ExtraTest {
  protected:
    DecalTest() {
        Script("textures/test/blood\n{\n}\n"
               "textures/test/slick\n{\nsurfaceparm nomarks\n}\n");
    }
    /// A decal of 64 x 64 at z = 96 that goes down by 96: its patch faces up.
    void AddDecal(std::string_view target = "t") {
        AddEntity({{"classname", "target_position"}, {"targetname", "t"}, {"origin", "32 32 0"}});
        MapEntity &decal =
            AddEntity({{"classname", "_decal"}, {"target", std::string(target)}, {"origin", "32 32 96"}});
        decal.patches.push_back(FlatPatch(-32, -32, 32, 32, 0, Shader("textures/test/blood")));
    }
    std::vector<DrawSurface> Apply() {
        auto projectors = CollectDecals(map, Context());
        ApplyDecals(projectors, geometry, 0, Context());
        WarnOfLostDecals(projectors, Context());
        std::vector<DrawSurface> decals;
        for (const DrawSurface &s : geometry.surfaces)
            if (s.kind == SurfaceKind::Decal)
                decals.push_back(s);
        return decals;
    }
    void MakeFaces() { MakeFaceSurfaces(map.World(), geometry, map.planes, Context()); }
    static double Area(const std::vector<DrawSurface> &surfaces) {
        double area = 0;
        for (const DrawSurface &s : surfaces) {
            Polygon w;
            for (const DrawVert &vert : s.verts)
                w.push_back(vert.xyz);
            area += WindingArea(w);
        }
        return area;
    }
};

TEST_F(DecalTest, CoversItsShadowWithItsTextureAndFadesWithDistance) {
    AddBox({-128, -128, 16}, {128, 128, 64}, "textures/test/wall"); // top at a third of the way
    AddDecal();
    MakeFaces();
    const auto decals = Apply();
    EXPECT_NEAR(Area(decals), 64 * 64, 1);
    for (const DrawSurface &s : decals) {
        EXPECT_EQ(s.shader->name, "textures/test/blood");
        EXPECT_EQ(s.verts[0].normal, (Vec3f{0, 0, 1}));
        for (const DrawVert &vert : s.verts) {
            EXPECT_FLOAT_EQ(vert.xyz.z, 64);
            EXPECT_NEAR(vert.st[0], vert.xyz.x / 64, 1e-5);
            EXPECT_NEAR(vert.st[1], vert.xyz.y / 64, 1e-5);
            EXPECT_EQ(vert.color[3], 170);
        }
    }
}

TEST_F(DecalTest, LiesAlsoOnPatchesAndModels) {
    map.World().patches = {FlatPatch(-128, -128, 128, 128, 48, Shader("textures/test/wall"))};
    AddDecal();
    MakePatchSurfaces(map.World(), geometry, map.planes, Context());
    EXPECT_NEAR(Area(Apply()), 64 * 64, 1);
}

TEST_F(DecalTest, SkipsSurfacesThatTurnAwayOrTakeNoMarks) {
    AddBox({-128, -128, 60}, {128, 128, 64}, "textures/test/slick");
    AddBox({-128, -128, 100}, {128, 128, 110}, "textures/test/wall"); // behind its start
    AddDecal();
    MakeFaces();
    EXPECT_THAT(Apply(), SizeIs(0));
    EXPECT_THAT(out.text, HasSubstr("Entity 2, Brush 0: the patch of the _decal hits no surface"));
}

TEST_F(DecalTest, FlushWithASurfaceItIsOnItWhicheverWayItsPatchFaces) {
    AddBox({-128, -128, 16}, {128, 128, 96}, "textures/test/wall");
    for (const bool facesUp : {true, false}) {
        AddDecal();
        Patch &patch = map.entities.back().patches.front();
        if (!facesUp)
            for (int row = 0; row < 3; ++row)
                std::swap(patch.verts[std::size_t(3 * row)], patch.verts[std::size_t(3 * row + 2)]);
        geometry.surfaces.clear();
        MakeFaces();
        const auto decals = Apply();
        EXPECT_NEAR(Area(decals), 64 * 64, 1) << facesUp;
        for (const DrawSurface &s : decals)
            for (const DrawVert &vert : s.verts) {
                EXPECT_EQ(vert.xyz.z, 96);
                EXPECT_EQ(vert.normal, (Vec3f{0, 0, 1}));
                EXPECT_EQ(vert.color[3], 255);
            }
    }
    EXPECT_EQ(out.log.WarningCount("decal without surface"), 0);
}

TEST_F(DecalTest, APatchAlongTheDirectionOfItsTargetMakesNone) {
    AddBox({-128, -128, 16}, {128, 128, 64}, "textures/test/wall");
    AddDecal();
    for (DrawVert &vert : map.entities.back().patches.front().verts)
        vert.xyz = {vert.xyz.x, 0, vert.xyz.y};
    MakeFaces();
    EXPECT_THAT(Apply(), SizeIs(0));
    EXPECT_THAT(out.text, HasSubstr("Entity 2, Brush 0: the patch of the _decal makes no decal: it is edge-on"));
}

TEST_F(DecalTest, WithoutTargetOrPatchesItWarnsAndIsLeftOut) {
    AddDecal("nowhere");
    AddEntity({{"classname", "_decal"}, {"target", "t"}});
    EXPECT_THAT(CollectDecals(map, Context()), SizeIs(0));
    EXPECT_THAT(out.text, HasSubstr("Entity 2: a _decal is left out"));
    EXPECT_THAT(out.text, HasSubstr("Entity 3: a _decal without patches"));
    EXPECT_THAT(map.entities[2].patches, SizeIs(0));
}

TEST_F(DecalTest, OnAMovedEntityItStaysInTheWorld) {
    AddBox({-128, -128, 16}, {128, 128, 64}, "textures/test/wall");
    AddDecal();
    MakeFaces();
    for (DrawSurface &s : geometry.surfaces)
        for (DrawVert &vert : s.verts)
            vert.xyz -= Vec3f{1000, 0, 0};
    auto projectors = CollectDecals(map, Context());
    ApplyDecals(projectors, geometry, 0, Context(), {1000, 0, 0});
    int found = 0;
    for (const DrawSurface &s : geometry.surfaces)
        if (s.kind == SurfaceKind::Decal)
            for (const DrawVert &vert : s.verts) {
                ++found;
                EXPECT_NEAR(vert.st[0], (vert.xyz.x + 1000) / 64, 1e-4);
            }
    EXPECT_GT(found, 0);
}

} // namespace
} // namespace q3::test
