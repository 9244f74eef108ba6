// GPL-2.0-or-later. The text of the JSON files.
#include "common/error.h"
#include "q3map2/convert/game/game_flags.h"
#include "q3map2/convert/json/convert_json.h"
#include "q3map2/convert/json/convert_json_write.h"
#include "tests/support/small_bsp.h"

#include <gmock/gmock.h>

#include <bit>
#include <cstdlib>
#include <limits>
#include <random>

namespace q3::test {

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::StartsWith;

class UnpackJsonTest : public testing::Test {
  protected:
    void Unpack(const Bsp &bsp) { UnpackJson(bsp, Quake3(), folder_.Path(), log_.log); }
    std::string Text(std::string_view file) const { return folder_.Text(file); }

    TempFolder folder_;
    KeptLog log_;
};

std::string Spelled(float value) {
    std::string text;
    AppendJsonFloat(text, value);
    return text;
}

TEST(JsonFloat, KeepsToTheEstablishedStyle) {
    EXPECT_EQ(Spelled(0.0f), "0.0");
    EXPECT_EQ(Spelled(-0.0f), "-0.0");
    EXPECT_EQ(Spelled(1.0f), "1.0");
    EXPECT_EQ(Spelled(526.25f), "526.25");
    EXPECT_EQ(Spelled(0.1f), "0.1");
    EXPECT_EQ(Spelled(-0.70710677f), "-0.70710677");
    EXPECT_EQ(Spelled(1e-6f), "0.000001");
    EXPECT_EQ(Spelled(1e-7f), "1e-7");
    EXPECT_EQ(Spelled(1.5e-7f), "1.5e-7");
    EXPECT_EQ(Spelled(16777216.0f), "16777216.0");
    EXPECT_EQ(Spelled(1e20f), "100000000000000000000.0");
    EXPECT_EQ(Spelled(1e22f), "1e22");
    EXPECT_EQ(Spelled(std::numeric_limits<float>::max()), "3.4028235e38");
    EXPECT_EQ(Spelled(std::numeric_limits<float>::denorm_min()), "1e-45");
    EXPECT_EQ(Spelled(std::numeric_limits<float>::quiet_NaN()), "NaN");
    EXPECT_EQ(Spelled(std::numeric_limits<float>::infinity()), "Infinity");
    EXPECT_EQ(Spelled(-std::numeric_limits<float>::infinity()), "-Infinity");
}

TEST(JsonFloat, ReadsBackToTheSameBitsAndIsNeverAnInteger) {
    std::mt19937 random(1);
    for (int i = 0; i < 100000; i++) {
        const auto bits = std::uint32_t(random());
        const auto value = std::bit_cast<float>(bits);
        if (!std::isfinite(value))
            continue;
        const std::string text = Spelled(value);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(std::strtof(text.c_str(), nullptr)), bits) << text;
        ASSERT_NE(text.find_first_of(".e"), std::string::npos) << text;
        ASSERT_LE(text.size(), 26u);
    }
}

TEST(JsonString, EscapesOnlyWhatMustBe) {
    std::string text;
    AppendJsonString(text, "a\"b\\c/\b\t\n\f\r\x01\x1F\x7F\xE9");
    EXPECT_EQ(text, "\"a\\\"b\\\\c/\\b\\t\\n\\f\\r\\u0001\\u001F\x7F\xE9\"");
}

TEST(JsonFlags, AreSplitFromTheEndOfTheTable) {
    const auto surface = [](std::uint32_t value) { return SplitFlags(value, Quake3(), FlagKind::Surface); };
    EXPECT_TRUE(surface(0).empty());
    EXPECT_THAT(surface(0xC00), ElementsAre(Pair("pointlight", 0xC00u)));
    EXPECT_THAT(surface(0x400), ElementsAre(Pair("?", 0x400u)));
    EXPECT_THAT(surface(0x1281), ElementsAre(Pair("nodamage", 1u), Pair("nodraw", 0x80u), Pair("?", 0x200u),
                                             Pair("metalsteps", 0x1000u)));
    EXPECT_THAT(
        SplitFlags(0x800C0001, Quake3(), FlagKind::Content),
        ElementsAre(Pair("default", 1u), Pair("?", 0x40000u), Pair("?", 0x80000u), Pair("nodrop", 0x80000000u)));
}

TEST_F(UnpackJsonTest, WritesTheSeventeenFilesAndNoOther) {
    Unpack(SmallBsp());
    EXPECT_THAT(folder_.Files(),
                ElementsAre("BrushSides.json", "Brushes.json", "DrawIndexes.json", "DrawSurfaces.json", "DrawVert.json",
                            "GridPoints.json", "LeafBrushes.json", "LeafSurfaces.json", "LightBytes.json",
                            "VisBytes.json", "entities.json", "fogs.json", "leafs.json", "models.json", "nodes.json",
                            "planes.json", "shaders.json"));
}

TEST_F(UnpackJsonTest, ShadersAndEntities) {
    Unpack(SmallBsp());
    EXPECT_EQ(Text("shaders.json"), R"({
    "shader#0": {
        "shader": "textures/base/wall",
        "surfaceFlags": {
            "pointlight": "0x00000c00",
            "metalsteps": "0x00001000"
        },
        "contentFlags": {
            "default": "0x00000001"
        }
    },
    "shader#1": {
        "shader": "noshader",
        "surfaceFlags": {},
        "contentFlags": {
            "default": "0x00000001",
            "detail": "0x08000000"
        }
    }
})");
    EXPECT_EQ(Text("entities.json"), R"({
    "entity#0": {
        "KeyValue": ["classname", "worldspawn"],
        "KeyValue": ["message", "a \\ b"]
    },
    "entity#1": {
        "KeyValue": ["classname", "light"]
    }
})");
}

TEST_F(UnpackJsonTest, TreeAndModels) {
    Unpack(SmallBsp());
    EXPECT_EQ(Text("models.json"), R"({
    "model#0": {
        "minmax": {
            "mins": [0.0, 0.0, 0.0],
            "maxs": [100.0, 20.0, 30.0]
        },
        "firstBSPSurface": 0,
        "numBSPSurfaces": 1,
        "firstBSPBrush": 0,
        "numBSPBrushes": 1
    }
})");
    EXPECT_THAT(Text("planes.json"), StartsWith(R"({
    "plane#0": [1.0, 0.0, 0.0, 64.0],
    "plane#1": [-1.0, -0.0, -0.0, -64.0],
    "plane#2": [1.0, 0.0, 0.0, 0.0],
)"));
    EXPECT_THAT(Text("leafs.json"), HasSubstr(R"(    "leaf#2": {
        "cluster": -1,
        "area": -1,
        "minmax": {
            "mins": [0, 0, 0],
            "maxs": [64, 20, 30]
        },
        "firstBSPLeafSurface": 0,
        "numBSPLeafSurfaces": 0,
        "firstBSPLeafBrush": 0,
        "numBSPLeafBrushes": 1
    }
})"));
    EXPECT_EQ(Text("nodes.json"), R"({
    "node#0": {
        "planeNum": 0,
        "children": [-2, -3],
        "minmax": {
            "mins": [-8, -8, -8],
            "maxs": [108, 28, 38]
        }
    }
})");
}

TEST_F(UnpackJsonTest, ListsOfNumbers) {
    Unpack(FullBsp(GridSHContainer::Lump));
    const auto one = [](std::string_view prefix) {
        return fmt::format("{{\n    \"{}#0\": {{\n        \"Num\": 0\n    }}\n}}", prefix);
    };
    EXPECT_EQ(Text("LeafSurfaces.json"), one("LeafSurface"));
    EXPECT_EQ(Text("LeafBrushes.json"), one("LeafBrush"));
    EXPECT_THAT(Text("DrawIndexes.json"), HasSubstr("    \"DrawIndex#5\": {\n        \"Num\": 3\n    }\n}"));
    EXPECT_THAT(Text("VisBytes.json"), HasSubstr("    \"VisByte#4\": {\n        \"Num\": 8\n    },\n"));
    EXPECT_THAT(Text("LightBytes.json"), HasSubstr("    \"LightByte#49151\": {\n        \"Num\": 249\n    }\n}"));
}

TEST_F(UnpackJsonTest, BrushesAndFogs) {
    Unpack(SmallBsp());
    EXPECT_EQ(Text("Brushes.json"), R"({
    "Brush#0": {
        "firstSide": 0,
        "numSides": 6,
        "shaderNum": 0
    }
})");
    EXPECT_THAT(Text("BrushSides.json"), StartsWith(R"({
    "BrushSide#0": {
        "planeNum": 3,
        "shaderNum": 1,
        "surfaceNum": -1
    },
)"));
    EXPECT_EQ(Text("fogs.json"), R"({
    "fog#0": {
        "shader": "textures/fog",
        "brushNum": 0,
        "visibleSide": 5
    }
})");
}

TEST_F(UnpackJsonTest, SurfacesAndVertices) {
    Unpack(SmallBsp());
    EXPECT_EQ(Text("DrawSurfaces.json"), R"({
    "DrawSurface#0": {
        "shaderNum": 0,
        "fogNum": -1,
        "surfaceType": 1,
        "firstVert": 0,
        "numVerts": 4,
        "firstIndex": 0,
        "numIndexes": 6,
        "lightmapStyles": [0, 255, 255, 255],
        "vertexStyles": [0, 255, 255, 255],
        "lightmapNum": [-3, -3, -3, -3],
        "lightmapX": [0, 0, 0, 0],
        "lightmapY": [0, 0, 0, 0],
        "lightmapWidth": 0,
        "lightmapHeight": 0,
        "lightmapOrigin": [0.0, 0.0, 0.0],
        "lightmapVecs": [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],
        "patchWidth": 0,
        "patchHeight": 0
    }
})");
    EXPECT_THAT(Text("DrawVert.json"), HasSubstr(R"(    "DrawVert#2": {
        "xyz": [64.0, 64.0, 64.0],
        "st": [1.0, 1.0],
        "lightmap": [[0.1, 0.25], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]],
        "normal": [1.0, 0.0, 0.0],
        "color": [[1, 2, 3, 255], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0]]
    },
)"));
}

TEST_F(UnpackJsonTest, LightGrids) {
    Unpack(FullBsp(GridSHContainer::Bspx));
    EXPECT_THAT(Text("GridPoints.json"), HasSubstr(R"(    "GridPoint#1": {
        "ambient": [[9, 10, 11], [9, 10, 11], [9, 10, 11], [9, 10, 11]],
        "directed": [[12, 13, 14], [12, 13, 14], [12, 13, 14], [12, 13, 14]],
        "styles": [0, 255, 255, 255],
        "latLong": [15, 16]
    }
})"));
    std::string points;
    for (const std::string_view red : {"0.0", "1.0", "2.0", "3.0"}) {
        points += points.empty() ? "\n        [" : ",\n        [";
        for (int k = 0; k < 9; k++)
            points += red == "0.0" ? fmt::format("{}[0.0, 0.0, 0.0]", k ? ", " : "")
                                   : fmt::format("{}[{}, {}, 1e-7]", k ? ", " : "", red,
                                                 k == 8   ? "-1.0"
                                                 : k == 0 ? "-0.0"
                                                          : fmt::format("{}", -k / 8.0));
        points += ']';
    }
    EXPECT_EQ(Text("GridPointsSH.json"), R"({
    "header": {
        "gridMins": [0.0, 0.0, 0.0],
        "gridSize": [70.0, 32.0, 64.0],
        "gridBounds": [2, 1, 2]
    },
    "points": [)" + points + "\n    ]\n}");
}

TEST_F(UnpackJsonTest, AdvertisementsAndForeignLumps) {
    Unpack(FullBsp(GridSHContainer::Bspx));
    EXPECT_EQ(Text("Advertisements.json"), R"({
    "Advertisement#0": {
        "cellId": 7,
        "normal": [1.0, 0.0, 0.0],
        "rect": [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [7.0, 8.0, 9.0], [10.0, 11.0, 12.0]],
        "model": "*0"
    }
})");
    EXPECT_EQ(Text("bspx.json"), R"({
    "bspx#0": {
        "name": "RGBLIGHTING",
        "bytes": "00ab"
    },
    "bspx#1": {
        "name": "EMPTY",
        "bytes": ""
    },
    "bspx#2": {
        "name": "LIGHTGRID_SH",
        "file": "GridPointsSH.json"
    }
})");
}

TEST_F(UnpackJsonTest, EmptyLumpsAreEmptyObjects) {
    Bsp bsp = SmallBsp();
    bsp.gridPoints.clear();
    bsp.visibility.clear();
    Unpack(bsp);
    for (const std::string_view file : {"GridPoints.json", "VisBytes.json", "LightBytes.json"})
        EXPECT_EQ(Text(file), "{}") << file;
}

TEST_F(UnpackJsonTest, FilesOfAnEarlierMapDoNotSurvive) {
    Bsp full = FullBsp(GridSHContainer::Bspx);
    full.entities += "\n";
    Unpack(full);
    for (const std::string_view file : {"GridPointsSH.json", "Advertisements.json", "bspx.json", "entities.ent"})
        EXPECT_TRUE(folder_.Has(file)) << file;
    Unpack(SmallBsp());
    EXPECT_EQ(folder_.Files().size(), 17u);
}

TEST_F(UnpackJsonTest, OddBytesGetMembersOfTheirOwn) {
    Bsp bsp = SmallBsp();
    bsp.shaders[1].shader[20] = 'x';
    bsp.drawVerts[1].lightmap[0] = {std::bit_cast<float>(0xFFC00001u), std::numeric_limits<float>::quiet_NaN()};
    bsp.drawVerts[2].lightmap[0][0] = std::numeric_limits<float>::quiet_NaN();
    Unpack(bsp);
    EXPECT_THAT(Text("shaders.json"),
                HasSubstr("            \"detail\": \"0x08000000\"\n        },\n"
                          "        \"shaderBytes\": \"6e6f7368616465720000000000000000000000007800"));
    const std::string verts = Text("DrawVert.json");
    EXPECT_THAT(verts, HasSubstr("\"lightmap\": [[NaN, NaN], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]]"));
    EXPECT_THAT(verts, HasSubstr(",\n        \"nanBits\": [\"0xffc00001\", \"0x7fc00000\"]\n    },\n"));
    EXPECT_EQ(verts.find("nanBits"), verts.rfind("nanBits"));
}

TEST_F(UnpackJsonTest, AFailedWriteNamesTheFileAndLeavesNoPart) {
    std::filesystem::create_directories(folder_.Path() / "planes.json" / "occupied");
    try {
        Unpack(SmallBsp());
        FAIL() << "a folder was replaced by a file";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), HasSubstr("planes.json: cannot write: "));
    }
    EXPECT_FALSE(folder_.Has("planes.json.part"));
}

TEST_F(UnpackJsonTest, AFileInPlaceOfTheFolderIsAnError) {
    folder_.Put("file", "");
    try {
        UnpackJson(SmallBsp(), Quake3(), folder_.Path() / "file", log_.log);
        FAIL();
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), HasSubstr("file: "));
    }
}

} // namespace

} // namespace q3::test
