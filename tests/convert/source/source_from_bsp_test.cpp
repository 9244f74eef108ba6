// GPL-2.0-or-later. Compiled maps back to map sources.
#include "q3map2/convert/source/source_from_bsp.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/map/map_parse.h"
#include "tests/support/library_fixture.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <set>

namespace q3::test {

namespace {

constexpr std::array kAllForms{MapForm::Classic, MapForm::Primitive, MapForm::Valve};

std::string Box(const Vec3d &mins, const Vec3d &maxs, std::string_view shader, int flags = 0,
                std::string_view texture = "0 0 0 0.5 0.5") {
    const auto side = [&](const Vec3d &a, const Vec3d &b, const Vec3d &c) {
        return fmt::format("( {} {} {} ) ( {} {} {} ) ( {} {} {} ) {} {} {} 0 0\n", a.x, a.y, a.z, b.x, b.y, b.z, c.x,
                           c.y, c.z, shader, texture, flags);
    };
    const Vec3d &m = mins, &M = maxs;
    return "{\n" + side({M.x, 0, 0}, {M.x, 0, 1}, {M.x, 1, 0}) + side({m.x, 0, 0}, {m.x, 1, 0}, {m.x, 0, 1}) +
           side({0, M.y, 0}, {1, M.y, 0}, {0, M.y, 1}) + side({0, m.y, 0}, {0, m.y, 1}, {1, m.y, 0}) +
           side({0, 0, M.z}, {0, 1, M.z}, {1, 0, M.z}) + side({0, 0, m.z}, {1, 0, m.z}, {0, 1, m.z}) + "}\n";
}

/// A detail prism over a polygon in the plane of x and z, counterclockwise, between two distances along y.
std::string Prism(const std::vector<std::array<double, 2>> &corners, double front, double back) {
    const auto side = [](const Vec3d &a, const Vec3d &b, const Vec3d &c) {
        return fmt::format("( {} {} {} ) ( {} {} {} ) ( {} {} {} ) slope 3 4 15 0.5 0.6 134217728 0 0\n", a.x, a.y, a.z,
                           b.x, b.y, b.z, c.x, c.y, c.z);
    };
    std::string text = "{\n";
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto &[x, z] = corners[i];
        const auto &[x2, z2] = corners[(i + 1) % corners.size()];
        text += side({x, 0, z}, {x2, 0, z2}, {x, 1, z});
    }
    return text + side({0, front, 0}, {0, front, 1}, {1, front, 0}) + side({0, back, 0}, {1, back, 0}, {0, back, 1}) +
           "}\n";
}

/// A closed room with a structural and a detail pillar, a slanted detail wedge, a patch and a door about its origin.
std::string RoomText() {
    std::string text = "{\n\"classname\" \"worldspawn\"\n\"message\" \"room\"\n";
    text += Box({-8, -8, -8}, {520, 520, 0}, "floor", 0, "16 8 30 0.5 0.25");
    text += Box({-8, -8, 256}, {520, 520, 264}, "roof");
    text += Box({-8, -8, 0}, {0, 520, 256}, "wall", 0, "5 7 0 0.5 -0.5");
    text += Box({512, -8, 0}, {520, 520, 256}, "wall");
    text += Box({0, -8, 0}, {512, 0, 256}, "wall");
    text += Box({0, 512, 0}, {512, 520, 256}, "wall");
    text += Box({100, 100, 0}, {132, 132, 256}, "pillar");
    text += Box({300, 100, 0}, {332, 132, 128}, "pillar", 0x8000000, "0 0 90 0.3 0.7");
    text += "{\n( 200 400 0 ) ( 300 400 50 ) ( 200 300 0 ) slope 3 4 15 0.5 0.6 134217728 0 0\n"
            "( 200 300 0 ) ( 300 300 0 ) ( 200 400 0 ) slope 0 0 0 0.5 0.5 134217728 0 0\n"
            "( 300 300 0 ) ( 300 300 50 ) ( 300 400 0 ) slope 0 0 0 0.5 0.5 134217728 0 0\n"
            "( 200 300 0 ) ( 300 300 50 ) ( 300 300 0 ) slope 0 0 0 0.5 0.5 134217728 0 0\n"
            "( 200 400 0 ) ( 300 400 0 ) ( 300 400 50 ) slope 0 0 0 0.5 0.5 134217728 0 0\n}\n";
    text += "{\npatchDef2\n{\nbend\n( 3 3 0 0 0 )\n(\n";
    for (int x = 0; x < 3; ++x) {
        text += "(";
        for (int y = 0; y < 3; ++y)
            text += fmt::format(" ( {} {} {} {} {} )", 400 + x * 32, 300 + y * 32, x == 1 ? 96.25 : 64.0, x * 0.5,
                                y * 0.25);
        text += " )\n";
    }
    text += ")\n}\n}\n}\n{\n\"classname\" \"info_player_start\"\n\"origin\" \"256 256 40\"\n}\n";
    return text + "{\n\"classname\" \"func_rotating\"\n\"speed\" \"20\"\n" +
           Box({36, 36, 40}, {52, 52, 56}, "common/origin") +
           Box({30, 30, 30}, {60, 60, 70}, "door", 0, "9 0 0 0.5 1") + "}\n";
}

class SourceBspTest : public LibraryTest {
  protected:
    SourceBspTest() {
        options.imageSizes = true;
        bspOptions.meta = true;
        folder.Write("scripts/test.shader",
                     "textures/common/origin\n{\nsurfaceparm origin\nsurfaceparm nodraw\nsurfaceparm nonsolid\n}\n");
        Load();
    }
    BspContext Context() { return {bspOptions, *FindGame(gameName), *library, out.log, vfs.get()}; }
    Map Read(std::string_view text) { return ReadMap(text, "maps/room.map", Context()); }
    Bsp Compiled(std::string_view text) {
        Map map = Read(text);
        return CompileMap(map, Context()).bsp;
    }
    std::string Source(const Bsp &bsp, const DecompileOptions &how) {
        return DecompiledSource(bsp, "maps/room.bsp", how, Context());
    }

    BspOptions bspOptions;
    std::string_view gameName = "quake3";
};

using Row = std::array<float, 5>;

/// Position and texture coordinates of all vertices of a surface type, texture coordinates but for whole images.
std::multiset<Row> VertsOf(const Bsp &bsp, int type) {
    std::multiset<Row> verts;
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        for (int i = 0; i < surface.numVerts && surface.surfaceType == type; ++i) {
            const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + i)];
            verts.insert({v.xyz[0], v.xyz[1], v.xyz[2], v.st[0], v.st[1]});
        }
    return verts;
}

void ExpectNear(const std::multiset<Row> &a, const std::multiset<Row> &b) {
    ASSERT_EQ(a.size(), b.size());
    for (const Row &v : a)
        EXPECT_TRUE(std::ranges::any_of(b,
                                        [&](const Row &other) {
                                            constexpr float kTexel = 1 / 64.0f;
                                            return std::equal(v.begin(), v.begin() + 3, other.begin()) &&
                                                   std::abs(std::remainder(v[3] - other[3], 1.0f)) < 0.01f * kTexel &&
                                                   std::abs(std::remainder(v[4] - other[4], 1.0f)) < 0.01f * kTexel;
                                        }))
            << v[0] << ' ' << v[1] << ' ' << v[2] << ' ' << v[3] << ' ' << v[4];
}

} // namespace

TEST_F(SourceBspTest, CompilesToTheSameMapAgain) {
    const Bsp before = Compiled(RoomText());
    for (const MapForm form : kAllForms) {
        const Bsp after = Compiled(Source(before, {.form = form}));
        EXPECT_EQ(after.entities, before.entities);
        EXPECT_EQ(after.brushes.size(), before.brushes.size());
        EXPECT_EQ(after.brushSides.size(), before.brushSides.size());
        EXPECT_EQ(after.leafs.size(), before.leafs.size());
        ASSERT_EQ(after.planes.size(), before.planes.size());
        for (const bspPlane_t &plane : before.planes)
            EXPECT_TRUE(std::ranges::any_of(
                after.planes,
                [&](const bspPlane_t &other) { return other.normal == plane.normal && other.dist == plane.dist; }))
                << plane.normal[0] << ' ' << plane.normal[1] << ' ' << plane.normal[2] << ' ' << plane.dist;
        ExpectNear(VertsOf(before, MST_PLANAR), VertsOf(after, MST_PLANAR));
        ExpectNear(VertsOf(before, MST_PATCH), VertsOf(after, MST_PATCH));
    }
}

/// Two detail brushes with the same shader share a part of the plane x = 200, each with its own texture.
TEST_F(SourceBspTest, FacesThatOverlapKeepTheirOwnTexture) {
    std::string text = RoomText();
    const std::size_t at = text.find("{\npatchDef2");
    text.insert(at, Box({180, 150, 20}, {200, 170, 60}, "pillar", 0x8000000, "3 0 0 0.5 0.5") +
                        Box({150, 140, 22}, {200, 280, 240}, "pillar", 0x8000000, "40 16 90 0.25 0.5"));
    const Bsp before = Compiled(text);
    for (const MapForm form : kAllForms)
        ExpectNear(VertsOf(before, MST_PLANAR), VertsOf(Compiled(Source(before, {.form = form})), MST_PLANAR));
}

/// A corner of the second prism lies on a slanted edge of the first, and 1/8 game unit rounding moves it off the edge:
/// the vertex that the T-junction adds there has the coordinates of a point on the edge.
TEST_F(SourceBspTest, VerticesAtTJunctionsDoNotBendTextures) {
    std::string text = RoomText();
    text.insert(text.find("{\npatchDef2"), Prism({{356, 40}, {364.882, 40}, {356, 55.1}}, 150, 154) +
                                               Prism({{364.882, 40}, {371, 40}, {361.592, 45.593}}, 150, 154));
    const Bsp before = Compiled(text);
    for (const MapForm form : {MapForm::Classic, MapForm::Valve}) // primitives look along other axes
        ExpectNear(VertsOf(before, MST_PLANAR), VertsOf(Compiled(Source(before, {.form = form})), MST_PLANAR));
}

/// A compiler moves axial sides to the front and puts missing ones between: which vertex a face begins with, and so
/// how it is divided into triangles, depends on the order of sides.
TEST_F(SourceBspTest, SidesKeepTheirOrder) {
    std::string text = RoomText();
    text.insert(text.find("{\npatchDef2"), Prism({{356, 40}, {390, 44}, {395, 60}, {381, 81}, {360, 77}}, 150, 190));
    const Bsp before = Compiled(text), after = Compiled(Source(before, {.form = MapForm::Valve}));
    ASSERT_EQ(after.brushSides.size(), before.brushSides.size());
    for (std::size_t i = 0; i < before.brushSides.size(); ++i)
        EXPECT_EQ(after.planes[std::size_t(after.brushSides[i].planeNum)].normal,
                  before.planes[std::size_t(before.brushSides[i].planeNum)].normal)
            << "side " << i;
}

TEST_F(SourceBspTest, DetailAndOriginBrushesComeBack) {
    const std::string text = Source(Compiled(RoomText()), {.form = MapForm::Classic});
    const Map map = Read(text);
    EXPECT_EQ(std::ranges::count_if(map.entities[0].brushes, &Brush::detail), 2);
    ASSERT_EQ(map.entities.size(), 3u);
    EXPECT_EQ(map.entities[2].brushOrigin, (Vec3f{44, 44, 48}));
    EXPECT_EQ(map.entities[2].pairs.Value("speed"), "20");
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("\"*1\"")));
    EXPECT_THAT(text, testing::HasSubstr("// brush -1"));
}

TEST_F(SourceBspTest, GamesOfRavenHaveTheirOwnOriginShaderAndSwitchableLights) {
    gameName = "ja";
    LoadScript("textures/system/origin\n{\nsurfaceparm origin\nsurfaceparm nodraw\n}\n", gameName);
    const std::string lights = "{\n\"classname\" \"light\"\n\"targetname\" \"lamp\"\n}\n"
                               "{\n\"classname\" \"light\"\n\"targetname\" \"fire\"\n\"style\" \"3\"\n}\n";
    std::string room = RoomText();
    for (std::size_t at = 0; (at = room.find("common/origin", at)) != std::string::npos;)
        room.replace(at, 6, "system");
    const Bsp bsp = Compiled(room + lights);
    EXPECT_THAT(bsp.entities, testing::HasSubstr("\"style\" \"33\""));
    const std::string text = Source(bsp, {.form = MapForm::Classic});
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("common/origin")));
    EXPECT_THAT(text, testing::Not(testing::HasSubstr("switch_style")));
    const Map map = Read(text);
    ASSERT_EQ(map.entities.size(), 5u);
    EXPECT_EQ(map.entities[2].brushOrigin, (Vec3f{44, 44, 48}));
    EXPECT_EQ(map.entities[3].pairs.Value("style"), "");
    EXPECT_EQ(map.entities[4].pairs.Value("style"), "3");
}

TEST_F(SourceBspTest, SidesThatNobodySeesKeepTheirShaderOrAreMarked) {
    const Bsp bsp = Compiled(RoomText());
    const std::string plain = Source(bsp, {.form = MapForm::Classic});
    EXPECT_THAT(plain, testing::HasSubstr(" roof 0 0 0 0.25 0.25 0 0 0"));
    EXPECT_THAT(plain, testing::Not(testing::HasSubstr("WTF")));
    const std::string marked = Source(bsp, {.form = MapForm::Classic, .markUnknown = true});
    EXPECT_THAT(marked, testing::HasSubstr(" common/WTF 0 0 0 0.25 0.25 0 0 0"));
    EXPECT_THAT(marked, testing::HasSubstr(" roof 0 0 0 0.5 0.5 0 0 0"));
    EXPECT_THAT(marked, testing::HasSubstr(" common/origin "));
}

TEST_F(SourceBspTest, FastLooksForNoTextures) {
    const std::string text = Source(Compiled(RoomText()), {.form = MapForm::Primitive, .withTextures = false});
    std::size_t sides = 0, plain = 0;
    for (std::size_t at = 0; (at = text.find(" ( ( ", at)) != std::string::npos; ++at)
        ++sides;
    for (std::size_t at = 0; (at = text.find("( ( 0.03125 0 0 ) ( 0 0.03125 0 ) )", at)) != std::string::npos; ++at)
        ++plain;
    EXPECT_EQ(plain + 6, sides) << "all but those of the origin brush";
    EXPECT_GE(plain, 6u * 9);
    EXPECT_EQ(std::ranges::count_if(Read(text).entities[0].brushes, &Brush::detail), 2);
}

TEST_F(SourceBspTest, BrushesThatClipModelsAreLeftOutUnlessAskedFor) {
    Bsp bsp = Compiled(RoomText());
    // The detail pillar with one named side is what a compiler makes for a triangle of a model.
    bspShader_t none{};
    std::ranges::copy(std::string_view("noshader"), none.shader.begin());
    bsp.shaders.push_back(none);
    int clipped = 0;
    for (const bspBrush_t &brush : bsp.brushes) {
        const std::string_view name = FieldName(bsp.shaders[std::size_t(brush.shaderNum)].shader);
        for (int i = 1; i < brush.numSides && name == "textures/slope"; ++i)
            bsp.brushSides[std::size_t(brush.firstSide + i)].shaderNum = int(bsp.shaders.size()) - 1;
        clipped += name == "textures/slope";
    }
    ASSERT_EQ(clipped, 1);
    EXPECT_THAT(Source(bsp, {}), testing::Not(testing::HasSubstr(" slope ")));
    const std::string kept = Source(bsp, {.keepModelClip = true});
    EXPECT_THAT(kept, testing::HasSubstr(" common/caulk "));
    EXPECT_EQ(Read(kept).entities[0].brushes.size(), bsp.brushes.size() - 1);
}

TEST_F(SourceBspTest, EntityWithoutItsModelIsAWarning) {
    Bsp bsp = Compiled(RoomText());
    bsp.entities += "{\n\"classname\" \"func_door\"\n\"model\" \"*99\"\n}\n";
    EXPECT_THAT(Source(bsp, {}), testing::HasSubstr("func_door"));
    EXPECT_EQ(Warnings("missing model"), 1);
}

} // namespace q3::test
