// GPL-2.0-or-later. JSON folders back to maps.
#include "tests/convert/json/json_fixture.h"

#include <gmock/gmock.h>

#include <bit>
#include <limits>

namespace q3::test {

namespace {

using testing::HasSubstr;

/// Between the folder and the name of a file, as messages have it.
const std::string kSeparator(1, char(std::filesystem::path::preferred_separator));

using PackJsonTest = JsonTest;

TEST_F(PackJsonTest, GivesTheSameBytes) {
    ExpectSame(SmallBsp());
    ExpectSame(FullBsp(GridSHContainer::Lump));
    ExpectSame(FullBsp(GridSHContainer::Bspx));
}

TEST_F(PackJsonTest, FilesWithFourStyles) {
    for (const std::string_view ident : {kRbspIdent, kFbspIdent}) {
        Bsp bsp = SmallBsp();
        bsp.ident = ident;
        if (ident == kFbspIdent) {
            bsp.lightmapSide = kFbspLightmapSide;
            bsp.lightmaps.assign(LightmapPageBytes(kFbspLightmapSide), 3);
        }
        bsp.drawSurfaces[0].lightmapStyles = {0, 3, 33, kNoStyle};
        bsp.drawSurfaces[0].lightmapNum[1] = 0;
        bsp.drawVerts[1].lightmap[2] = {0.5f, 0.25f};
        bsp.drawVerts[1].color[3] = {1, 2, 3, 4};
        bsp.brushSides[0].surfaceNum = 0;
        bsp.gridPoints[1].styles = kNoStyles;
        const BspFormat format{.version = 1, .ident = ident};
        Unpack(bsp);
        const Bsp packed = Pack();
        EXPECT_EQ(packed.ident, ident);
        EXPECT_EQ(WriteBsp(packed, format), WriteBsp(bsp, format));
    }
    folder_.Edit("format.json", "FBSP", "XBSP");
    EXPECT_THAT(PackError(), HasSubstr("format.json: format#0: ident: expected RBSP or FBSP"));
}

TEST_F(PackJsonTest, KeepsFloatsBitByBit) {
    Bsp bsp = SmallBsp();
    bsp.drawVerts[0].st = {-0.0f, std::numeric_limits<float>::denorm_min()};
    bsp.drawVerts[1].st = {std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity()};
    bsp.drawVerts[2].st = {std::bit_cast<float>(0xFFC00000u), std::bit_cast<float>(0x7FC00000u)};
    bsp.drawVerts[2].lightmap[0] = {0.5f, std::bit_cast<float>(0x7FFFFFFFu)};
    bsp.drawVerts[3].st = {std::numeric_limits<float>::max(), 0.1f + 0.2f};
    ExpectSame(bsp);
}

TEST_F(PackJsonTest, KeepsNamesByteByByte) {
    Bsp bsp = SmallBsp();
    bsp.shaders[0].shader = Field<64>("garbage\0behind \xE9 it");
    for (std::size_t i = 40; i < 64; i++)
        bsp.shaders[0].shader[i] = char(i * 11);
    bsp.shaders[1].shader = Field<64>(std::string(64, 'x'));
    bsp.fogs[0].shader = Field<64>("fo\"g\\ \xFF\x01");
    ExpectSame(bsp);
}

TEST_F(PackJsonTest, ARenamedShaderLosesTheBytesOfItsOldName) {
    Bsp bsp = SmallBsp();
    bsp.shaders[1].shader[20] = 'x';
    Unpack(bsp);
    folder_.Edit("shaders.json", "\"noshader\"", "\"other\"");
    EXPECT_EQ(Pack().shaders[1].shader, Field<64>("other"));
}

TEST_F(PackJsonTest, KeepsEntityTextThatIsNotInTheUsualForm) {
    for (const std::string_view text :
         {"", "{ \"classname\" \"worldspawn\" }\n", "{\n\"classname\" \"worldspawn\"\n}\r\n", "{\n}\n",
          "{\n\"a\" \"trailing \"\n}\n", "{\n\"classname\" \"misc_model\"\n\"caf\xE9\" \"\xE9\"\n}\n", "{ broken"}) {
        Bsp bsp = SmallBsp();
        bsp.entities = text;
        ExpectSame(bsp);
    }
}

TEST_F(PackJsonTest, EditedPairsWinOverTheKeptText) {
    Bsp bsp = SmallBsp();
    bsp.entities = "{ \"classname\" \"worldspawn\" }\n";
    Unpack(bsp);
    folder_.Edit("entities.json", "worldspawn", "worldspawn2");
    EXPECT_EQ(Pack().entities, "{\n\"classname\" \"worldspawn2\"\n}\n");
    EXPECT_THAT(log_.text, HasSubstr("entities.ent is ignored"));
}

TEST_F(PackJsonTest, TakesWhatTheEstablishedProgramWritesAndReads) {
    Unpack(SmallBsp());
    folder_.Put("planes.json", "\xEF\xBB\xBF{ // first\n \"a\": [1, 0, 0, 64,], /* two\n lines */ \"a\" : "
                               "[-1.0,-0.0,-0.0,-64.0,],\n\"x\": [1.0,0.0,0.0,0], \"\": [-1,-0.0,-0.0,-0.0],"
                               "\"p\":[0.0,1.0,0.0,64.0],\"p\":[-0.0,-1.0,-0.0,-64.0],\"p\":[0.0,1.0,0.0,0.0],"
                               "\"p\":[-0.0,-1.0,-0.0,-0.0],\"p\":[0.0,0.0,1.0,64.0],\"p\":[-0.0,-0.0,-1.0,-64.0],"
                               "\"p\":[0.0,0.0,1.0,0.0],\"p\":[-0.0,-0.0,-1.0,-0.0],}");
    folder_.Edit("DrawVert.json", "[[0.1, 0.25]", "[[NaN, -Infinity]");
    folder_.Edit("DrawVert.json", "[[0.1, 0.0]", "[[0.10000000149011612, +Inf]");
    const Bsp back = Pack();
    Bsp expected = SmallBsp();
    expected.drawVerts[2].lightmap[0] = {std::bit_cast<float>(0x7FC00000u), -std::numeric_limits<float>::infinity()};
    expected.drawVerts[3].lightmap[0] = {0.1f, std::numeric_limits<float>::infinity()};
    EXPECT_EQ(Bytes(back), Bytes(expected));
}

TEST_F(PackJsonTest, CommentsAndCommasInsideStringsStay) {
    Bsp bsp = SmallBsp();
    bsp.entities = "{\n\"message\" \"a // b /* c */ ,] NaN Inf \\\"\n}\n";
    ExpectSame(bsp);
}

TEST_F(PackJsonTest, UnknownMembersAreIgnored) {
    Unpack(SmallBsp());
    folder_.Edit("models.json", "\"numBSPBrushes\": 1", "\"numBSPBrushes\": 1, \"more\": [{\"a\": null}, true]");
    EXPECT_EQ(Bytes(Pack()), Bytes(SmallBsp()));
}

TEST_F(PackJsonTest, FlagsAreOredFromTheirValues) {
    Unpack(SmallBsp());
    folder_.Edit("shaders.json", R"("surfaceFlags": {})", R"("surfaceFlags": {"?": "010", "?": "16", "sky": "0X4"})");
    EXPECT_EQ(Pack().shaders[1].surfaceFlags, 8u | 16u | 4u);
}

TEST_F(PackJsonTest, FlagNamesOfTheGameReplaceValuesOnRequest) {
    Unpack(SmallBsp());
    folder_.Edit("shaders.json", R"("surfaceFlags": {})",
                 R"("surfaceFlags": {"SKY": "0x1", "new": "0x2", "ob": "64"})");
    EXPECT_EQ(Pack({.useFlagNames = true}).shaders[1].surfaceFlags, 4u | 2u);
    EXPECT_THAT(log_.text, HasSubstr("game quake3 has no flag new"));
    EXPECT_EQ(Pack({.useFlagNames = true, .dropUnknownFlags = true}).shaders[1].surfaceFlags, 4u);
}

TEST_F(PackJsonTest, EveryMissingFileIsNamed) {
    Unpack(SmallBsp());
    for (const std::string &file : folder_.Files()) {
        const std::string text = folder_.Text(file);
        std::filesystem::remove(folder_.Path() / file);
        EXPECT_THAT(PackError(), HasSubstr(kSeparator + file + ": cannot read: "));
        folder_.Put(file, text);
    }
}

struct BadEdit {
    std::string_view file, from, to, message;
};

class PackJsonErrors : public PackJsonTest, public testing::WithParamInterface<BadEdit> {};

TEST_P(PackJsonErrors, NameFileMemberAndExpectation) {
    const BadEdit &edit = GetParam();
    Unpack(FullBsp(GridSHContainer::Bspx));
    folder_.Edit(edit.file, edit.from, edit.to);
    const std::string message = PackError();
    EXPECT_THAT(message, HasSubstr(edit.message));
    EXPECT_EQ(message.find('\n'), std::string::npos);
}

constexpr std::string_view kFirstPlane = "[1.0, 0.0, 0.0, 64.0]";

INSTANTIATE_TEST_SUITE_P(
    Edits, PackJsonErrors,
    testing::Values(
        BadEdit{"planes.json", kFirstPlane, "[1.0, 0.0, 0.0]", "planes.json: plane#0: expected 4 numbers"},
        BadEdit{"planes.json", kFirstPlane, "[1, 0, 0, 64, 0]", "planes.json: plane#0: expected 4 numbers"},
        BadEdit{"planes.json", kFirstPlane, "{}", "planes.json: plane#0: expected 4 numbers"},
        BadEdit{"planes.json", kFirstPlane, "[1, 0, 0, \"64\"]", "planes.json: plane#0: expected 4 numbers"},
        BadEdit{"planes.json", kFirstPlane, "[1, 0, 0, 1e39]", "planes.json: plane#0: expected 4 numbers"},
        BadEdit{"planes.json", kFirstPlane, "[1, 0, 0, 1e999]", "planes.json: at or after plane#0: not valid JSON"},
        BadEdit{"planes.json", kFirstPlane, "[1,, 0, 0, 1]", "planes.json: at or after plane#0: not valid JSON"},
        BadEdit{"planes.json", kFirstPlane, "[1 0, 0, 1]", "planes.json: at or after plane#0: not valid JSON"},
        BadEdit{"planes.json", kFirstPlane, "[,]", "planes.json: at or after plane#0: not valid JSON"},
        BadEdit{"planes.json", kFirstPlane, "[Nan, 0, 0, 1]", "planes.json: at or after plane#0: not valid JSON"},
        BadEdit{"planes.json", kFirstPlane, "[NaN, 0, 0, 1]", "plane 0: normal"},
        BadEdit{"planes.json", kFirstPlane, "/* [", "planes.json: a comment is opened with /* and never closed"},
        BadEdit{"leafs.json", "\"mins\": [64, 0, 0]", "\"mins\": [64.0, 0, 0]",
                "leafs.json: leaf#1: minmax.mins: expected 3 integers in -2147483648..2147483647"},
        BadEdit{"leafs.json", "\"mins\": [64, 0, 0]", "\"min\": 0", "leafs.json: leaf#1: minmax.mins: missing"},
        BadEdit{"nodes.json", "\"minmax\"", "\"minmax\": 1, \"x\"", "nodes.json: node#0: minmax: expected an object"},
        BadEdit{"nodes.json", "\"planeNum\": 0", "\"planeNum\": 2147483648",
                "nodes.json: node#0: planeNum: expected an integer in -2147483648..2147483647"},
        BadEdit{"nodes.json", "\"planeNum\": 0", "\"planeNum\": 99999999999999999999999", "planeNum: expected an int"},
        BadEdit{"nodes.json", "\"planeNum\": 0", "\"planeNum\": 0, \"planeNum\": 1", "planeNum is given twice"},
        BadEdit{"nodes.json", "\"planeNum\": 0", "\"planeNum\": 12", "node 0: planeNum 12"},
        BadEdit{"nodes.json", "{\n    \"node#0\": {", "{\"node#1\": 5, \"node#0\": {", "node#1: expected an object"},
        BadEdit{"LeafBrushes.json", "0\n", "\"0\"\n", "LeafBrush#0: Num: expected an integer"},
        BadEdit{"VisBytes.json", "8\n", "256\n", "VisBytes.json: VisByte#4: Num: expected an integer in 0..255"},
        BadEdit{"VisBytes.json", "8\n", "-1\n", "VisBytes.json: VisByte#4: Num: expected an integer in 0..255"},
        BadEdit{"GridPoints.json", "[15, 16]", "[15, 256]", "GridPoint#1: latLong: expected 2 integers in 0..255"},
        BadEdit{"DrawVert.json", "[[0.1, 0.25]", "[[0.1]", "DrawVert#2: lightmap: expected 4 x 2 numbers"},
        BadEdit{"DrawVert.json", "[[0.1, 0.25]", "[0.1", "DrawVert#2: lightmap: expected 4 x 2 numbers"},
        BadEdit{"DrawVert.json", "[[0.1, 0.25]", "[[[0.1], 0.25]", "DrawVert#2: lightmap: expected 4 x 2 numbers"},
        BadEdit{"DrawVert.json", "[[0.1, 0.25]", "[[[[[[[[[[[[[[[[[[[[[0.1, 0.25]", "nested deeper than"},
        BadEdit{"DrawVert.json", "\"st\": [1.0, 1.0]",
                "\"st\": [NaN, 1.0], \"nanBits\": [\"0x7fc00001\", \"0xffc00000\"]",
                "DrawVert#2: nanBits: expected 1 entries, one for every NaN of the record, found 2"},
        BadEdit{"DrawVert.json", "\"st\": [1.0, 1.0]", "\"st\": [NaN, 1.0], \"nanBits\": [\"0x3f800000\"]",
                "DrawVert#2: nanBits: expected the bits of a NaN"},
        BadEdit{"DrawVert.json", "\"st\": [1.0, 1.0]", "\"st\": [NaN, 1.0], \"nanBits\": 1",
                "DrawVert#2: nanBits: expected an array"},
        BadEdit{"fogs.json", "\"textures/fog\"", "7", "fogs.json: fog#0: shader: expected a string"},
        BadEdit{"fogs.json", "textures/fog", "a\\u0000b", "fogs.json: fog#0: shader: expected a name without NUL"},
        BadEdit{"fogs.json", "textures/fog", "0123456789012345678901234567890123456789012345678901234567890123",
                "fogs.json: fog#0: shader: expected at most 63 bytes, found 64"},
        BadEdit{"fogs.json", "\"visibleSide\"", "\"shaderBytes\": \"00\", \"visibleSide\"",
                "fogs.json: fog#0: shaderBytes: expected 128 hexadecimal digits"},
        BadEdit{"shaders.json", "\"surfaceFlags\": {}", "\"surfaceFlags\": []", "surfaceFlags: expected an object"},
        BadEdit{"shaders.json", "\"0x00000c00\"", "3072", "surfaceFlags: pointlight: expected a number in quotes"},
        BadEdit{"shaders.json", "\"0x00000c00\"", "\"0xc00z\"", "surfaceFlags: pointlight: expected a number"},
        BadEdit{"shaders.json", "\"0x00000c00\"", "\"0x100000000\"", "surfaceFlags: pointlight: expected a number"},
        BadEdit{"entities.json", "[\"classname\", \"light\"]", "[\"classname\"]", "entity#1: KeyValue: expected 2 str"},
        BadEdit{"entities.json", "[\"classname\", \"light\"]", "[\"a\", 1]", "entity#1: KeyValue: expected 2 strings"},
        BadEdit{"entities.json", "\"light\"", "\"li\\\"ght\"", "entity text cannot hold a quote"},
        BadEdit{"entities.json", "{\n    \"entity#0\"", "[1] {\n    \"entity#0\"", "entities.json: expected an object"},
        BadEdit{"GridPointsSH.json", "\"gridBounds\": [2, 1, 2]", "\"gridBounds\": [2, 1, 3]",
                "GridPointsSH.json: points: expected 2 x 1 x 3 points as gridBounds says, found 4"},
        BadEdit{"GridPointsSH.json", "\"gridBounds\": [2, 1, 2]",
                "\"gridBounds\": [2000000000, 2000000000, 2000000000]",
                "GridPointsSH.json: points: expected 2000000000 x"},
        BadEdit{"GridPointsSH.json", "\"gridBounds\": [2, 1, 2]", "\"gridBounds\": [2, -1, -2]",
                "header: gridBounds: expected 3 integers of at least 1"},
        BadEdit{"GridPointsSH.json", "\"gridSize\": [70.0", "\"gridSize\": [0.0", "gridSize[0]"},
        BadEdit{"GridPointsSH.json", "\"header\"", "\"head\"", "GridPointsSH.json: header: missing"},
        BadEdit{"GridPointsSH.json", "\"points\"", "\"point\"", "GridPointsSH.json: points: missing or empty"},
        BadEdit{"GridPointsSH.json", "[2.0, -0.0, 1e-7]", "[2.0, -0.0]",
                "GridPointsSH.json: points[2]: expected 9 x 3 numbers"},
        BadEdit{"GridPointsSH.json", "[2.0, -0.0, 1e-7]", "[2.0, -0.0, NaN]", "SH light grid: point 2: coeffs[0]"},
        BadEdit{"Advertisements.json", "\"cellId\": 7", "\"cellId\": 7.5", "Advertisement#0: cellId: expected an int"},
        BadEdit{"bspx.json", "\"00ab\"", "\"00a\"", "bspx#0: bytes: expected pairs of hexadecimal digits"},
        BadEdit{"bspx.json", "\"00ab\"", "\"00ag\"", "bspx#0: bytes: expected pairs of hexadecimal digits"},
        BadEdit{"bspx.json", "\"EMPTY\"", "\"RGBLIGHTING\"", "bspx#1: name: a lump RGBLIGHTING is already there"},
        BadEdit{"bspx.json", "\"EMPTY\"", "\"0123456789012345678901234\"", "bspx#1: name: expected at most 24 bytes"},
        BadEdit{"bspx.json", "\"EMPTY\"", "\"LIGHTGRID_SH\"", "bspx#1: expected the name LIGHTGRID_SH with the file"},
        BadEdit{"bspx.json", "\"GridPointsSH.json\"", "\"/etc/passwd\"",
                "bspx#2: expected the name LIGHTGRID_SH with"}));

TEST_F(PackJsonTest, AGridInBspxNeedsItsFile) {
    Unpack(FullBsp(GridSHContainer::Bspx));
    std::filesystem::remove(folder_.Path() / "GridPointsSH.json");
    EXPECT_THAT(PackError(), HasSubstr("bspx.json: bspx#2: file: there is no GridPointsSH.json"));
}

TEST_F(PackJsonTest, FilesCutShortAreErrors) {
    Bsp bsp = FullBsp(GridSHContainer::Bspx);
    bsp.lightmaps.clear();
    Unpack(bsp);
    for (const std::string &file : folder_.Files()) {
        const std::string text = folder_.Text(file);
        const std::size_t step = std::max<std::size_t>(text.size() / 60, 1);
        for (std::size_t length = 0; length < text.size(); length += step) {
            folder_.Put(file, text.substr(0, length));
            const std::string message = PackError();
            ASSERT_THAT(message, HasSubstr(kSeparator + file + ": ")) << length;
            ASSERT_EQ(message.find('\n'), std::string::npos) << message;
        }
        folder_.Put(file, text);
    }
}

TEST_F(PackJsonTest, ChangedBytesGiveAMapOrAnError) {
    Bsp bsp = FullBsp(GridSHContainer::Bspx);
    bsp.lightmaps.clear();
    bsp.drawVerts[2].st[0] = std::bit_cast<float>(0xFFC00000u);
    Unpack(bsp);
    std::uint32_t state = 12345;
    const auto random = [&state](std::size_t below) {
        state = state * 1664525u + 1013904223u;
        return std::size_t(state >> 8) % below;
    };
    constexpr std::string_view kBytes = "{}[],:\"\\/*-+eE.0129NIn \n\xE9\xFF";
    int maps = 0, errors = 0;
    for (const std::string &file : folder_.Files()) {
        const std::string text = folder_.Text(file);
        for (int i = 0; i < 60; i++) {
            std::string changed = text;
            for (std::size_t edits = 1 + random(3); edits > 0; edits--)
                changed[random(changed.size())] = kBytes[random(kBytes.size())];
            folder_.Put(file, changed);
            try {
                Pack();
                maps++;
            } catch (const Error &) {
                errors++;
            }
        }
        folder_.Put(file, text);
    }
    EXPECT_GT(maps, 20);
    EXPECT_GT(errors, 100);
    EXPECT_EQ(Bytes(Pack()), Bytes(bsp));
}

TEST_F(PackJsonTest, BlocksOfTheReaderDoNotShow) {
    // Texts of every length around the block size, so that tokens, escapes and commas fall on its border.
    for (std::size_t length = 65400; length < 65560; length += 7) {
        Bsp bsp = SmallBsp();
        bsp.entities = "{\n\"k\" \"" + std::string(length, 'a') + "\\\xE9\\\"\n\"NaN\" \"Inf\"\n}\n";
        ExpectSame(bsp);
    }
}

} // namespace

} // namespace q3::test
