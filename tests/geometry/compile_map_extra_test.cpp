// GPL-2.0-or-later. Whole compiles of what shaders and entities add to a map: copies, layers, plants, layers of
// terrain, clip brushes of models.
#include "tests/support/compile_fixture.h"

#include <cmath>
#include <map>
#include <set>

namespace q3::test {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

/// Walls of 16 units around this open box, of one shader inside and out.
std::string Walls(const Vec3d &mins, const Vec3d &maxs, std::string_view shader) {
    std::string text;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const bool more : {false, true}) {
            Vec3d low = mins - Vec3d{16, 16, 16}, high = maxs + Vec3d{16, 16, 16};
            (more ? low : high)[axis] = (more ? maxs : mins)[axis];
            text += Box(low, high, shader);
        }
    return text;
}

class CompileExtraTest : public CompileTest {
  protected:
    std::vector<Vec3f> PointsOf(const Bsp &bsp, const bspDrawSurface_t &surface) const {
        std::vector<Vec3f> points;
        for (int i = 0; i < surface.numVerts; ++i)
            points.emplace_back(bsp.drawVerts[std::size_t(surface.firstVert + i)].xyz);
        return points;
    }
    std::vector<int> IndexesOf(const Bsp &bsp, const bspDrawSurface_t &surface) const {
        const auto first = bsp.drawIndexes.begin() + surface.firstIndex;
        return {first, first + surface.numIndexes};
    }
    /// Surfaces of the shader that face up.
    std::vector<bspDrawSurface_t> TopsOf(const Bsp &bsp, std::string_view shader) const {
        std::vector<bspDrawSurface_t> tops = SurfacesOf(bsp, shader);
        std::erase_if(
            tops, [&](const auto &surface) { return bsp.drawVerts[std::size_t(surface.firstVert)].normal[2] < 0.9f; });
        return tops;
    }
    void Script(std::string_view text) { folder.Write("scripts/more.shader", text); }
};

TEST_F(CompileExtraTest, SkyBoxesAreDrawnASecondTimeAroundTheirEntity) {
    const std::string box = "{\n\"classname\" \"_skybox\"\n\"origin\" \"608 0 64\"\n\"_scale\" \"10\"\n}\n";
    const std::string brushes = RoomText(true) + Box({-128, -128, 128}, {128, 128, 144}, "test/sky") +
                                Walls({576, -32, 32}, {640, 32, 96}, "test/far");
    const CompiledMap map = Compile(MapText(brushes) + box);
    const Bsp &bsp = map.bsp;
    const auto surfaces = SurfacesOf(bsp, "textures/test/far");
    ASSERT_THAT(surfaces, SizeIs(12));
    std::set<std::array<float, 3>> near, far;
    for (const bspDrawSurface_t &surface : surfaces)
        for (const Vec3f &p : PointsOf(bsp, surface)) {
            const bool isCopy = surface.lightmapVecs[2] == Float3{};
            (isCopy ? far : near).insert({p.x, p.y, p.z});
        }
    EXPECT_THAT(near, SizeIs(8));
    EXPECT_THAT(far, SizeIs(8));
    for (const auto &[x, y, z] : near)
        EXPECT_TRUE(far.contains({10 * (x - 608), 10 * y, 10 * (z - 64)})) << x << ' ' << y << ' ' << z;
    EXPECT_THAT(map.surfaceFile, HasSubstr("\tparent "));
    EXPECT_THAT(bsp.entities, testing::Not(HasSubstr("_skybox")));
}

TEST_F(CompileExtraTest, CopiesOfSkyBoxesAreInTheLeafsThatSeeTheSky) {
    const std::string box = "{\n\"classname\" \"_skybox\"\n\"origin\" \"608 0 64\"\n}\n";
    const Bsp bsp = Compile(MapText(RoomText(true) + Box({-128, -128, 128}, {128, 128, 144}, "test/sky") +
                                        Walls({576, -32, 32}, {640, 32, 96}, "test/far"),
                                    "\"_blocksize\" \"0\"\n") +
                            box)
                        .bsp;
    for (const bspLeaf_t &leaf : bsp.leafs) {
        bool sky = false, copy = false;
        for (int i = 0; i < leaf.numBSPLeafSurfaces; ++i) {
            const auto &surface =
                bsp.drawSurfaces[std::size_t(bsp.leafSurfaces[std::size_t(leaf.firstBSPLeafSurface + i)])];
            const std::string shader = ShaderOf(bsp, surface);
            sky = sky || shader == "textures/test/sky";
            copy = copy || (shader == "textures/test/far" && surface.lightmapVecs[2] == Float3{});
        }
        EXPECT_EQ(copy, sky);
    }
}

TEST_F(CompileExtraTest, FurIsLayersAboveEachOther) {
    Script("textures/test/fur\n{\nsurfaceparm detail\nq3map_fur 3 4 0.25\n}\n");
    const Bsp bsp = Compile(MapText(RoomText() + Box({-32, -32, 0}, {32, 32, 16}, "test/fur"))).bsp;
    std::map<float, int> alphaOfHeight;
    for (const bspDrawSurface_t &surface : TopsOf(bsp, "textures/test/fur"))
        for (int i = 0; i < surface.numVerts; ++i) {
            const bspDrawVert_t &vert = bsp.drawVerts[std::size_t(surface.firstVert + i)];
            alphaOfHeight[vert.xyz[2]] = vert.color[0][3];
        }
    EXPECT_THAT(alphaOfHeight, ElementsAre(std::pair(20.f, 255), std::pair(24.f, 191), std::pair(28.f, 191)));
}

TEST_F(CompileExtraTest, FoliageIsASurfaceOfModelAndPlaces) {
    Script("textures/test/meadow\n{\nsurfaceparm detail\nq3map_foliage models/t/m.obj 2 16 1 2\n}\n");
    folder.Write("models/t/m.obj", "usemtl leaf\nv 0 0 0\nv 4 0 0\nv 0 8 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    for (const bool inset : {false, true}) {
        options.debugInset = inset;
        const Bsp bsp = Compile(MapText(RoomText() + Box({-64, -64, 0}, {64, 64, 16}, "test/meadow"))).bsp;
        const auto plants = SurfacesOf(bsp, "models/t/leaf");
        ASSERT_THAT(plants, SizeIs(1));
        EXPECT_EQ(plants[0].surfaceType, MST_FOLIAGE);
        EXPECT_EQ(plants[0].patchHeight, 3);
        EXPECT_GE(plants[0].patchWidth, 128); // triangles with edges of at most 16 on 128 x 128
        ASSERT_EQ(plants[0].numVerts, plants[0].patchWidth + plants[0].patchHeight);
        const std::vector<Vec3f> points = PointsOf(bsp, plants[0]);
        for (std::size_t i = 3; i < points.size(); ++i) {
            EXPECT_FLOAT_EQ(points[i].z, 16);
            EXPECT_LT(std::max(std::abs(points[i].x), std::abs(points[i].y)), 64);
        }
    }
}

TEST_F(CompileExtraTest, SpritesThatTurnAboutTheirLongAxisBeginWithAShortEdge) {
    Script("textures/test/flame\n{\nsurfaceparm detail\ndeformVertexes autosprite2\n}\n");
    for (const bool inset : {false, true}) { // a sprite is one quad in any case
        options.debugInset = inset;
        const Bsp bsp = Compile(MapText(RoomText() + Box({-32, -2, 8}, {32, 2, 24}, "test/flame"))).bsp;
        const auto sprites = SurfacesOf(bsp, "textures/test/flame");
        ASSERT_THAT(sprites, SizeIs(6));
        for (const bspDrawSurface_t &sprite : sprites) {
            EXPECT_THAT(IndexesOf(bsp, sprite), ElementsAre(3, 0, 2, 2, 0, 1));
            const std::vector<Vec3f> p = PointsOf(bsp, sprite);
            EXPECT_LT(Length(p[1] - p[0]), Length(p[2] - p[1]));
        }
        EXPECT_EQ(out.log.WarningCount("sprite shape"), 0);
    }
}

TEST_F(CompileExtraTest, InsetTrianglesStandAUnitInsideTheirCorners) {
    options.debugInset = true;
    const Bsp bsp = Compile(MapText(RoomText())).bsp;
    ASSERT_THAT(bsp.drawSurfaces, SizeIs(6));
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
        EXPECT_EQ(surface.numVerts, 6);
        EXPECT_EQ(surface.numIndexes, 6);
        for (const Vec3f &p : PointsOf(bsp, surface)) {
            const Vec3f corner{p.x < 0 ? -128.f : 128.f, p.y < 0 ? -128.f : 128.f, p.z < 64 ? 0.f : 128.f};
            EXPECT_NEAR(Length(p - corner), 1, 1e-4);
        }
    }
}

/// 2 x 2 texels of 8 bits; rows of 2 bytes, palettes left out.
std::string PcxText(const std::array<int, 4> &texels) {
    std::string file(128, '\0');
    file[0] = 10, file[1] = 5, file[2] = 1, file[3] = 8;
    file[8] = 1, file[10] = 1; // last column and row
    file[65] = 1, file[66] = 2;
    for (const int texel : texels)
        file += char(texel);
    return file;
}

TEST_F(CompileExtraTest, PaletteNumbersOfAnIndexMapAreLayers) {
    Script("textures/test/ground\n{\nsurfaceparm detail\nq3map_indexed\n}\n");
    folder.Write("maps/index.pcx", PcxText({0, 2, 2, 3}));
    const std::string keys = "\"_indexmap\" \"maps/index.pcx\"\n\"_layers\" \"4\"\n\"_shader\" \"hills\"\n"
                             "\"_offsets\" \"0 8 16 24\"\n\"min\" \"-64 -64 0\"\n\"max\" \"64 64 16\"\n";
    const Bsp bsp = Compile(MapText(RoomText() + Box({-64, -64, 0}, {64, 64, 16}, "test/ground"), keys)).bsp;
    const auto tops = TopsOf(bsp, "textures/hills_0to3");
    std::set<int> seen;
    for (const bspDrawSurface_t &top : tops)
        for (int i = 0; i < top.numVerts; ++i) {
            const bspDrawVert_t &vert = bsp.drawVerts[std::size_t(top.firstVert + i)];
            const int layer = vert.xyz[1] > 0 ? (vert.xyz[0] < 0 ? 0 : 2) : (vert.xyz[0] < 0 ? 2 : 3);
            EXPECT_FLOAT_EQ(vert.xyz[2], 16 + 8 * float(layer));
            EXPECT_EQ(vert.color[0][3], layer == 3 ? 255 : 0);
            seen.insert(layer);
        }
    EXPECT_THAT(seen, ElementsAre(0, 2, 3));
}

bool HoldsPoint(const Bsp &bsp, const Vec3d &p) {
    return std::ranges::any_of(bsp.brushes, [&](const bspBrush_t &brush) {
        for (int i = 0; i < brush.numSides; ++i) {
            const auto &side = bsp.brushSides[std::size_t(brush.firstSide + i)];
            const bspPlane_t &plane = bsp.planes[std::size_t(side.planeNum)];
            if (Dot(Vec3d(Vec3f(plane.normal)), p) > double(plane.dist))
                return false;
        }
        return true;
    });
}

TEST_F(CompileExtraTest, EachClipModeMakesTheModelSolidOnItsSide) {
    // A ramp that rises from z = 0 to 64 over 128 units of x and faces up; its middle is put at (0 0 40).
    folder.Write("models/t/ramp.obj", "usemtl textures/test/wall\nv 0 0 0\nv 128 64 0\nv 128 64 -64\nv 0 0 -64\n"
                                      "vn -0.447 0.894 0\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
    const auto compiled = [&](int flags) {
        return Compile(MapText(RoomText()) + fmt::format("{{\n\"classname\" \"misc_model\"\n\"origin\" \"-64 -32 8\"\n"
                                                         "\"model\" \"models/t/ramp.obj\"\n\"spawnflags\" \"{}\"\n}}\n",
                                                         flags))
            .bsp;
    };
    const double x = 64 / 3., y = -32 / 3., z = 152 / 3.; // the middle of its first triangle
    const Bsp none = compiled(0);
    EXPECT_EQ(none.brushes.size(), 6u);
    EXPECT_FALSE(HoldsPoint(none, {x, y, z - 1}));
    for (const int mode : {2,           8,           16,        128,        256,         8 + 256,    128 + 256,
                           256 + 4096,  512,         1024,      512 + 1024, 4096,        4096 + 16,  4096 + 512,
                           4096 + 1024, 4096 + 1536, 2048 + 16, 2048 + 512, 2048 + 1024, 2048 + 1536}) {
        const bool isUp = (mode & 1536) == 1024;
        const Bsp bsp = compiled(mode);
        EXPECT_GT(bsp.brushes.size(), 6u) << mode;
        EXPECT_EQ(HoldsPoint(bsp, {x, y, z - 1}), !isUp) << mode;
        EXPECT_EQ(HoldsPoint(bsp, {x, y, z + 1}), isUp) << mode;
    }
    EXPECT_EQ(out.log.WarningCount("unknown clip mode"), 0);
    EXPECT_EQ(compiled(8 + 2048).brushes.size(), 6u);
    EXPECT_EQ(out.log.WarningCount("unknown clip mode"), 1);
}

} // namespace

} // namespace q3::test
