// GPL-2.0-or-later. Whole compiles of small maps.
#include "common/error.h"
#include "q3map2/geometry/compile_map.h"
#include "q3map2/geometry/emit/game_entities.h"
#include "tests/support/compile_fixture.h"

#include <numbers>
#include <set>

namespace q3::test {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Counts, bounds and indexes are those that NetRadiant's q3map2 gives for this room with -meta.
TEST_F(CompileTest, EmptyRoomHasTheKnownCounts) {
    const CompiledMap map = Compile(MapText(RoomText()));
    const Bsp &bsp = map.bsp;
    EXPECT_EQ(bsp.brushes.size(), 6u);
    EXPECT_EQ(bsp.brushSides.size(), 36u);
    EXPECT_EQ(bsp.planes.size(), 28u);
    EXPECT_EQ(bsp.nodes.size(), 19u);
    EXPECT_EQ(bsp.leafs.size(), 21u); // 20 of a tree with 19 splits, and the first, which no node refers to
    EXPECT_EQ(bsp.leafSurfaces.size(), 16u);
    EXPECT_EQ(bsp.leafBrushes.size(), 20u);
    EXPECT_EQ(bsp.models.size(), 1u);
    ASSERT_EQ(bsp.drawSurfaces.size(), 6u);
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
        EXPECT_EQ(surface.surfaceType, MST_PLANAR);
        EXPECT_EQ(surface.numVerts, 4);
        EXPECT_EQ(surface.numIndexes, 6);
        EXPECT_EQ(surface.lightmapNum[0], -3);
        EXPECT_EQ(surface.fogNum, -1);
    }
    EXPECT_THAT(bsp.drawIndexes, ElementsAre(0, 1, 2, 0, 2, 3, 0, 1, 2, 3, 1, 0));
    EXPECT_THAT(bsp.nodes[0].mins, ElementsAre(-136, -136, -8));
    EXPECT_THAT(bsp.nodes[0].maxs, ElementsAre(136, 136, 136));
    EXPECT_THAT(bsp.models[0].mins, ElementsAre(-144, -144, -16));
    EXPECT_TRUE(map.portalFile.starts_with("PRT1\n4\n4\n16\n")) << map.portalFile;
    EXPECT_TRUE(map.leakLine.empty());
}

TEST_F(CompileTest, WithoutBlocksTheRoomIsOneCluster) {
    const CompiledMap map = Compile(MapText(RoomText(), "\"_blocksize\" \"0\"\n"));
    EXPECT_TRUE(map.portalFile.starts_with("PRT1\n1\n0\n")) << map.portalFile;
}

TEST_F(CompileTest, FacesLookIntoTheRoomAndTrianglesAreClockwise) {
    const Bsp bsp = Compile(MapText(RoomText())).bsp;
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        for (std::size_t i = 0; i < std::size_t(surface.numIndexes); i += 3) {
            std::array<Vec3d, 3> p;
            for (std::size_t j = 0; j < 3; ++j) {
                const auto index = std::size_t(bsp.drawIndexes[std::size_t(surface.firstIndex) + i + j]);
                const bspDrawVert_t &vert = bsp.drawVerts[std::size_t(surface.firstVert) + index];
                p[j] = Vec3d(Vec3f(vert.xyz));
                EXPECT_GT(Dot(Vec3f(vert.normal), Vec3f{0, 0, 64} - Vec3f(vert.xyz)), 0);
            }
            const Vec3d normal(Vec3f(surface.lightmapVecs[2]));
            EXPECT_LT(Dot(Cross(p[1] - p[0], p[2] - p[0]), normal), 0);
        }
}

TEST_F(CompileTest, SurfaceFileNamesWhatDiffersFromItsDefaults) {
    const CompiledMap map = Compile(MapText(RoomText()));
    EXPECT_TRUE(map.surfaceFile.starts_with("default\n{\n\tcastShadows 1\n\treceiveShadows 1\n\tsampleSize 16\n"
                                            "\tambientColor ( 0.000000 0.000000 0.000000 )\n"
                                            "\tlongestCurve 0.000000\n}\n\n0 // ESurfaceType::Meta V: 4 I: 6 planar\n"
                                            "{\n\tshader textures/test/wall\n\tlightmapAxis ( "))
        << map.surfaceFile;
    EXPECT_THAT(map.surfaceFile, HasSubstr("\n5 // ESurfaceType::Meta"));
    EXPECT_THAT(map.surfaceFile, Not(HasSubstr("\n6 // ")));
}

TEST_F(CompileTest, LightsAreStrippedUnlessKept) {
    EXPECT_THAT(Compile(MapText(RoomText())).bsp.entities, Not(HasSubstr("\"light\"")));
    EXPECT_THAT(Compile(MapText(RoomText(), "\"_keepLights\" \"1\"\n")).bsp.entities,
                HasSubstr("\"classname\" \"light\""));
    options.keepLights = true;
    EXPECT_THAT(Compile(MapText(RoomText())).bsp.entities, HasSubstr("\"classname\" \"light\""));
}

TEST_F(CompileTest, LeakEndsAtTheEntityAndWritesNoPortals) {
    const CompiledMap map = Compile(MapText(RoomText(true)));
    ASSERT_GE(map.leakLine.size(), 2u);
    EXPECT_GT(map.leakLine.front().z, 100);
    EXPECT_EQ(map.leakLine.back(), (Vec3f{0, 0, 96})); // the light is nearer to the hole
    EXPECT_TRUE(map.portalFile.empty());
    EXPECT_FALSE(map.abandoned);
    EXPECT_FALSE(map.bsp.drawSurfaces.empty());
    EXPECT_THAT(out.text, HasSubstr("leaked"));
}

TEST_F(CompileTest, LeakTestStops) {
    options.leakTest = true;
    EXPECT_TRUE(Compile(MapText(RoomText(true))).abandoned);
    EXPECT_FALSE(Compile(MapText(RoomText())).abandoned);
}

TEST_F(CompileTest, IgnoredLeakCountsAsSealed) {
    const CompiledMap map = Compile(MapText(RoomText(true), "\"_ignoreleaks\" \"1\"\n"));
    EXPECT_TRUE(map.leakLine.empty());
    EXPECT_TRUE(map.portalFile.starts_with("PRT1\n"));
}

TEST_F(CompileTest, NoEntityInTheOpenIsAnError) {
    const std::string inWall = "{\n\"classname\" \"info_player_start\"\n\"origin\" \"136 0 32\"\n}\n";
    for (const std::string &text : {WorldText(RoomText()), WorldText(RoomText()) + inWall})
        try {
            Compile(text);
            FAIL() << "compiled";
        } catch (const Error &error) {
            EXPECT_THAT(error.what(), HasSubstr("no entity is in open space"));
        }
    EXPECT_THAT(out.text, HasSubstr("stands in solid"));
}

TEST_F(CompileTest, WithoutStructuralWallsThereIsNoTreeAndThatIsAnError) {
    try {
        Compile(MapText(Box({-8, -8, 0}, {8, 8, 16}, "test/back"), "\"_ignoreleaks\" \"1\"\n"));
        FAIL() << "compiled";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), HasSubstr("test.map: no structural brush is seen"));
    }
}

TEST_F(CompileTest, BrushEntitiesBecomeModels) {
    const std::string door = "{\n\"classname\" \"func_door\"\n" + Box({-8, -8, 0}, {8, 8, 64}) + "}\n";
    const std::string trigger = "{\n\"classname\" \"trigger_multiple\"\n" + Box({40, 40, 0}, {48, 48, 8}) + "}\n";
    const Bsp bsp = Compile(MapText(RoomText()) + door + trigger).bsp;
    ASSERT_EQ(bsp.models.size(), 3u);
    EXPECT_EQ(bsp.models[1].numBSPBrushes, 1);
    EXPECT_EQ(bsp.models[1].numBSPSurfaces, 6);
    EXPECT_EQ(bsp.models[1].firstBSPSurface, bsp.models[0].numBSPSurfaces);
    EXPECT_THAT(bsp.models[2].mins, ElementsAre(40, 40, 0));
    EXPECT_THAT(bsp.models[2].maxs, ElementsAre(48, 48, 8));
    const std::vector<Entity> entities = ParseEntities(bsp.entities, "test");
    ASSERT_EQ(entities.size(), 4u);
    EXPECT_EQ(entities[2].Value("model"), "*1");
    EXPECT_EQ(entities[3].Value("model"), "*2");
    EXPECT_EQ(bsp.leafs[bsp.leafs.size() - 1].numBSPLeafBrushes, 1);
    EXPECT_EQ(bsp.leafs[bsp.leafs.size() - 1].numBSPLeafSurfaces, 6);
}

TEST_F(CompileTest, ClonesShareTheModelOfTheirParent) {
    const std::string parent =
        "{\n\"classname\" \"func_static\"\n\"_clonename\" \"crate\"\n" + Box({-8, -8, 0}, {8, 8, 16}) + "}\n";
    const std::string clone = "{\n\"classname\" \"func_static\"\n\"_clone\" \"crate\"\n\"origin\" \"64 0 0\"\n}\n";
    const std::string orphan = "{\n\"classname\" \"func_static\"\n\"_clone\" \"nobody\"\n}\n";
    const Bsp bsp = Compile(MapText(RoomText()) + parent + clone + orphan).bsp;
    EXPECT_EQ(bsp.models.size(), 2u);
    const std::vector<Entity> entities = ParseEntities(bsp.entities, "test");
    EXPECT_EQ(entities[3].Value("model"), "*1");
    EXPECT_EQ(entities[4].Value("model"), "");
    EXPECT_EQ(out.log.WarningCount("clone without parent"), 1);
}

TEST_F(CompileTest, GroupsJoinTheWorld) {
    const std::string group = "{\n\"classname\" \"func_group\"\n" + Box({-8, -8, 0}, {8, 8, 64}) + "}\n";
    const Bsp bsp = Compile(MapText(RoomText()) + group).bsp;
    EXPECT_EQ(bsp.models.size(), 1u);
    EXPECT_EQ(bsp.brushes.size(), 7u);
    EXPECT_THAT(bsp.entities, Not(HasSubstr("func_group")));
}

TEST_F(CompileTest, NodrawSidesAreSolidButNotDrawn) {
    const Bsp bsp = Compile(MapText(RoomText() + Box({-8, -8, 0}, {8, 8, 64}, "test/caulk"))).bsp;
    EXPECT_EQ(bsp.brushes.size(), 7u);
    EXPECT_TRUE(SurfacesOf(bsp, "textures/test/caulk").empty());
}

TEST_F(CompileTest, RemappedShadersKeepTheirFlags) {
    const Bsp bsp = Compile(MapText(RoomText() + Box({-8, -8, 0}, {8, 8, 64}, "test/glass"))).bsp;
    EXPECT_FALSE(SurfacesOf(bsp, "textures/test/panes").empty());
    const auto panes = std::ranges::find_if(
        bsp.shaders, [](const bspShader_t &shader) { return FieldName(shader.shader) == "textures/test/panes"; });
    ASSERT_NE(panes, bsp.shaders.end());
    EXPECT_NE(panes->contentFlags & 0x20000000u, 0u); // translucent, as the script says of the other name
}

TEST_F(CompileTest, FlagsOfALeftOverCurveAreItsOwnOnly) {
    const auto curve = [](int x) {
        std::string text = "{\npatchDef2\n{\ntest/cloth\n( 3 3 0 0 0 )\n(\n";
        for (int column = 0; column < 3; ++column)
            text += fmt::format("( ( {0} -32 64 0 0 ) ( {0} 0 80 0 0 ) ( {0} 32 64 0 0 ) )\n", x + 32 * column);
        return text + ")\n}\n}\n";
    };
    const std::string group = "{\n\"classname\" \"func_group\"\n\"_patchMeta\" \"1\"\n" + curve(-100) + "}\n";
    const Bsp bsp = Compile(MapText(RoomText() + curve(20)) + group).bsp;
    constexpr std::uint32_t kNoDraw = 0x80;
    int hidden = 0, drawn = 0;
    for (const bspDrawSurface_t &surface : SurfacesOf(bsp, "textures/test/cloth")) {
        const bool isHidden = (bsp.shaders[std::size_t(surface.shaderNum)].surfaceFlags & kNoDraw) != 0;
        const bool isGroup = bsp.drawVerts[std::size_t(surface.firstVert)].xyz[0] < 0;
        EXPECT_EQ(isHidden, isGroup && surface.surfaceType == MST_PATCH);
        ++(isHidden ? hidden : drawn);
    }
    EXPECT_EQ(hidden, 1);
    EXPECT_GE(drawn, 2); // the other curve, and the triangles of the first
}

TEST_F(CompileTest, ABrushOfHundredsOfSidesCompiles) {
    constexpr int kSides = 300;
    std::string column = "{\n" + SideText(2, false, 16, "test/wall") + SideText(2, true, 48, "test/wall");
    const auto at = [](double turn, double z) {
        const double angle = 2 * std::numbers::pi * turn / kSides;
        return fmt::format("( {:.6f} {:.6f} {} ) ", 100 * std::cos(angle), 100 * std::sin(angle), z);
    };
    for (int i = 0; i < kSides; ++i)
        column += at(i, 0) + at(i, 64) + at(i + 1, 0) + "test/wall 0 0 0 0.5 0.5 0 0 0\n";
    for (const bool meta : {true, false}) {
        options.meta = meta;
        const Bsp bsp = Compile(MapText(RoomText() + column + "}\n")).bsp;
        double lid = 0; // area of its upper side
        for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
            for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
                std::vector<Vec3f> corners;
                for (int k = 0; k < 3; ++k)
                    corners.emplace_back(
                        bsp.drawVerts[std::size_t(surface.firstVert +
                                                  bsp.drawIndexes[std::size_t(surface.firstIndex + i + k)])]
                            .xyz);
                if (std::ranges::all_of(corners, [](const Vec3f &p) { return p.z == 48; }))
                    lid += WindingArea(corners);
            }
        EXPECT_NEAR(lid, std::numbers::pi * 100 * 100, 60) << meta;
    }
}

TEST_F(CompileTest, InvertedShadersFaceInwards) {
    const Bsp bsp = Compile(MapText(RoomText() + Box({-8, -8, 32}, {8, 8, 64}, "test/back"))).bsp;
    const auto surfaces = SurfacesOf(bsp, "textures/test/back");
    EXPECT_EQ(surfaces.size(), 6u);
    for (const bspDrawSurface_t &surface : surfaces) {
        const bspDrawVert_t &vert = bsp.drawVerts[std::size_t(surface.firstVert)];
        EXPECT_GT(Dot(Vec3f(vert.normal), Vec3f{0, 0, 48} - Vec3f(vert.xyz)), 0);
    }
}

TEST_F(CompileTest, DirectivesMoveVerticesTextureAndColors) {
    const Bsp bsp = Compile(MapText(RoomText() + Box({-8, -8, 32}, {8, 8, 64}, "test/moved"))).bsp;
    const auto surfaces = SurfacesOf(bsp, "textures/test/moved");
    ASSERT_EQ(surfaces.size(), 6u);
    for (const bspDrawSurface_t &surface : surfaces) {
        float s = 0, least = 1e9f, most = -1e9f;
        for (int i = 0; i < surface.numVerts; ++i) {
            const bspDrawVert_t &vert = bsp.drawVerts[std::size_t(surface.firstVert + i)];
            EXPECT_THAT(vert.color[0], ElementsAre(127, 255, 0, 127));
            const Vec3f middle = Vec3f(vert.xyz) - Vec3f{0, 0, 48};
            const bool isTop = std::abs(vert.normal[2]) > 0.5f;
            EXPECT_FLOAT_EQ(Dot(middle, Vec3f(vert.normal)), isTop ? 19 : 11); // 3 more than the box
            s = vert.st[0];
            least = std::min(least, s);
            most = std::max(most, s);
        }
        EXPECT_LE(std::abs(least + most) / 2, 1);           // 40 whole repeats are taken off again
        EXPECT_NEAR(most - least, 2 * 16 * 2.0 / 64, 1e-5); // texels at scale 0.5 of an image 64 wide, doubled
    }
}

TEST_F(CompileTest, ColorVolumesChangeVerticesInside) {
    const Bsp bsp = Compile(MapText(RoomText() + Box({100, 100, -8}, {140, 140, 8}, "test/dim"))).bsp;
    int inside = 0;
    for (const bspDrawVert_t &vert : bsp.drawVerts) {
        const bool isIn = vert.xyz[0] > 99 && vert.xyz[1] > 99 && vert.xyz[2] < 9;
        inside += isIn ? 1 : 0;
        EXPECT_EQ(vert.color[0][0], isIn ? 0 : 255);
        EXPECT_EQ(vert.color[0][2], 255);
    }
    EXPECT_EQ(inside, 3); // a corner of the floor and of two walls
}

TEST_F(CompileTest, FogIsWrittenWithItsBrushAndTopSide) {
    const Bsp bsp = Compile(MapText(RoomText() + Box({-128, -128, 0}, {128, 128, 32}, "test/mist"))).bsp;
    ASSERT_EQ(bsp.fogs.size(), 1u);
    EXPECT_EQ(FieldName(bsp.fogs[0].shader), "textures/test/mist");
    EXPECT_EQ(bsp.fogs[0].visibleSide, 5);
    ASSERT_GE(bsp.fogs[0].brushNum, 0);
    const bspBrush_t &brush = bsp.brushes[std::size_t(bsp.fogs[0].brushNum)];
    EXPECT_EQ(FieldName(bsp.shaders[std::size_t(brush.shaderNum)].shader), "textures/test/mist");
    options.noFog = true;
    EXPECT_TRUE(Compile(MapText(RoomText() + Box({-128, -128, 0}, {128, 128, 32}, "test/mist"))).bsp.fogs.empty());
}

TEST_F(CompileTest, SkyImagesAreFlaresInNoLeaf) {
    options.skyFix = true;
    const Bsp bsp = Compile(MapText(RoomText(true) + Box({-128, -128, 128}, {128, 128, 144}, "test/sky"))).bsp;
    ASSERT_EQ(bsp.drawSurfaces.size(), 12u);
    for (std::size_t i = 6; i < 12; ++i)
        EXPECT_TRUE(ShaderOf(bsp, bsp.drawSurfaces[i]).starts_with("env/dawn_"));
    EXPECT_EQ(std::ranges::max(bsp.leafSurfaces), 5);
}

TEST_F(CompileTest, EverySurfaceOfTheWorldIsInALeafThatIsOpen) {
    const Bsp bsp = Compile(MapText(RoomText() + Box({-8, -8, 0}, {8, 8, 64}))).bsp;
    std::set<int> seen;
    for (const bspLeaf_t &leaf : bsp.leafs) {
        if (leaf.cluster < 0) {
            EXPECT_EQ(leaf.numBSPLeafSurfaces, 0);
        }
        for (int i = 0; i < leaf.numBSPLeafSurfaces; ++i)
            seen.insert(bsp.leafSurfaces[std::size_t(leaf.firstBSPLeafSurface + i)]);
    }
    EXPECT_EQ(int(seen.size()), bsp.models[0].numBSPSurfaces);
}

TEST_F(CompileTest, SameMapGivesTheSameBytes) {
    const std::string text = MapText(RoomText() + Box({-8, -8, 0}, {8, 8, 64}, "test/glass"));
    const CompiledMap a = Compile(text), b = Compile(text);
    EXPECT_EQ(WriteBsp(a.bsp, {}), WriteBsp(b.bsp, {}));
    EXPECT_EQ(a.surfaceFile, b.surfaceFile);
    EXPECT_EQ(a.portalFile, b.portalFile);
}

TEST_F(CompileTest, CaulkIsSuggestedForSidesNobodySees) {
    options.autoCaulk = true;
    EXPECT_EQ(Compile(MapText(RoomText())).caulkFile, "5 cccc-c\n4 ccccc-\n3 cc-ccc\n2 ccc-cc\n1 -ccccc\n0 c-cccc\n");
}

TEST_F(CompileTest, DecalsAreNoModelsWhenEntitiesAreReplaced) {
    std::string patch = "{\npatchDef2\n{\ntest/cloth\n( 3 3 0 0 0 )\n(\n";
    for (int x = 0; x < 3; ++x)
        patch += fmt::format("( ( {0} 0 8 0 0 ) ( {0} 8 8 0 0 ) ( {0} 16 8 0 0 ) )\n", 8 * x);
    const std::string decal = "{\n\"classname\" \"_decal\"\n\"target\" \"aim\"\n" + patch + ")\n}\n}\n";
    const std::string door = "{\n\"classname\" \"func_door\"\n" + Box({0, 0, 0}, {16, 16, 16}) + "}\n";
    const std::string text = MapText(RoomText()) + decal + door;
    Bsp bsp = Compile(text).bsp;
    const std::string before = bsp.entities;
    const BspContext context{options, game, *library, out.log, &vfs};
    Map map = ReadMap(text, "test.map", context);
    ReplaceEntities(bsp, map, context);
    EXPECT_EQ(bsp.entities, before);
    EXPECT_THAT(bsp.entities, HasSubstr("\"model\" \"*1\""));
}

TEST_F(CompileTest, ReplacedEntitiesKeepTheRecordOfTheTools) {
    Bsp bsp = Compile(MapText(RoomText())).bsp;
    std::vector<Entity> entities = ParseEntities(bsp.entities, "test");
    entities.front().Set("_q3map2_cmdline", "-bsp -meta; -light");
    entities.front().Set("_q3map2_tone", "gamma 2");
    entities.front().Set("_switch32", "hall");
    bsp.entities = FormatEntities(entities);
    const BspContext context{options, game, *library, out.log, &vfs};
    Map map =
        ReadMap(MapText(RoomText(), "\"music\" \"new.wav\"\n\"_q3map2_sh\" \"radiance\"\n\"_q3map2_tone\" \"gamma 3\"\n"
                                    "\"_style13pattern\" \"az\"\n"),
                "test.map", context);
    const auto surfaces = bsp.drawSurfaces.size();
    ReplaceEntities(bsp, map, context);
    EXPECT_THAT(bsp.entities, HasSubstr("\"music\" \"new.wav\""));
    EXPECT_THAT(bsp.entities, HasSubstr("\"_q3map2_cmdline\" \"-bsp -meta; -light\""));
    EXPECT_THAT(bsp.entities, Not(HasSubstr("\"light\"")));
    EXPECT_THAT(bsp.entities, HasSubstr("\"_q3map2_tone\" \"gamma 2\"")) << "the light in the file has it";
    EXPECT_THAT(bsp.entities, HasSubstr("\"_switch32\" \"hall\"")) << "so do its lightmaps";
    EXPECT_THAT(bsp.entities, Not(HasSubstr("_style13pattern")));
    EXPECT_THAT(bsp.entities, Not(HasSubstr("_q3map2_sh"))) << "the file has no SH grid";
    EXPECT_EQ(bsp.drawSurfaces.size(), surfaces);
}

TEST_F(CompileTest, DamageShadersFollowTheirShader) {
    folder.Write("scripts/test.shader", std::string(kScript) + "textures/test/crate\n{\nsurfaceparm detail\n"
                                                               "damageShader textures/test/broken 50\n}\n");
    const Bsp bsp = Compile(MapText(RoomText() + Box({-8, -8, 0}, {8, 8, 64}, "test/crate"))).bsp;
    std::vector<std::string_view> names;
    for (const bspShader_t &shader : bsp.shaders)
        names.push_back(FieldName(shader.shader));
    const auto crate = std::ranges::find(names, "textures/test/crate");
    ASSERT_LT(crate - names.begin() + 1, std::ptrdiff_t(names.size()));
    EXPECT_EQ(crate[1], "textures/test/broken");
    EXPECT_EQ(std::ranges::count(names, "textures/test/broken"), 1);
}

// ---- Switchable lights of games whose files hold light styles ----

class SwitchTest : public CompileTest {
  protected:
    SwitchTest() {
        game = *FindGame("ja");
        folder.Write("shaders/test.shader", kScript);
    }
    static std::string LightText(std::string_view keys) {
        return fmt::format("{{\n\"classname\" \"light\"\n\"origin\" \"0 0 96\"\n{}\n}}\n", keys);
    }
    static std::string RoomWith(const std::string &lights) {
        return WorldText(RoomText()) + std::string(kStart) + lights;
    }
    /// targetname, style and switch_style of each light.
    static std::vector<std::array<std::string, 3>> LightsOf(std::string_view entities) {
        std::vector<std::array<std::string, 3>> lights;
        for (const Entity &entity : ParseEntities(entities, "test"))
            if (entity.ClassName() == "light")
                lights.push_back({std::string(entity.Value("targetname")),
                                  std::string(entity.Value({"style", "_style"})),
                                  std::string(entity.Value("switch_style"))});
        return lights;
    }
    static constexpr const char *kNamed[] = {"\"targetname\" \"a\"", "\"targetname\" \"b\"\n\"_style\" \"3\"",
                                             "\"targetname\" \"a\"", "\"style\" \"2\"",
                                             "\"targetname\" \"a\"\n\"style\" \"2\""};
    static std::string Named() {
        std::string text;
        for (const char *keys : kNamed)
            text += LightText(keys);
        return text;
    }
    std::string ErrorOf(const std::string &lights) {
        try {
            Compile(RoomWith(lights));
        } catch (const Error &error) {
            return error.what();
        }
        return "";
    }
};

using testing::IsEmpty;
using Light = std::array<std::string, 3>;

TEST_F(SwitchTest, NamedLightsStayWithANumberForEachNameAndStyle) {
    EXPECT_THAT(LightsOf(Compile(RoomWith(Named())).bsp.entities),
                ElementsAre(Light{"a", "32", ""}, Light{"b", "33", "3"}, Light{"a", "32", ""}, Light{"a", "34", "2"}));
    options.keepLights = true;
    EXPECT_THAT(LightsOf(Compile(RoomWith(Named())).bsp.entities),
                ElementsAre(Light{"a", "32", ""}, Light{"b", "33", "3"}, Light{"a", "32", ""}, Light{"", "2", ""},
                            Light{"a", "34", "2"}));
    options.keepLights = false;
    game = *FindGame("quake3");
    EXPECT_THAT(LightsOf(Compile(RoomWith(Named())).bsp.entities), IsEmpty());
}

TEST_F(SwitchTest, ReplacedEntitiesHaveTheSameNumbersAndTellOfOthers) {
    Bsp bsp = Compile(RoomWith(Named())).bsp;
    const std::string entities = bsp.entities;
    const BspContext context{options, game, *library, out.log, &vfs};
    Map map = ReadMap(RoomWith(Named()), "test.map", context);
    ReplaceEntities(bsp, map, context);
    EXPECT_EQ(bsp.entities, entities);
    EXPECT_EQ(out.log.WarningCount("renumbered lights"), 0);
    map = ReadMap(RoomWith(LightText("\"targetname\" \"new\"") + Named()), "test.map", context);
    ReplaceEntities(bsp, map, context);
    EXPECT_EQ(LightsOf(bsp.entities)[1], (Light{"a", "33", ""}));
    EXPECT_EQ(out.log.WarningCount("renumbered lights"), 1);
}

TEST_F(SwitchTest, EntitiesOfABspKeepTheirNumbers) {
    Bsp bsp = Compile(RoomWith(Named())).bsp;
    const BspContext context{options, game, *library, out.log, &vfs};
    Map map = ReadMap(bsp.entities, "test.ent", context);
    const auto before = LightsOf(bsp.entities);
    ReplaceEntities(bsp, map, context);
    EXPECT_EQ(LightsOf(bsp.entities), before);
}

TEST_F(SwitchTest, StylesAndGroupsThatEnginesDoNotHaveAreRefused) {
    std::string lights;
    for (int i = 0; i < 32; ++i)
        lights += LightText(fmt::format("\"targetname\" \"lamp{}\"", i));
    EXPECT_EQ(ErrorOf(lights), "");
    EXPECT_EQ(ErrorOf(lights + LightText("\"targetname\" \"Lamp7\"")), "") << "games ignore the case of names";
    const std::string tooMany = ErrorOf(lights + LightText("\"targetname\" \"last\"\n\"style\" \"4\""));
    EXPECT_THAT(tooMany, HasSubstr("33 groups of switchable lights"));
    EXPECT_THAT(tooMany, HasSubstr("lamp31, last of style 4"));
    EXPECT_EQ(ErrorOf(LightText("\"style\" \"31\"")), "");
    EXPECT_EQ(out.log.WarningCount("style of switchable lights"), 0);
    EXPECT_EQ(ErrorOf(LightText("\"style\" \"63\"")), "");
    EXPECT_EQ(out.log.WarningCount("style of switchable lights"), 1) << "it would be switched with other lights";
    for (const int style : {64, 255})
        EXPECT_THAT(ErrorOf(LightText(fmt::format("\"style\" \"{}\"", style))),
                    testing::AllOf(HasSubstr("Entity 2: test.map:"), HasSubstr(fmt::format("light style {}", style))));
}

TEST_F(CompileTest, OneWarningAboutMapsOfStructuralBrushes) {
    std::string boxes;
    for (int i = 0; i < 504; ++i) {
        const Vec3d at{-124.0 + 8 * (i % 31), -124.0 + 8 * (i / 31), 0};
        boxes += Box(at, at + Vec3d{4, 4, 4});
    }
    Compile(MapText(RoomText() + boxes));
    EXPECT_EQ(out.log.WarningCount("structural brushes"), 1);
    EXPECT_EQ(out.text.find("percent of the"), std::string::npos);
}

TEST_F(CompileTest, TooManySurfacesNameTheOption) {
    options.maxDrawSurfaces = 3;
    try {
        Compile(MapText(RoomText()));
        FAIL() << "compiled";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), HasSubstr("-maxmapdrawsurfs"));
    }
}

} // namespace

} // namespace q3::test
