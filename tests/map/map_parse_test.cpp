// GPL-2.0-or-later. The map language: entities, keys, and what is said of text that is wrong.
#include "common/error.h"
#include "tests/map/map_fixture.h"

#include <random>

namespace q3::test {

namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kBox = BoxText({0, 0, 0}, {64, 64, 64});

/// Every byte that could make a reader go wrong is finite, in range and paired.
void ExpectSound(const Map &map) {
    for (const MapEntity &entity : map.entities) {
        for (const Brush &brush : entity.brushes)
            for (const BrushSide &side : brush.sides) {
                ASSERT_GE(side.planeNum, 0);
                ASSERT_LT(side.planeNum, map.planes.Count());
                for (const Vec3f &p : side.winding)
                    ASSERT_TRUE(IsFinite(p));
                for (const auto &row : side.texture.vecs)
                    for (const double value : row)
                        ASSERT_LT(std::abs(value), 1e31);
            }
        for (const Patch &patch : entity.patches) {
            ASSERT_EQ(patch.width % 2, 1);
            ASSERT_EQ(patch.height % 2, 1);
            ASSERT_EQ(patch.verts.size(), std::size_t(patch.width * patch.height));
            for (const DrawVert &v : patch.verts)
                ASSERT_TRUE(IsFinite(v.xyz));
        }
    }
}

} // namespace

TEST_F(MapTest, KeysKeepSpellingAndOrderAndTheFirstCounts) {
    Map map = Read("{ // world\n\"classname\" \"worldspawn\"\n\"Message\" \"a // b ; c\"\n\"empty\" \"\"\n"
                   "\"message \" \"second  \"\n}\n/* a\ncomment */\n{\n\"classname\" \"light\"\nplain word\n}\n");
    ASSERT_EQ(map.entities.size(), 2u);
    const auto &pairs = map.World().pairs.pairs;
    ASSERT_EQ(pairs.size(), 3u) << "a pair without a value is dropped";
    EXPECT_EQ(pairs[1].first, "Message");
    EXPECT_EQ(pairs[2].first, "message");
    EXPECT_EQ(pairs[2].second, "second");
    EXPECT_EQ(map.World().pairs.Value("MESSAGE"), "a // b ; c");
    EXPECT_EQ(map.entities[1].pairs.Value("plain"), "word");
}

TEST_F(MapTest, NumbersOfEntitiesAndPrimitivesAreThoseOfTheFile) {
    Map map = Read(WorldText(kBox + FlatPatchText(3, 3, {}) + kBox) + EntityText("func_group", kBox) +
                   EntityText("group_info", "") + EntityText("func_door", FlatPatchText(3, 3, {}) + kBox));
    ASSERT_EQ(map.entities.size(), 2u);
    EXPECT_EQ(map.entities[1].number, 3);
    EXPECT_EQ(map.entities[1].brushes.at(0).primitive, 1);
    EXPECT_EQ(map.entities[1].brushes.at(0).settings.entity, 3);
    const std::deque<Brush> &world = map.World().brushes;
    ASSERT_EQ(world.size(), 3u);
    EXPECT_EQ(world[0].settings.entity, 1) << "a group's brush is in front and keeps its number";
    EXPECT_EQ(world[1].primitive, 2);
}

TEST_F(MapTest, DegenerateDuplicateAndMirroredPlanesAreNamed) {
    const std::string box = kBox.substr(0, kBox.size() - 2);
    Map degenerate = Read(WorldText(box + "( 1 1 1 ) ( 1 1 1 ) ( 5 5 5 ) wall 0 0 0 1 1\n}\n"));
    EXPECT_EQ(degenerate.World().brushes.at(0).sides.size(), 6u);
    EXPECT_EQ(Warnings("degenerate plane"), 1);
    Map twice = Read(WorldText(box + SideText({{0, 0, 1}, 64}) + "}\n"));
    EXPECT_EQ(twice.World().brushes.at(0).sides.size(), 6u);
    EXPECT_EQ(Warnings("duplicate plane"), 1);
    Map mirrored = Read(WorldText(FlatPatchText(3, 3, {}) + box + SideText({{0, 0, -1}, -64}) + "}\n" + kBox));
    EXPECT_EQ(mirrored.World().brushes.size(), 1u);
    EXPECT_THAT(out.text, testing::ContainsRegex("Entity 0, Brush 1: maps/test.map:[0-9]+: mirrored plane"));
}

TEST_F(MapTest, EmptyAndOutsideBrushesAreNamed) {
    EXPECT_TRUE(Read(WorldText(BrushText({{{1, 0, 0}, 8}, {{0, 1, 0}, 8}}))).World().brushes.empty());
    EXPECT_TRUE(Read(WorldText(BoxText({0, 0, 0}, {64, 64, 70000}))).World().brushes.empty());
    EXPECT_TRUE(Read(WorldText("{\n}\n")).World().brushes.empty());
    EXPECT_EQ(Warnings("empty brush"), 1);
    EXPECT_EQ(Warnings("brush outside the world"), 1);
    EXPECT_THAT(out.text, HasSubstr("Entity 0, Brush 0: maps/test.map:4: the brush is open, encloses nothing"));
    EXPECT_THAT(out.text, HasSubstr("Entity 0, Brush 0: maps/test.map:4: the brush reaches beyond 65536 units"));
}

TEST_F(MapTest, WhatIsNotANumberIsNamedAndZero) {
    Map map = Read(WorldText("{\n( x0 0 0 ) ( 0 1 0 ) ( 0 0 1 ) wall 0 0 0 1 1\n}\n" + kBox));
    EXPECT_EQ(map.World().brushes.size(), 1u);
    EXPECT_THAT(out.text,
                HasSubstr("Entity 0, Brush 0: maps/test.map:4: expected a number, found 'x0': it counts as 0"));
    Read(WorldText("{\n( 0 0 0 ) ( 0 1 0 ) ( 0 0 1 ) wall 8units 0 0 1 1\n}\n"));
    EXPECT_EQ(Warnings("not a number"), 2) << "part of it is not";
}

TEST_F(MapTest, NothingBetweenQuotesIsNotANumber) {
    Read(WorldText("{\n( \"\" 0 0 ) ( 0 1 0 ) ( 0 0 1 ) wall 0 0 0 1 1\n}\n"));
    EXPECT_EQ(Warnings("not a number"), 1);
    EXPECT_THAT(out.text, HasSubstr("Entity 0, Brush 0: maps/test.map:4: expected a number, found ''"));
}

TEST_F(MapTest, AnotherFirstEntityIsNamed) {
    Read(EntityText("info_player_start", "") + WorldText(kBox));
    EXPECT_THAT(out.text, HasSubstr("the first entity is 'info_player_start', expected worldspawn"));
    EXPECT_EQ(Warnings("first entity"), 1);
    Read(WorldText(kBox));
    EXPECT_EQ(Warnings("first entity"), 1);
}

TEST_F(MapTest, ErrorsNameFileLineEntityAndBrush) {
    const auto inSecondBrush = [&](std::string_view text) {
        return ErrorOf("{\n" + std::string("{\n}\n{\n") + std::string(text) + "\n}\n}\n");
    };
    const auto place = AllOf(HasSubstr("Entity 0, Brush 1"), HasSubstr("maps/test.map:5"));
    EXPECT_THAT(inSecondBrush("( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 )"), AllOf(place, HasSubstr("name of a shader")));
    EXPECT_THAT(inSecondBrush("( 0 0"), AllOf(place, HasSubstr("the line ends where a number")));
    EXPECT_THAT(inSecondBrush("( 0 0 0 0 ) ( 0 1 0 ) ( 1 0 0 )"), AllOf(place, HasSubstr("expected ')', found '0'")));
    EXPECT_THAT(inSecondBrush("( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) wall 0 0 0 1"),
                AllOf(place, HasSubstr("the line ends where a number")));
    EXPECT_THAT(inSecondBrush("( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) wall 0 0 0 1 1 4 0"),
                AllOf(place, HasSubstr("a whole number")));
    EXPECT_THAT(inSecondBrush("( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) " + std::string(55, 'a') + " 0 0 0 1 1"),
                AllOf(place, HasSubstr("64 characters")));
    EXPECT_THAT(inSecondBrush("( 0 0 0 ) ( 0 1 0 ) ( 1 0 0 ) " + std::string(2000, 'a')),
                AllOf(place, HasSubstr("2000 bytes")));
    EXPECT_THAT(inSecondBrush("patchDef5"), AllOf(place, HasSubstr("found 'patchDef5'")));
    EXPECT_THAT(ErrorOf("{\n\"key\"\n}\n"), AllOf(HasSubstr("Entity 0"), HasSubstr("maps/test.map:2")));
}

TEST_F(MapTest, NamesOfSixtyThreeCharactersAreFine) {
    const std::string name(54, 'a');
    Map map = Read(WorldText(BoxText({0, 0, 0}, {8, 8, 8}, name)));
    EXPECT_EQ(map.World().brushes.at(0).sides[0].shader->name.size(), 63u);
}

TEST_F(MapTest, TooManySidesAreAnError) {
    std::string text = "{\n";
    for (int i = 0; i < 1025; ++i)
        text += SideText({{1, 0, 0}, double(i)});
    EXPECT_THAT(ErrorOf(WorldText(text + "}\n")), AllOf(HasSubstr("Entity 0, Brush 0"), HasSubstr("at most 1024")));
}

TEST_F(MapTest, TextThatEndsTooEarly) {
    EXPECT_THAT(ErrorOf("{\n{\n" + SideText({{0, 0, 1}, 0})), HasSubstr("Entity 0, Brush 0"));
    EXPECT_THAT(ErrorOf("{\n{\npatchDef2\n{\nwall\n"), HasSubstr("the file ends"));
    EXPECT_THAT(ErrorOf("{\n{\nterrainDef\n{\n"), HasSubstr("the file ends"));
    Map map = Read("{\n\"classname\" \"worldspawn\"\n" + kBox);
    EXPECT_EQ(map.World().brushes.size(), 1u) << "what was read stays";
    EXPECT_EQ(Warnings("entity without end"), 1);
    EXPECT_THAT(ErrorOf(""), HasSubstr("no entity"));
    EXPECT_THAT(ErrorOf("// nothing\n"), HasSubstr("maps/test.map"));
}

TEST_F(MapTest, ReadsOnAfterAMissingBrace) {
    const std::string light = EntityText("light", "");
    Map closed = Read("{\n\"classname\" \"worldspawn\"\n" + kBox + light + light);
    ASSERT_EQ(closed.entities.size(), 3u) << "the world has no closing brace";
    EXPECT_EQ(closed.entities[1].pairs.ClassName(), "light");
    EXPECT_EQ(closed.World().brushes.size(), 1u);
    EXPECT_EQ(Warnings("missing brace"), 1);
    Map opened = Read(WorldText(kBox) + "\"classname\" \"light\"\n}\n" + light);
    ASSERT_EQ(opened.entities.size(), 2u) << "one light has no opening brace";
    EXPECT_EQ(Warnings("text between entities"), 1);
    EXPECT_THAT(out.text, HasSubstr("expected '{' of entity 1, found 'classname'; skipped to the next '{'"));
}

TEST_F(MapTest, TerrainIsLeftOut) {
    Map map = Read(WorldText("{\nterrainDef\n{\n { 5 5 } ( ( 1 2 ) { } )\n}\n}\n" + kBox) + EntityText("light", ""));
    EXPECT_EQ(map.entities.size(), 2u);
    EXPECT_EQ(map.World().brushes.at(0).primitive, 1);
    EXPECT_THAT(out.text, HasSubstr("Entity 0, Brush 0: maps/test.map:4: terrainDef is not supported"));
}

TEST_F(MapTest, FormsOfBrushesMayBeMixed) {
    std::string primitive = "{\nbrushDef\n{\n", valve = "{\n";
    for (const Plane &plane : BoxPlanes({0, 0, 0}, {64, 64, 64})) {
        primitive += PointsText(plane) + " ( ( 1 0 0 ) ( 0 1 0 ) ) wall 0 0 0\n";
        valve += PointsText(plane) + " wall [ 1 0 0 0 ] [ 0 1 0 0 ] 0 1 1\n";
    }
    EXPECT_EQ(Read(WorldText(kBox + primitive + "}\n}\n" + valve + "}\n" + kBox)).World().brushes.size(), 4u);
}

TEST_F(MapTest, IncludesAreSoughtBesideTheMap) {
    folder.Write("maps/part.map", EntityText("light", ""));
    const std::string text = WorldText("") + "$include \"part.map\"\n" + EntityText("info_null", "");
    const Map map = ReadMap(text, (folder / "maps/whole.map").string(), Context());
    ASSERT_EQ(map.entities.size(), 3u);
    EXPECT_EQ(map.entities[1].pairs.ClassName(), "light");
    EXPECT_THROW(ReadMap("$include \"none.map\"\n", (folder / "maps/whole.map").string(), Context()), Error);
}

TEST_F(MapTest, OriginBrushMovesTheEntity) {
    const std::string door = BoxText({128, 0, 0}, {192, 64, 64}) + FlatPatchText(3, 3, {128, 0, 0}) +
                             BoxText({144, 16, 16}, {176, 48, 48}, "origin");
    Map map = Read(WorldText("") + EntityText("func_rotating", "\"origin\" \"1 2 3\"\n" + door));
    const MapEntity &entity = map.entities.at(1);
    ASSERT_EQ(entity.brushes.size(), 1u);
    EXPECT_EQ(entity.pairs.Value("origin"), "161.000000 34.000000 35.000000");
    EXPECT_EQ(entity.origin, (Vec3f{161, 34, 35}));
    EXPECT_EQ(entity.brushOrigin, (Vec3f{160, 32, 32}));
    const Brush &brush = entity.brushes[0];
    EXPECT_EQ(brush.textureOrigin, (Vec3f{160, 32, 32}));
    EXPECT_EQ(brush.bounds.mins, (Vec3f{-32, -32, -32}));
    EXPECT_EQ(map.planes[brush.sides[1].planeNum].dist, 32);
    for (const Vec3f &p : brush.sides[1].winding)
        EXPECT_EQ(p.x, 32);
    EXPECT_EQ(entity.patches.at(0).verts[0].xyz, (Vec3f{-32, -32, -32}));
    EXPECT_EQ(entity.patches.at(0).lodBounds.mins, (Vec3f{-32, -32, -32}));
}

TEST_F(MapTest, OfTwoOriginBrushesTheLastCounts) {
    const std::string brushes =
        BoxText({0, 0, 0}, {32, 32, 32}, "origin") + BoxText({64, 0, 0}, {96, 32, 32}, "origin");
    Map map = Read(WorldText("") + EntityText("func_rotating", kBox + brushes));
    EXPECT_EQ(map.entities.at(1).brushOrigin, (Vec3f{80, 16, 16}));
    EXPECT_EQ(map.entities.at(1).brushes.at(0).bounds.mins, (Vec3f{-80, -16, -16}));
    EXPECT_THAT(out.text, testing::ContainsRegex("Entity 1, Brush 2: maps/test.map:[0-9]+: a second origin brush"));
}

TEST_F(MapTest, OriginBrushOfAGroupMovesNothing) {
    Map map = Read(WorldText("") + EntityText("func_group", BoxText({128, 0, 0}, {192, 64, 64}) +
                                                                BoxText({0, 0, 0}, {32, 32, 32}, "origin")));
    ASSERT_EQ(map.World().brushes.size(), 1u);
    EXPECT_EQ(map.World().brushes[0].bounds.mins, (Vec3f{128, 0, 0}));
    EXPECT_EQ(map.World().brushes[0].textureOrigin, Vec3f{});
    EXPECT_EQ(Warnings("group with an origin"), 0);
}

TEST_F(MapTest, OriginKeyMovesAGroupAndNothingElse) {
    const std::string body = "\"origin\" \"8 0 0\"\n" + kBox;
    Map group = Read(WorldText("") + EntityText("func_group", body));
    EXPECT_EQ(group.World().brushes.at(0).bounds.mins.x, 8);
    EXPECT_EQ(Warnings("group with an origin"), 1);
    Map door = Read(WorldText("") + EntityText("func_door", body));
    EXPECT_EQ(door.entities.at(1).brushes.at(0).bounds.mins.x, 0);
    EXPECT_EQ(door.entities.at(1).origin.x, 8);
}

TEST_F(MapTest, GroupsStayInTheWorld) {
    const std::string body = kBox + FlatPatchText(3, 3, {});
    Map far = Read(WorldText("") + EntityText("func_group", "\"origin\" \"3e38 0 0\"\n" + body));
    EXPECT_EQ(far.World().brushes.at(0).bounds.maxs.x, 64) << "not moved";
    Map edge = Read(WorldText("") + EntityText("func_group", "\"origin\" \"65500 0 0\"\n" + body));
    EXPECT_TRUE(edge.World().brushes.empty());
    EXPECT_TRUE(edge.World().patches.empty());
    EXPECT_EQ(Warnings("moved out of the world"), 2);
}

TEST_F(MapTest, OriginBrushInTheWorldMeansNothing) {
    Map map = Read(WorldText(kBox + BoxText({8, 8, 8}, {16, 16, 16}, "origin")));
    EXPECT_EQ(map.World().brushes.size(), 1u);
    EXPECT_EQ(map.World().brushes[0].bounds.mins, (Vec3f{0, 0, 0}));
    EXPECT_EQ(Warnings("origin brush in the world"), 1);
}

TEST_F(MapTest, BlockSizes) {
    const auto blockSize = [this](std::string_view pairs) {
        return Read(EntityText("worldspawn", std::string(pairs) + "\n")).blockSize;
    };
    EXPECT_EQ(blockSize(""), (std::array{1024, 1024, 1024}));
    EXPECT_EQ(blockSize("\"_blocksize\" \"512 256 0\""), (std::array{512, 256, 0}));
    EXPECT_EQ(blockSize("\"blocksize\" \"512\""), (std::array{512, 512, 512}));
    EXPECT_EQ(blockSize("\"chopsize\" \"512 256\""), (std::array{512, 512, 512}));
    EXPECT_EQ(blockSize("\"_blocksize\" \"0\""), (std::array{0, 0, 0}));
}

TEST_F(MapTest, SettingsOfSurfaces) {
    Map map =
        Read(EntityText("worldspawn", "\"_color\" \"1 0.5 0\"\n\"ambient\" \"10\"\n\"_celshader\" \"cel\"\n" + kBox) +
             EntityText("func_group", kBox) +
             EntityText("func_door", "\"_cs\" \"5\"\n\"_receiveShadows\" \"-1\"\n\"_ls\" \"0.5\"\n\"_ss\" \"8\"\n"
                                     "\"_sn\" \"60\"\n\"_ambient\" \"4\"\n\"_celshader\" \"other\"\n" +
                                         kBox) +
             EntityText("func_door", "\"lightmapscale\" \"-2\"\n" + kBox));
    const SurfaceSettings &group = map.World().brushes.at(0).settings, &world = map.World().brushes.at(1).settings;
    const SurfaceSettings &first = map.entities.at(1).brushes.at(0).settings;
    const SurfaceSettings &second = map.entities.at(2).brushes.at(0).settings;
    EXPECT_EQ(world.castShadows, 1);
    EXPECT_EQ(group.castShadows, 1);
    EXPECT_EQ(second.castShadows, 0);
    EXPECT_EQ(second.receiveShadows, 1);
    EXPECT_EQ(first.castShadows, 5);
    EXPECT_EQ(first.receiveShadows, -1);
    EXPECT_EQ(first.lightmapScale, 0.5f);
    EXPECT_EQ(second.lightmapScale, 0);
    EXPECT_EQ(first.sampleSize, 8);
    EXPECT_EQ(first.shadeAngle, 60);
    EXPECT_EQ(world.ambient, (Vec3f{10, 5, 0}));
    EXPECT_EQ(group.ambient, (Vec3f{10, 5, 0}));
    EXPECT_EQ(first.ambient, (Vec3f{4, 4, 4}));
    EXPECT_EQ(group.celShader->name, "textures/cel");
    EXPECT_EQ(first.celShader->name, "textures/other");
}

TEST_F(MapTest, GarbageGivesAnErrorOrASoundMap) {
    const std::string text = WorldText("\"message\" \"x\"\n" + kBox + BoxText({0, 0, 64}, {64, 64, 80}, "water") +
                                       FlatPatchText(3, 3, {0, 0, 128})) +
                             EntityText("func_rotating", kBox + BoxText({8, 8, 8}, {16, 16, 16}, "origin")) +
                             EntityText("func_group", "\"origin\" \"8 8 8\"\n" + kBox);
    const std::vector<std::string> pieces{
        "{",        "}",         "(",          ")",         "[",     "]",      "\"",
        "//",       "/*",        ";",          "\n",        " ",     "-1",     "1e999",
        "nan",      "1e38",      "-inf",       "0",         "#",     "wall",   "patchDef2",
        "brushDef", "brushDef3", "terrainDef", "classname", "65537", "origin", "99999999999999999999"};
    std::mt19937 random(9);
    const auto below = [&random](std::size_t end) { return std::size_t(random() % end); };
    int errors = 0, maps = 0;
    for (int i = 0; i < 4000; ++i) {
        std::string bad = text;
        for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
            const std::size_t at = below(bad.size()), length = below(12);
            const std::string &piece = pieces[below(pieces.size())];
            switch (below(4)) {
            case 0:
                bad.insert(at, " " + piece + " ");
                break;
            case 1:
                bad.replace(at, std::min(length, bad.size() - at), piece);
                break;
            case 2:
                bad[at] = char(random());
                break;
            default:
                bad.resize(std::max<std::size_t>(at, 1));
                break;
            }
        }
        try {
            const Map map = Read(bad);
            ExpectSound(map);
            ++maps;
        } catch (const Error &error) {
            ASSERT_THAT(error.what(), HasSubstr("maps/test.map"));
            ASSERT_THAT(error.what(), testing::Not(HasSubstr("\n")));
            ++errors;
        }
        if (HasFatalFailure())
            FAIL() << bad;
        out.text.clear();
    }
    EXPECT_GT(errors, 500);
    EXPECT_GT(maps, 200);
}

TEST_F(MapTest, EscapedQuotesBecomeApostrophes) {
    Map map =
        Read("{\n\"classname\" \"worldspawn\"\n\"message\" \"say \\\"hi there\\\"\"\n\"path\" \"c:\\maps\\\"\n}\n");
    EXPECT_EQ(map.World().pairs.Value("message"), "say 'hi there'");
    EXPECT_EQ(map.World().pairs.Value("path"), "c:\\maps\\");
    EXPECT_EQ(map.World().pairs.pairs.size(), 3u);
    EXPECT_EQ(Warnings("escaped quote"), 1);
    EXPECT_THAT(out.text, HasSubstr("maps/test.map:3: entity 0: the key 'message' has escaped quotes"));
    Read("{\n\"classname\" \"worldspawn\"\n\"message\" \"say \"hi\" there\"\n}\n");
    EXPECT_THAT(out.text, HasSubstr("maps/test.map:3: entity 0: expected a key in quotes, found hi\""));
}

TEST_F(MapTest, ASecondWorldJoinsTheFirst) {
    Map map = Read(WorldText("\"message\" \"one\"\n" + kBox) +
                   EntityText("Worldspawn", "\"message\" \"two\"\n\"_lightmapscale\" \"2\"\n\"origin\" \"8 0 0\"\n" +
                                                kBox + FlatPatchText(3, 3, {})) +
                   EntityText("light", "") + WorldText(""));
    ASSERT_EQ(map.entities.size(), 2u);
    EXPECT_EQ(map.entities[1].pairs.ClassName(), "light");
    ASSERT_EQ(map.World().brushes.size(), 2u);
    EXPECT_EQ(map.World().patches.size(), 1u);
    const Brush &joined = map.World().brushes[0];
    EXPECT_EQ(joined.bounds.mins, (Vec3f{0, 0, 0}));
    EXPECT_EQ(joined.settings.lightmapScale, 2);
    EXPECT_EQ(joined.settings.castShadows, 1);
    EXPECT_EQ(map.World().pairs.Value("message"), "one");
    EXPECT_EQ(Warnings("second worldspawn"), 2);
    EXPECT_THAT(out.text,
                AllOf(HasSubstr("Entity 1: maps/test.map:"), HasSubstr("its brushes and patches join the world"),
                      HasSubstr("(message, _lightmapscale, origin)")));
}

TEST_F(MapTest, LongKeysOfEditorsAreLeftOut) {
    const auto world = [](std::string_view key, std::size_t size) {
        return EntityText("worldspawn", fmt::format("\"{}\" \"{}\"\n\"next\" \"1\"\n", key, std::string(size, 'x')));
    };
    Map map = Read(world("_tb_textures", 5000));
    EXPECT_EQ(map.World().pairs.pairs.size(), 2u);
    EXPECT_THAT(out.text, HasSubstr("maps/test.map:3: entity 0: the value of the key '_tb_textures' has 5000 bytes"));
    EXPECT_EQ(Read(world("_note", 1023)).World().pairs.pairs.size(), 3u);
    EXPECT_EQ(Read(world("_note", 1024)).World().pairs.pairs.size(), 2u);
    EXPECT_THAT(ErrorOf(world("message", 1024)),
                AllOf(HasSubstr("Entity 0: maps/test.map:3: the value of the key 'message' has 1024 bytes"),
                      testing::Not(HasSubstr("quote"))));
    EXPECT_THAT(ErrorOf("{\n\"message\" \"open\n" + std::string(2000, 'x')), HasSubstr("is a quote missing"));
    // Short notes of an editor do not go into the .bsp either.
    EXPECT_EQ(Read(world("_tb_def", 10)).World().pairs.pairs.size(), 2u);
}

TEST_F(MapTest, SourcesOfOtherGamesAreNamed) {
    EXPECT_THAT(ErrorOf("Version 2\n// entity 0\n{\n\"classname\" \"worldspawn\"\n}\n"),
                HasSubstr("maps/test.map: the file is a map source of Doom 3 (Version 2)"));
    EXPECT_THAT(ErrorOf("Version 3\n{\n}\n"), HasSubstr("Quake 4"));
    EXPECT_THAT(ErrorOf("iwmap 4\n// entity 0\n{\n}\n"), HasSubstr("Call of Duty"));
    EXPECT_THAT(ErrorOf("versioninfo\n{\n\t\"editorversion\" \"400\"\n}\n"), HasSubstr("Source game (vmf)"));
    EXPECT_THAT(ErrorOf("PK\3\4..."), HasSubstr("a zip archive"));
    EXPECT_THAT(ErrorOf(std::string("IBSP\x2E\0\0\0", 8)), HasSubstr("a compiled map"));
    EXPECT_NO_THROW(Read("// Game: Quake 3\n// Format: Quake3 (Valve)\n" + WorldText(kBox)));
}

} // namespace q3::test
