// GPL-2.0-or-later. Static props, lit by the program.
#include "common/files/archive.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "libs/math/packed_color.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/prop_light.h"
#include "q3map2/model/model_load.h"
#include "tests/program/lit_room.h"
#include "tests/program/prop_models.h"

#include <cmath>
#include <cstring>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

/// Reflectance of a white texture at -bouncescale 1.
constexpr double kWhiteReflectance = 187.5 * 3 / 255 * 0.25;

class StaticPropTest : public LitRoomTest {
  protected:
    void AddModel(std::string_view name, const std::vector<TestMesh> &meshes) {
        folder_.Write(fmt::format("base/baseq3/models/{}.md3", name), Md3Of(meshes));
    }
    /// Writes a model: a plate of 128 x 128 at z = 20, whose shader tests alpha; the half at x < 0 lets light through.
    void AddLeaf(std::string_view name) {
        folder_.Write("base/baseq3/scripts/mask.shader",
                      "textures/test/leaf\n{\n{\nmap textures/test/leaf.tga\nalphaFunc GE128\n}\n}\n");
        folder_.Write("base/baseq3/scripts/shaderlist.txt", "test\nmask\n");
        std::vector<std::uint8_t> texels;
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x)
                for (const int c : {255, 255, 255, x < 4 ? 0 : 255})
                    texels.push_back(std::uint8_t(c));
        folder_.Write("base/baseq3/textures/test/leaf.tga", EncodeTga(texels, 8, 8, 4, TgaRows::TopFirst));
        TestMesh plate;
        plate.shader = "textures/test/leaf";
        plate.AddPlate({-64, -64, 20}, {64, 64, 20});
        AddModel(name, {plate});
    }
    static std::string Prop(std::string_view model, const Keys &more = {}, std::string_view at = "0 0 0") {
        std::string text = EntityText({{"classname", "misc_model_static"},
                                       {"model", fmt::format("models/{}.md3", model)},
                                       {"origin", std::string(at)}});
        const std::string keys = EntityText(more);
        text.erase(text.rfind("}\n"));
        return text + keys.substr(2);
    }
    static PropLight LightOf(const Bsp &bsp) {
        EXPECT_TRUE(bsp.propLight) << "no light of props";
        return bsp.propLight.value_or(PropLight{});
    }
    /// Colors of a mesh of the lit map, byte scale.
    std::vector<Vec3f> Colors(std::size_t mesh = 0) const {
        const PropLight light = LightOf(Load());
        std::vector<Vec3f> colors;
        if (mesh < light.meshes.size())
            for (std::uint32_t i = 0; i < light.meshes[mesh].colorCount; ++i)
                colors.push_back(DecodeE5bgr9(light.colors[light.meshes[mesh].firstColor + i]) * 255);
        return colors;
    }
    /// Lights with -hdr and returns the red of the floor's luxels at these points, byte scale; -1 where there is none.
    std::vector<float> FloorLight(std::string_view options, const std::vector<Vec3f> &points) {
        Light(fmt::format("-hdr -hdrfiles pfm {}", options));
        const LitFace floor = FaceOf(Load(), "textures/test/floor", kUpward);
        const FloatImage page = Pfm(floor.page);
        std::vector<float> light;
        for (const Vec3f &p : points) {
            const int texel = floor.TexelAt(p);
            light.push_back(texel < 0 ? -1 : page.texels[std::size_t(texel)].x * 255);
        }
        return light;
    }
};

TestMesh Sheet(float low, float high, int side, float z) {
    TestMesh mesh;
    mesh.AddSheet(low, high, side, z);
    return mesh;
}

/// Positions of a Sheet's vertices on the floor: 2 n + 1 on each axis.
std::vector<Vec3f> PointsOfSheet(int n, float spacing) {
    std::vector<Vec3f> points;
    for (int y = -n; y <= n; ++y)
        for (int x = -n; x <= n; ++x)
            points.push_back({float(x) * spacing, float(y) * spacing, 0});
    return points;
}

} // namespace

TEST_F(StaticPropTest, AVertexOnTheFloorGetsTheLightOfTheLuxelThere) {
    AddModel("sheet", {Sheet(-160, 160, 20, 1.0f / 64)});
    Compile(Prop("sheet", {{"disableshadows", "1"}}) + Lamp({30, 40, 150}, 60), {{"_ambient", "5"}});
    const std::vector<Vec3f> points = PointsOfSheet(10, 16);
    const std::vector<float> floor = FloorLight("-staticproplighting", points);
    const std::vector<Vec3f> colors = Colors();
    ASSERT_EQ(colors.size(), points.size());
    int compared = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (floor[i] < 0)
            continue;
        ++compared;
        EXPECT_NEAR(colors[i].x, floor[i], 0.01 * floor[i] + 0.3) << points[i].x << ' ' << points[i].y;
    }
    EXPECT_GT(compared, 400);
}

TEST_F(StaticPropTest, PropsGetTheBouncedLightOfTheFloor) {
    AddModel("sheet", {Sheet(-96, 96, 6, 1.0f / 64)});
    Compile(Prop("sheet", {{"disableshadows", "1"}}) + Lamp({30, 40, 150}, 60));
    const std::vector<Vec3f> points = PointsOfSheet(3, 32);
    const std::vector<float> floor = FloorLight("-staticproplighting -bounce 8 -bounceonly", points);
    const std::vector<Vec3f> colors = Colors();
    ASSERT_EQ(colors.size(), points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(colors[i].x, floor[i], 0.12 * floor[i]) << i;
    EXPECT_GT(floor[0], 5);
}

TEST_F(StaticPropTest, ModelsOfTheMapGetTheBouncedLightOfProps) {
    TestMesh box;
    box.AddWalls(24, {100, 124, 148});
    AddModel("box", {box});
    const std::string lamp = Lamp({30, 40, 220}, 400);
    Compile(Prop("box", {{"disableshadows", "1"}}) + lamp);
    Light("-staticproplighting -bounce 8 -bounceonly");
    const std::vector<Vec3f> prop = Colors();
    ASSERT_EQ(prop.size(), box.verts.size());
    Compile(
        EntityText(
            {{"classname", "misc_model"}, {"model", "models/box.md3"}, {"origin", "0 0 0"}, {"_castShadows", "0"}}) +
        lamp);
    Light("-bounce 8 -bounceonly");
    const Bsp bsp = Load();
    for (std::size_t i = 0; i < prop.size(); ++i) {
        const auto found = std::find_if(bsp.drawVerts.begin(), bsp.drawVerts.end(), [&](const bspDrawVert_t &v) {
            return Length(Vec3f(v.xyz) - box.verts[i].xyz) < 0.1f && Dot(Vec3f(v.normal), box.verts[i].normal) > 0.9f;
        });
        ASSERT_NE(found, bsp.drawVerts.end());
        EXPECT_NEAR(float(found->color[0][0]), prop[i].x, 0.03f * prop[i].x + 1) << i; // bytes are cut off
        EXPECT_GT(prop[i].x, 20);
    }
}

TEST_F(StaticPropTest, ManyBouncesInAWhiteRoomAddUpAsAGeometricSeries) {
    const std::string script = ReadTextFile(folder_ / "base/baseq3/scripts/test.shader");
    std::string glowing;
    for (const std::string_view name : {"floor", "wall", "ceiling"})
        glowing +=
            fmt::format("textures/test/{}\n{{\nq3map_surfacelight 300\nq3map_backsplash 0 0\nq3map_lightsubdivide 32\n"
                        "{{\nmap $lightmap\n}}\n}}\n",
                        name);
    folder_.Write("base/baseq3/scripts/test.shader", glowing);
    TestMesh cube;
    cube.AddWalls(32, {-32, 0, 32});
    AddModel("cube", {cube});
    Compile(Prop("cube", {{"disableshadows", "1"}}, "0 0 128"));
    Light("-staticproplighting");
    const std::vector<Vec3f> direct = Colors();
    Light("-staticproplighting -bounce 1");
    const std::vector<Vec3f> once = Colors();
    Light("-staticproplighting -bounce 8");
    const std::vector<Vec3f> many = Colors();
    ASSERT_EQ(direct.size(), 24u);
    const double r = kWhiteReflectance;
    for (std::size_t i = 0; i < direct.size(); ++i) {
        EXPECT_NEAR(once[i].x / direct[i].x, 1 + r, 0.05);
        EXPECT_NEAR(many[i].x / direct[i].x, (1 - std::pow(r, 9)) / (1 - r), 0.12);
    }
}

TEST_F(StaticPropTest, BuriedVerticesTakeTheLightOfTheOpenSide) {
    TestMesh walls;
    walls.AddWalls(20, {-12, -4, 1, 40});
    AddModel("post", {walls});
    Compile(Prop("post") + Lamp({100, 90, 100}, 60) + Lamp({-100, -90, 100}, 60));
    Light("-staticproplighting -staticproppolys");
    const std::vector<Vec3f> colors = Colors();
    ASSERT_EQ(colors.size(), 32u);
    for (std::size_t wall = 0; wall < 4; ++wall)
        for (std::size_t side = 0; side < 2; ++side) {
            const auto at = [&](std::size_t row) { return colors[8 * wall + 2 * row + side].x; };
            EXPECT_GT(at(2), 5);
            EXPECT_NEAR(at(0), at(2), 0.1 * at(2));
            EXPECT_NEAR(at(1), at(2), 0.1 * at(2));
        }
}

TEST_F(StaticPropTest, APropInAWallIsLitFromItsLightingOrigin) {
    TestMesh walls;
    walls.AddWalls(4, {-12, -4});
    AddModel("stone", {walls});
    const std::string lamps = Lamp({60, 50, 100}, 60) + Lamp({-60, -50, 100}, 60);
    const std::string target = EntityText({{"classname", "info_null"}, {"targetname", "out"}, {"origin", "0 0 24"}});
    Compile(Prop("stone", {{"lightingorigin", "out"}}) + target + lamps);
    Outcome outcome = Light("-staticproplighting");
    EXPECT_THAT(outcome.text, testing::Not(HasSubstr("lightingorigin")));
    for (const Vec3f &color : Colors())
        EXPECT_GT(color.x, 1);

    const std::string bad = EntityText({{"classname", "info_null"}, {"targetname", "in"}, {"origin", "0 0 -8"}});
    Compile(Prop("stone", {{"lightingorigin", "in"}}) + bad + Prop("stone", {{"lightingorigin", "nobody"}}) + lamps);
    outcome = Light("-staticproplighting");
    EXPECT_THAT(outcome.text, HasSubstr("its lightingorigin at 0 0 -8 is in a wall"));
    EXPECT_THAT(outcome.text, HasSubstr("has the targetname 'nobody'"));
    for (const Vec3f &color : Colors(1))
        EXPECT_GT(color.x, 1);
}

TEST_F(StaticPropTest, APropWithSolidAllAroundGetsAmbientLight) {
    AddModel("a", {Sheet(-16, 16, 1, 0)});
    Compile(Prop("a", {}, "0 0 -528") + Lamp({0, 0, 200}, 100), {{"_ambient", "5"}},
            BoxText({-256, -256, -1040}, {256, 256, -16}, "test/floor"));
    const Outcome outcome = Light("-staticproplighting -floodlight -bounce 1");
    EXPECT_THAT(outcome.text, HasSubstr("models/a.md3 is inside of a wall: it gets ambient light only"));
    const std::vector<Vec3f> colors = Colors();
    ASSERT_EQ(colors.size(), 4u);
    for (const Vec3f &color : colors)
        EXPECT_NEAR(color.x, 5, 0.02);
}

TEST_F(StaticPropTest, WeldedVerticesGetTheSameColor) {
    // Two meshes that meet at x = 0, and a duplicate vertex in the first.
    TestMesh left, right;
    left.AddPlate({-64, -64, 60}, {0, 64, 60});
    right.AddPlate({0, -64, 60}, {64, 64, 60});
    left.verts.push_back(left.verts[1]);
    left.triangles.push_back({0, 2, 4});
    AddModel("two", {left, right});
    Compile(Prop("two") + Lamp({20, 10, 150}, 60));
    Light("-staticproplighting -staticproppolys");
    const std::vector<Vec3f> a = Colors(0), b = Colors(1);
    ASSERT_EQ(a.size(), 5u);
    ASSERT_EQ(b.size(), 4u);
    EXPECT_EQ(a[1], a[4]);
    EXPECT_EQ(a[1], b[0]);
    EXPECT_EQ(a[3], b[2]);
    EXPECT_NE(a[0], a[1]);
}

TEST_F(StaticPropTest, TrianglesShadowTheFloorUnderThemAndBoxesAllOfTheirExtent) {
    TestMesh plates;
    plates.AddPlate({-112, -112, 40}, {-48, -48, 40});
    plates.AddPlate({48, 48, 40}, {112, 112, 40});
    AddModel("plates", {plates});
    const std::vector<Vec3f> points{{-80, -80, 0}, {0, 0, 0}, {208, -208, 0}};
    const std::string lamp = Lamp({0, 0, 20000.0f / 100}, 200);
    Compile(Prop("plates") + lamp);
    const auto none = FloorLight("", points);
    const auto polys = FloorLight("-staticproppolys", points);
    const auto boxes = FloorLight("-staticproplighting", points);
    EXPECT_GT(none[0], 10);
    EXPECT_LT(polys[0], 1);
    EXPECT_NEAR(polys[1], none[1], 1e-3);
    EXPECT_LT(boxes[0], 1);
    EXPECT_LT(boxes[1], 1);
    EXPECT_NEAR(boxes[2], none[2], 1e-3);

    Compile(Prop("plates", {{"disableshadows", "1"}}) + Prop("plates", {{"_castShadows", "0"}}) + lamp);
    EXPECT_EQ(FloorLight("-staticproplighting -staticproppolys", points), none);
}

/// A box has no shader: rays of dirt that hit it must not ask for one.
TEST_F(StaticPropTest, BoxesMakeDirtBesideThem) {
    TestMesh walls;
    walls.AddWalls(20, {0, 64});
    AddModel("post", {walls});
    Compile(Prop("post") + Lamp({120, 0, 200}, 200));
    const std::vector<Vec3f> points{{30, 0, 0}, {-144, 96, 0}};
    const auto clean = FloorLight("-staticproplighting", points);
    const auto dirty = FloorLight("-staticproplighting -dirty", points);
    EXPECT_LT(dirty[0], 0.8 * clean[0]);
    EXPECT_GT(dirty[1], 0.95 * clean[1]);
    EXPECT_EQ(Colors().size(), 16u);
}

TEST_F(StaticPropTest, MaskedTexturesLetLightThroughWithTextureShadows) {
    AddLeaf("leaf");
    Compile(Prop("leaf") + Lamp({0, 0, 200}, 200));
    const std::vector<Vec3f> points{{-32, 0, 0}, {32, 0, 0}};
    const auto none = FloorLight("", points);
    const auto opaque = FloorLight("-staticproppolys", points);
    const auto masked = FloorLight("-staticproppolys -textureshadows", points);
    EXPECT_LT(opaque[0], 1);
    EXPECT_LT(opaque[1], 1);
    EXPECT_NEAR(masked[0], none[0], 1e-3);
    EXPECT_LT(masked[1], 1);
}

TEST_F(StaticPropTest, LinesOfRadFilesForceTextureShadowsOfOneModel) {
    AddLeaf("leaf");
    AddLeaf("bush");
    Compile(Prop("leaf", {}, "-120 0 0") + Prop("bush", {}, "120 0 0") + Lamp({-120, 0, 200}, 200) +
            Lamp({120, 0, 200}, 200));
    // Points below the left and right half of both plates. A plate can hide only the lamp above it.
    const std::vector<Vec3f> points{{-144, 0, 0}, {-96, 0, 0}, {96, 0, 0}, {144, 0, 0}};
    const auto lit = [&](std::string_view lines, std::string_view options = "-staticproppolys") {
        folder_.Write("base/baseq3/maps/room.rad", lines);
        return FloorLight(options, points);
    };
    const auto without = lit(""), leaf = lit("forcetextureshadow models\\Leaf.mdl\n");
    const auto both = lit("forcetextureshadow models/leaf.mdl\nforcetextureshadow models/bush\n");
    EXPECT_GT(leaf[0], without[0] + 20);
    for (const std::size_t i : {1u, 2u, 3u})
        EXPECT_NEAR(leaf[i], without[i], 1e-3) << i;
    EXPECT_EQ(both, lit("", "-staticproppolys -textureshadows"));
    EXPECT_GT(both[2], leaf[2] + 20);
    EXPECT_EQ(lit("forcetextureshadow models/other.mdl\n"), without);
}

TEST_F(StaticPropTest, IgnoredNormalsGiveLightFromAllSidesByAConstant) {
    TestMesh walls;
    walls.AddWalls(8, {100, 116});
    AddModel("bush", {walls});
    Compile(Prop("bush", {{"ignorenormals", "1"}, {"disableshadows", "1"}}) + Lamp({200, 0, 108}, 60));
    Light("-staticproplighting");
    const std::vector<Vec3f> colors = Colors();
    ASSERT_EQ(colors.size(), 16u);
    for (const Vec3f &color : colors)
        EXPECT_NEAR(color.x, 0.35 * 60 * 7500 / (200 * 200), 0.15 * color.x);
}

TEST_F(StaticPropTest, APropShadowsItselfUnlessItIsTold) {
    TestMesh mesh;
    mesh.AddPlate({-8, -8, 20}, {8, 8, 20});
    mesh.AddPlate({-60, -60, 80}, {60, 60, 80});
    AddModel("table", {mesh});
    Compile(Prop("table") + Prop("table", {{"disableselfshadowing", "1"}}, "0 0 100") + Lamp({0, 0, 250}, 200));
    Light("-staticproplighting -staticproppolys");
    const std::vector<Vec3f> below = Colors(0), above = Colors(1);
    EXPECT_EQ(below[0], (Vec3f{}));
    EXPECT_GT(above[0].x, 10);
}

TEST_F(StaticPropTest, OnlyPropsWithVertexLightAreInTheLump) {
    AddModel("a", {Sheet(-16, 16, 1, 40), Sheet(-16, 16, 2, 60)});
    const Keys merged{{"classname", "misc_model"}, {"model", "models/a.md3"}, {"origin", "0 0 0"}};
    const Keys stays{{"classname", "misc_model"}, {"model", "models/a.md3"}, {"origin", "0 0 0"}, {"_staticprop", "1"}};
    const Keys source{{"classname", "prop_static"}, {"model", "models/a.md3"}, {"origin", "9 0 0"}, {"skin", "0"}};
    Compile(EntityText(merged) + EntityText(stays) + EntityText(source) + Prop("a", {{"disablevertexlighting", "1"}}) +
            Prop("a", {{"generatelightmaps", "1"}}) + Lamp({0, 0, 200}, 100));
    const std::size_t surfaces = Load().drawSurfaces.size();
    const Outcome outcome = Light("-staticproplighting");
    EXPECT_THAT(outcome.text, HasSubstr("generatelightmaps: props get light at their vertices, but no lightmaps"));
    const Bsp bsp = Load();
    EXPECT_EQ(bsp.drawSurfaces.size(), surfaces);
    const std::vector<Entity> entities = ParseEntities(bsp.entities, "room");
    const PropLight light = LightOf(bsp);
    ASSERT_EQ(light.props.size(), 3u);
    std::vector<std::string> classes;
    for (const bspPropLight_t &prop : light.props) {
        classes.emplace_back(entities[prop.entity].ClassName());
        EXPECT_EQ(prop.meshCount, 2u);
        EXPECT_EQ(prop.modelCrc, Crc32(ReadFile(folder_ / "base/baseq3/models/a.md3")));
        EXPECT_EQ(light.meshes[prop.firstMesh].colorCount, 4u);
        EXPECT_EQ(light.meshes[prop.firstMesh + 1].colorCount, 9u);
    }
    EXPECT_THAT(classes, testing::ElementsAre("misc_model", "prop_static", "misc_model_static"));
}

TEST_F(StaticPropTest, OutputDoesNotDependOnThreads) {
    TestMesh mesh = Sheet(-100, 100, 30, 20);
    mesh.AddWalls(50, {-20, 10, 60});
    AddModel("a", {mesh});
    Compile(Prop("a") + Prop("a", {{"angles", "10 20 30"}, {"modelscale", "0.5"}}, "40 0 100") +
            Lamp({0, 0, 200}, 100));
    Light("-staticproplighting -staticproppolys -bounce 2 -threads 1");
    const auto one = LightOf(Load()).colors;
    Light("-staticproplighting -staticproppolys -bounce 2 -threads 3");
    EXPECT_EQ(one, LightOf(Load()).colors);
    EXPECT_GT(one.size(), 1900u);
}

TEST_F(StaticPropTest, WithoutPropsOrOptionThereIsNoLump) {
    AddModel("a", {Sheet(-16, 16, 1, 40)});
    Compile(Lamp({0, 0, 200}, 100));
    Light("");
    const auto plain = LumpOf(MapBytes(), 14);
    Light("-staticproplighting -staticproppolys");
    EXPECT_FALSE(Load().propLight);
    EXPECT_EQ(LumpOf(MapBytes(), 14), plain);
    Compile(Prop("a") + Lamp({0, 0, 200}, 100));
    Light("");
    EXPECT_FALSE(Load().propLight);
    EXPECT_EQ(LumpOf(MapBytes(), 14), plain);
    Light("-staticproplighting");
    EXPECT_TRUE(Load().propLight);
    Light("");
    EXPECT_FALSE(Load().propLight) << "stale light";
}

TEST_F(StaticPropTest, AMissingModelIsAWarningAndTheRestIsLit) {
    AddModel("a", {Sheet(-16, 16, 1, 40)});
    folder_.Write("base/baseq3/models/cut.md3", "IDP3\xF");
    Compile(Prop("gone") + Prop("cut") + EntityText({{"classname", "misc_model_static"}}) + Prop("a") +
            Lamp({0, 0, 200}, 100));
    const Outcome outcome = Light("-staticproplighting");
    EXPECT_THAT(outcome.text, HasSubstr("models/gone.md3 cannot be read and gets no light: there is no such file"));
    EXPECT_THAT(outcome.text, HasSubstr("misc_model_static without a \"model\" key"));
    EXPECT_EQ(LightOf(Load()).props.size(), 1u);
    EXPECT_GT(Colors()[0].x, 10);
}

TEST_F(StaticPropTest, FilesBesideTheMapHoldTheSameLight) {
    AddModel("a", {Sheet(-16, 16, 1, 40), Sheet(-16, 16, 2, 60)});
    Compile(Prop("a") + Prop("a", {}, "80 0 0") + Lamp({0, 0, 200}, 100));
    Light("-staticproplighting -staticpropfiles");
    const auto raw = ReadFile(Beside("proplight.raw"));
    ASSERT_EQ(raw.size(), 12u * 2 * (4 + 9));
    const std::vector<Vec3f> colors = Colors(3); // of the second prop's second mesh
    float red = 0;
    std::memcpy(&red, raw.data() + std::size_t{12} * (4 + 9 + 4), 4);
    EXPECT_NEAR(red * 255, colors[0].x, colors[0].x / 256);

    const auto file = ReadFile(Beside("sp_1.vhv"));
    ASSERT_EQ(file.size(), 512u + 4 * (4 + 9));
    EXPECT_EQ(IntOf(file, 0), 2);
    EXPECT_EQ(std::uint32_t(IntOf(file, 4)), Crc32(ReadFile(folder_ / "base/baseq3/models/a.md3")));
    EXPECT_EQ(IntOf(file, 12), 4);
    EXPECT_EQ(IntOf(file, 16), 13);
    EXPECT_EQ(IntOf(file, 20), 2);
    EXPECT_EQ(IntOf(file, 40 + 28 + 4), 9);
    EXPECT_EQ(IntOf(file, 40 + 28 + 8), 512 + 16);
    const double byte = 127.5 * std::pow(double(red), 1 / 2.2);
    EXPECT_NEAR(double(file[512 + 16 + 2]), byte, 0.51);
    EXPECT_EQ(int(file[512 + 16 + 3]), 255);
}

TEST_F(StaticPropTest, PackagesHoldTheFilesBesideTheMap) {
    AddModel("a", {Sheet(-16, 16, 1, 40)});
    Compile(Prop("a") + Prop("a", {}, "80 0 0") + Lamp({0, 0, 200}, 100));
    Light("-staticproplighting -staticpropfiles");
    const Outcome outcome = RunProgramFile(
        {"-fs_basepath", (folder_ / "base").string(), "-pk3", (maps_ / "room.bsp").string()}, folder_.Root());
    const bool complete = outcome.status == 0; // false if images of the room are missing
    const Archive archive(folder_ / (complete ? "base/room_autopacked.pk3" : "base/room_FAILEDpack.pk3"));
    for (const std::string name : {"sp_0.vhv", "sp_1.vhv", "proplight.raw"})
        EXPECT_EQ(archive.Read("maps/room/" + name), ReadFile(Beside(name))) << name;
}

TEST_F(StaticPropTest, Md3ModelsHaveTheVerticesOfMiscModelAndTheOrderOfTheFile) {
    TestMesh mesh;
    mesh.AddWalls(20, {3, 40});
    mesh.AddPlate({-30, -10, 50}, {10, 50, 70});
    AddModel("a", {mesh});
    Compile(EntityText({{"classname", "misc_model"}, {"model", "models/a.md3"}, {"origin", "0 0 0"}}));
    const Model model = ReadMd3(Md3Of({mesh}), "models/a.md3", 0);
    ASSERT_EQ(model.meshes.size(), 1u);
    ASSERT_EQ(model.meshes[0].verts.size(), mesh.verts.size());
    EXPECT_EQ(model.meshes[0].triangles, mesh.triangles);
    EXPECT_EQ(model.meshes[0].shader, mesh.shader);
    const Bsp bsp = Load();
    for (std::size_t i = 0; i < mesh.verts.size(); ++i) {
        const DrawVert &vert = model.meshes[0].verts[i];
        EXPECT_LT(Length(vert.xyz - mesh.verts[i].xyz), 1e-3f);
        EXPECT_LT(Length(vert.normal - mesh.verts[i].normal), 1e-3f);
        const bool found = std::any_of(bsp.drawVerts.begin(), bsp.drawVerts.end(), [&](const bspDrawVert_t &other) {
            return Length(Vec3f(other.xyz) - vert.xyz) < 0.01f && Length(Vec3f(other.normal) - vert.normal) < 0.01f;
        });
        EXPECT_TRUE(found) << "vertex " << i;
    }
}

TEST(Md3ModelTest, SurfacesWithTheSameVerticesAreRefused) {
    // A second surface, of a head alone, whose parts are those of the first: many of them would need much memory.
    constexpr std::size_t kSurfaces = 84, kSurface = 164, kHead = 108, kOffsets = 88, kEnd = 104; // bytes
    std::vector<std::byte> file = Md3Of({Sheet(-200, 200, 8, 20)});
    const auto wordAt = [&file](std::size_t at) {
        std::int32_t value;
        std::memcpy(&value, file.data() + at, sizeof value);
        return value;
    };
    const std::int32_t length = wordAt(kSurface + kEnd);
    ASSERT_EQ(file.size(), kSurface + std::size_t(length));
    file.resize(file.size() + kHead);
    std::memcpy(file.data() + kSurface + length, file.data() + kSurface, kHead);
    for (std::size_t at = kOffsets; at < kEnd; at += sizeof length) {
        const std::int32_t offset = wordAt(kSurface + at) - length;
        std::memcpy(file.data() + kSurface + std::size_t(length) + at, &offset, sizeof offset);
    }
    EXPECT_EQ(ReadMd3(file, "models/a.md3", 0).meshes.size(), 1u);
    const std::int32_t surfaces = 2;
    std::memcpy(file.data() + kSurfaces, &surfaces, sizeof surfaces);
    EXPECT_THROW(ReadMd3(file, "models/a.md3", 0), Error);
}

TEST(Md3ModelTest, DamageIsNamed) {
    TestMesh mesh;
    mesh.AddPlate({-30, -10, 50}, {10, 50, 70});
    constexpr std::size_t kVersion = 4, kSurfaces = 84, kSurface = 164; // bytes from the start of the file
    constexpr std::size_t kFrames = 72, kVerts = 80, kTriangleOffset = 88, kVertOffset = 100,
                          kEnd = 104; // of a surface
    const std::vector<std::byte> whole = Md3Of({mesh});
    std::int32_t triangles = 0;
    std::memcpy(&triangles, whole.data() + kSurface + kTriangleOffset, sizeof triangles);
    const auto faultOf = [&whole](std::size_t at, std::int32_t value, int frame = 0) -> std::string {
        std::vector<std::byte> file = whole;
        std::memcpy(file.data() + at, &value, sizeof value);
        try {
            ReadMd3(file, "models/a.md3", frame);
        } catch (const Error &error) {
            return error.what();
        }
        return "no error";
    };
    EXPECT_EQ(faultOf(kVersion, 15), "no error");
    EXPECT_EQ(faultOf(kVersion, 14), "version 14, expected an MD3 model of version 15");
    EXPECT_EQ(faultOf(kVersion, 15, 1), "there is no frame 1: the model has 1");
    EXPECT_EQ(faultOf(kSurface + kFrames, 0), "there is no frame 0: the model has 0");
    EXPECT_EQ(faultOf(kSurfaces, 0), "no triangles");
    EXPECT_EQ(faultOf(kSurface + std::size_t(triangles), 1000),
              fmt::format("a triangle names vertex 1000 of {}", mesh.verts.size()));
    EXPECT_EQ(faultOf(kSurface + std::size_t(triangles), -1),
              fmt::format("a triangle names vertex -1 of {}", mesh.verts.size()));
    EXPECT_EQ(faultOf(kSurface + kEnd, 0), "surface 0 ends 0 bytes after its start");
    for (const std::size_t field : {kVerts, kTriangleOffset, kVertOffset})
        for (const std::int32_t value : {-1000, 1 << 24})
            EXPECT_THAT(faultOf(kSurface + field, value), HasSubstr("are not inside the")) << field << " " << value;
}

TEST_F(StaticPropTest, ModelsMayHaveMoreVerticesThanASurfaceOfTheMap) {
    AddModel("big", {Sheet(-200, 200, 300, 20)});
    Compile(Prop("big") + Lamp({0, 0, 200}, 100));
    Light("-staticproplighting -staticproppolys");
    const std::vector<Vec3f> colors = Colors();
    ASSERT_EQ(colors.size(), 301u * 301);
    EXPECT_GT(colors[150 * 301 + 150].x, colors[0].x);
    EXPECT_GT(colors[0].x, 1);
}

TEST_F(StaticPropTest, OptionsThatNeedAnotherAreErrors) {
    Compile("");
    EXPECT_THAT(Run("-textureshadows").text, HasSubstr("-textureshadows needs -staticproppolys"));
    EXPECT_THAT(Run("-staticpropfiles").text, HasSubstr("-staticpropfiles needs -staticproplighting"));
}

TEST_F(StaticPropTest, JsonAndInfoKnowTheLump) {
    AddModel("a", {Sheet(-16, 16, 1, 40)});
    Compile(Prop("a") + Lamp({0, 0, 200}, 100));
    Light("-staticproplighting");
    const auto before = LightOf(Load()).colors;
    const std::string map = (maps_ / "room.bsp").string(), base = (folder_ / "base").string();
    Outcome outcome = RunProgramFile({"-fs_basepath", base, "-info", map}, folder_.Root());
    EXPECT_THAT(outcome.text, HasSubstr("lit props"));
    EXPECT_THAT(outcome.text, HasSubstr("1 meshes with 4 vertices"));
    outcome = RunProgramFile({"-fs_basepath", base, "-json", "-unpack", map}, folder_.Root());
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    outcome = RunProgramFile({"-fs_basepath", base, "-json", "-pack", map}, folder_.Root());
    ASSERT_EQ(outcome.status, 0) << outcome.text;
    std::filesystem::rename(maps_ / "room_json.bsp", maps_ / "room.bsp");
    EXPECT_EQ(LightOf(Load()).colors, before);
}

} // namespace q3::test
