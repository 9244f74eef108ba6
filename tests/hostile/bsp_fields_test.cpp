// GPL-2.0-or-later. Every field that a damaged file may hold: refused with a message that names it.
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;
using testing::StartsWith;

namespace {

constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

struct Damage {
    void (*apply)(Bsp &);
    const char *message;
};

/// Both ways: the records as they are, and the file that holds them.
void ExpectErrors(const std::vector<Damage> &cases) {
    for (const Damage &damage : cases) {
        Bsp bsp = SampleBsp();
        damage.apply(bsp);
        KeptLog listener;
        const std::string expected = std::string("x.bsp: ") + damage.message;
        EXPECT_THAT(ErrorOf([&] { ValidateBsp(bsp, "x.bsp", listener.log); }), StartsWith(expected));
        const BspFormat format{.version = 47, .advertisements = true};
        EXPECT_THAT(ErrorOf([&] { ReadBsp(WriteBsp(bsp, format), "x.bsp", format, listener.log); }),
                    StartsWith(expected));
    }
}

void ExpectWarning(void (*apply)(Bsp &), const char *message) {
    Bsp bsp = SampleBsp();
    apply(bsp);
    KeptLog listener;
    const auto file = WriteBsp(bsp, {});
    const Bsp back = ReadBsp(file, "x.bsp", {}, listener.log);
    EXPECT_THAT(listener.text, HasSubstr(message));
    EXPECT_EQ(WriteBsp(back, {}), file) << message;
}

} // namespace

TEST(Damage, TheSampleItselfIsClean) {
    KeptLog listener;
    ValidateBsp(SampleBsp(), "x.bsp", listener.log);
    EXPECT_EQ(listener.text, "");
}

TEST(Damage, RequiredLumps) {
    ExpectErrors({{[](Bsp &b) { b.shaders.clear(); }, "the map has no shaders"},
                  {[](Bsp &b) { b.planes.clear(); }, "the map has no planes"},
                  {[](Bsp &b) { b.nodes.clear(); }, "the map has no nodes"},
                  {[](Bsp &b) { b.leafs.clear(); }, "the map has no leafs"},
                  {[](Bsp &b) { b.models.clear(); }, "the map has no models"}});
}

TEST(Damage, PlanesAndNodes) {
    ExpectErrors({{[](Bsp &b) { b.planes[3].normal[1] = kNoNumber; }, "plane 3: normal"},
                  {[](Bsp &b) { b.planes[3].normal = {}; }, "plane 3: normal is zero"},
                  {[](Bsp &b) { b.planes[4].dist = kInf; }, "plane 4: dist inf"},
                  {[](Bsp &b) { b.nodes[1].planeNum = 12; }, "node 1: planeNum 12 is outside 0..11"},
                  {[](Bsp &b) { b.nodes[1].planeNum = -1; }, "node 1: planeNum -1"},
                  {[](Bsp &b) { b.nodes[0].children[1] = 2; }, "node 0: child 2 is outside 0..1"},
                  {[](Bsp &b) { b.nodes[0].children[0] = -5; }, "node 0: child -5 is leaf 4 of 4 leafs"},
                  {[](Bsp &b) { b.nodes[0].children[0] = INT32_MIN; }, "node 0: child -2147483648 is leaf 2147483647"},
                  {[](Bsp &b) { b.nodes[1].children[0] = 0; }, "node 0: two children refer to it"},
                  {[](Bsp &b) { b.nodes[1].children[0] = 1; }, "node 1: two children refer to it"},
                  {[](Bsp &b) { b.nodes[0].children[0] = 1; }, "node 1: two children refer to it"}});
}

TEST(Damage, TreesMayBeDeepButNotDeeperThan4096) {
    const auto chain = [](int nodes) {
        Bsp bsp = SampleBsp();
        bsp.nodes.assign(std::size_t(nodes), bsp.nodes[0]);
        for (int i = 0; i < nodes; i++)
            bsp.nodes[std::size_t(i)].children = {-2, i + 1 < nodes ? i + 1 : -3};
        KeptLog listener;
        return ErrorOf([&] { ValidateBsp(bsp, "x.bsp", listener.log); });
    };
    EXPECT_EQ(chain(4096), "no error");
    EXPECT_EQ(chain(4097), "x.bsp: node 4096: the tree is deeper than 4096 nodes");
    EXPECT_THAT(chain(1000000), HasSubstr("deeper than 4096"));
}

TEST(Damage, Leafs) {
    ExpectErrors({{[](Bsp &b) { b.leafs[3].cluster = 2; }, "leaf 3: cluster 2 is outside -1..1"},
                  {[](Bsp &b) { b.leafs[3].cluster = -2; }, "leaf 3: cluster -2"},
                  {[](Bsp &b) { b.visibility.clear(), b.leafs[3].cluster = 0x20000; }, "leaf 3: cluster 131072"},
                  {[](Bsp &b) { b.leafs[3].area = 256; }, "leaf 3: area 256"},
                  {[](Bsp &b) { b.leafs[3].area = -2; }, "leaf 3: area -2"},
                  {[](Bsp &b) { b.leafs[1].firstBSPLeafSurface = 1; },
                   "leaf 1: firstBSPLeafSurface 1 + numBSPLeafSurfaces 4 exceeds 4 leaf surfaces"},
                  {[](Bsp &b) { b.leafs[1].firstBSPLeafSurface = -1; }, "leaf 1: firstBSPLeafSurface -1"},
                  {[](Bsp &b) { b.leafs[1].numBSPLeafSurfaces = -1; }, "leaf 1: numBSPLeafSurfaces -1"},
                  {[](Bsp &b) { b.leafs[2].firstBSPLeafBrush = INT32_MAX; },
                   "leaf 2: firstBSPLeafBrush 2147483647 + numBSPLeafBrushes 2 exceeds 2 leaf brushes"},
                  {[](Bsp &b) { b.leafs[2].firstBSPLeafBrush = -1; }, "leaf 2: firstBSPLeafBrush -1"},
                  {[](Bsp &b) { b.leafs[2].numBSPLeafBrushes = INT32_MIN; }, "leaf 2: numBSPLeafBrushes -2147483648"},
                  {[](Bsp &b) { b.leafSurfaces[2] = 4; }, "leaf surface 2: value 4"},
                  {[](Bsp &b) { b.leafSurfaces[2] = -1; }, "leaf surface 2: value -1"},
                  {[](Bsp &b) { b.leafBrushes[1] = 2; }, "leaf brush 1: value 2"},
                  {[](Bsp &b) { b.leafBrushes[1] = -1; }, "leaf brush 1: value -1"}});
}

TEST(Damage, ModelsBrushesAndFogs) {
    ExpectErrors({{[](Bsp &b) { b.models[0].firstBSPSurface = -1; }, "model 0: firstBSPSurface -1"},
                  {[](Bsp &b) { b.models[0].numBSPSurfaces = 5; }, "model 0: firstBSPSurface 0 + numBSPSurfaces 5"},
                  {[](Bsp &b) { b.models[1].firstBSPBrush = 2; }, "model 1: firstBSPBrush 2 + numBSPBrushes 1"},
                  {[](Bsp &b) { b.models[1].numBSPBrushes = -1; }, "model 1: numBSPBrushes -1"},
                  {[](Bsp &b) { b.models[1].mins[2] = kNoNumber; }, "model 1: mins[2] nan"},
                  {[](Bsp &b) { b.models[0].maxs[1] = kInf; }, "model 0: maxs[1] inf"},
                  {[](Bsp &b) { b.models[0].mins[0] = 65; }, "model 0: mins[0] 65 is above maxs[0] 64"},
                  {[](Bsp &b) { b.brushes[1].firstSide = 7; }, "brush 1: firstSide 7 + numSides 6 exceeds 12 sides"},
                  {[](Bsp &b) { b.brushes[1].firstSide = -6; }, "brush 1: firstSide -6"},
                  {[](Bsp &b) { b.brushes[1].numSides = 5; }, "brush 1: numSides 5 is under 6"},
                  {[](Bsp &b) { b.brushes[1].numSides = -1; }, "brush 1: numSides -1"},
                  {[](Bsp &b) { b.brushes[1].shaderNum = 2; }, "brush 1: shaderNum 2"},
                  {[](Bsp &b) { b.brushSides[7].planeNum = 12; }, "brush side 7: planeNum 12"},
                  {[](Bsp &b) { b.brushSides[7].shaderNum = -1; }, "brush side 7: shaderNum -1"},
                  {[](Bsp &b) { b.fogs[0].brushNum = 2; }, "fog 0: brushNum 2"},
                  {[](Bsp &b) { b.fogs[0].brushNum = -2; }, "fog 0: brushNum -2"},
                  {[](Bsp &b) { b.fogs[0].visibleSide = 6; }, "fog 0: visibleSide 6"},
                  {[](Bsp &b) { b.fogs[0].visibleSide = -2; }, "fog 0: visibleSide -2"}});
}

TEST(Damage, Surfaces) {
    ExpectErrors({{[](Bsp &b) { b.drawVerts[6].xyz[2] = kNoNumber; }, "draw vert 6: xyz 32 0 nan is not finite"},
                  {[](Bsp &b) { b.drawVerts[6].normal[0] = kInf; }, "draw vert 6: normal inf"},
                  {[](Bsp &b) { b.drawSurfaces[3].shaderNum = 2; }, "surface 3: shaderNum 2"},
                  {[](Bsp &b) { b.drawSurfaces[3].fogNum = 1; }, "surface 3: fogNum 1"},
                  {[](Bsp &b) { b.drawSurfaces[3].fogNum = -2; }, "surface 3: fogNum -2"},
                  {[](Bsp &b) { b.drawSurfaces[3].surfaceType = 6; }, "surface 3: surfaceType 6"},
                  {[](Bsp &b) { b.drawSurfaces[3].surfaceType = -1; }, "surface 3: surfaceType -1"},
                  {[](Bsp &b) { b.drawSurfaces[2].firstVert = 14; }, "surface 2: firstVert 14 + numVerts 3 exceeds 16"},
                  {[](Bsp &b) { b.drawSurfaces[2].firstVert = -1; }, "surface 2: firstVert -1"},
                  {[](Bsp &b) { b.drawSurfaces[2].numVerts = -3; }, "surface 2: numVerts -3"},
                  {[](Bsp &b) { b.drawSurfaces[2].firstIndex = 4; }, "surface 2: firstIndex 4 + numIndexes 3"},
                  {[](Bsp &b) { b.drawSurfaces[2].firstIndex = -1; }, "surface 2: firstIndex -1"},
                  {[](Bsp &b) { b.drawSurfaces[2].numIndexes = -1; }, "surface 2: numIndexes -1"},
                  {[](Bsp &b) { b.drawSurfaces[2].numIndexes = 2; }, "surface 2: numIndexes 2 is not a multiple of 3"},
                  {[](Bsp &b) { b.drawIndexes[5] = 4; }, "surface 0: index 5 of its 6 is 4, but numVerts is 4"},
                  {[](Bsp &b) { b.drawIndexes[5] = -1; }, "surface 0: index 5 of its 6 is -1"},
                  {[](Bsp &b) { b.drawSurfaces[2].firstIndex = 3; }, "surface 2: index 2 of its 3 is 3"},
                  {[](Bsp &b) { b.drawSurfaces[1].patchWidth = 4; }, "surface 1: patchWidth 4"},
                  {[](Bsp &b) { b.drawSurfaces[1].patchHeight = 1; }, "surface 1: patchHeight 1"},
                  {[](Bsp &b) { b.drawSurfaces[1].patchWidth = 33; }, "surface 1: patchWidth 33"},
                  {[](Bsp &b) { b.drawSurfaces[1].patchWidth = INT32_MIN; }, "surface 1: patchWidth -2147483648"},
                  {[](Bsp &b) { b.drawSurfaces[1].patchWidth = 5; }, "surface 1: patchWidth 5 x patchHeight 3 is not"},
                  {[](Bsp &b) { b.drawSurfaces[0].lightmapOrigin[1] = kNoNumber; }, "surface 0: lightmapOrigin"},
                  {[](Bsp &b) { b.drawSurfaces[0].lightmapVecs[2][0] = kInf; }, "surface 0: lightmapVecs"}});
}

TEST(Damage, VisibilityAndAdvertisements) {
    ExpectErrors({{[](Bsp &b) { b.visibility.resize(7); }, "visibility: 7 bytes, expected 0 or at least 8"},
                  {[](Bsp &b) { b.visibility[3] = 0x80; }, "visibility: -2147483646 clusters"},
                  {[](Bsp &b) { b.visibility[4] = 0; }, "visibility: 0 bytes per row, expected at least 1"},
                  {[](Bsp &b) { b.visibility[7] = 0xff; }, "visibility: -16777208 bytes per row"},
                  {[](Bsp &b) { b.visibility[0] = 3; }, "visibility: 3 rows of 8 bytes exceed the 24 bytes"},
                  {[](Bsp &b) { b.visibility[7] = 0x7f; }, "visibility: 2 rows of 2130706440 bytes exceed"},
                  {[](Bsp &b) {
                       b.advertisements = {SampleAdvertisement()};
                       b.advertisements[0].normal[1] = kNoNumber;
                   },
                   "advertisement 0: normal"},
                  {[](Bsp &b) {
                       b.advertisements = {SampleAdvertisement()};
                       b.advertisements[0].rect[3][2] = kInf;
                   },
                   "advertisement 0: rect"}});
}

TEST(Damage, LightGridSH) {
    const auto damaged = [](void (*apply)(LightGridSH &)) {
        Bsp bsp = SampleBsp();
        bsp.gridSH = SampleGridSH();
        apply(*bsp.gridSH);
        KeptLog listener;
        const std::string text = ErrorOf([&] { ValidateBsp(bsp, "x.bsp", listener.log); });
        EXPECT_NE(ErrorOf([&] { WriteBsp(bsp, {}); }), "no error");
        return text;
    };
    EXPECT_THAT(damaged([](LightGridSH &g) { g.header.gridMins[1] = kNoNumber; }), HasSubstr("gridMins[1] is nan"));
    EXPECT_THAT(damaged([](LightGridSH &g) { g.header.gridSize[2] = 0; }), HasSubstr("gridSize[2] is 0"));
    EXPECT_THAT(damaged([](LightGridSH &g) { g.header.gridSize[0] = kInf; }), HasSubstr("gridSize[0] is inf"));
    EXPECT_THAT(damaged([](LightGridSH &g) { g.header.gridBounds[0] = 0; }), HasSubstr("gridBounds[0] is 0"));
    EXPECT_THAT(damaged([](LightGridSH &g) { g.header.gridBounds = {-2, -3, 1}; }), HasSubstr("gridBounds[0] is -2"));
    EXPECT_THAT(damaged([](LightGridSH &g) { g.header.numPoints = 7; }), HasSubstr("numPoints is 7"));
    EXPECT_THAT(damaged([](LightGridSH &g) { g.header.gridBounds = {65536, 65536, 65536}; }), HasSubstr("numPoints"));
    EXPECT_THAT(damaged([](LightGridSH &g) {
                    g.header.gridBounds = {INT32_MAX, INT32_MAX, INT32_MAX};
                }),
                HasSubstr("numPoints"));
    EXPECT_THAT(damaged([](LightGridSH &g) { g.points.pop_back(); }), HasSubstr("holds 5 points"));
    EXPECT_THAT(damaged([](LightGridSH &g) { g.points[4].coeffs[8][2] = kNoNumber; }), HasSubstr("point 4: coeffs[8]"));
}

TEST(Damage, ASmallFileCannotStandForAHugeMap) {
    // A thousand surfaces of a few bytes that all use one long run of indexes or verts.
    Bsp bsp = SampleBsp();
    bsp.drawIndexes.assign(300000, 0);
    bspDrawSurface_t surface = bsp.drawSurfaces[0];
    surface.numIndexes = 300000;
    bsp.drawSurfaces.insert(bsp.drawSurfaces.end(), 1000, surface);
    KeptLog listener;
    EXPECT_THAT(ErrorOf([&] { ValidateBsp(bsp, "x.bsp", listener.log); }),
                HasSubstr("surfaces: the sum of numIndexes is 300000009"));
    bsp = SampleBsp();
    bsp.leafs.resize(5000, bsp.leafs[1]);
    EXPECT_THAT(ErrorOf([&] { ValidateBsp(bsp, "x.bsp", listener.log); }),
                HasSubstr("leafs: the sum of numBSPLeafSurfaces is"));
}

TEST(Damage, NumbersOfPagesBesideTheFileAreNone) {
    Bsp bsp = SampleBsp();
    bsp.lightmaps.clear();
    bsp.drawSurfaces[0].lightmapNum[0] = 3;
    KeptLog listener;
    ReadBsp(WriteBsp(bsp, {}), "x.bsp", {}, listener.log);
    EXPECT_EQ(listener.text, "");
}

TEST(Damage, OdditiesThatGoOnAreWarningsAndStay) {
    ExpectWarning(
        [](Bsp &b) {
            b.lightmaps.resize(3 * 128 * 128 * 3);
            b.drawSurfaces[0].lightmapNum[0] = 3;
        },
        "surface 0: lightmapNum 3");
    ExpectWarning([](Bsp &b) { b.drawSurfaces[0].lightmapNum[0] = -5; }, "surface 0: lightmapNum -5");
    ExpectWarning([](Bsp &b) { b.drawSurfaces[0].lightmapWidth = 129; }, "lightmap rectangle");
    ExpectWarning([](Bsp &b) { b.drawSurfaces[0].lightmapX[0] = INT32_MAX; }, "lightmap rectangle");
    ExpectWarning([](Bsp &b) { b.leafs[3].area = -1; }, "leaf 3: cluster 1, but area -1");
    ExpectWarning([](Bsp &b) { b.planes[11].normal[2] = -0.5f; }, "plane 11: normal has length 0.5");
    ExpectWarning([](Bsp &b) { b.brushSides[1].planeNum = 1; }, "brush 0: side 1 does not face +X");
    ExpectWarning([](Bsp &b) { b.gridPoints.pop_back(); }, "the light grid has 17 points, expected 3 x 3 x 2");
    ExpectWarning([](Bsp &b) { b.entities = "{\n\"gridsize\" \"0 64 64\"\n}\n"; }, "cell size 0 64 64");
    ExpectWarning([](Bsp &b) { b.entities = "{\n\"gridsize\" \"64 nan 64\"\n}\n"; }, "gridsize 64 nan 64");
    ExpectWarning([](Bsp &b) { b.entities = "{\n\"gridsize\" \"1e-30 64 64\"\n}\n"; }, "cannot be counted");
    ExpectWarning([](Bsp &b) { b.entities = "{\n\"model\" \"*2\"\n}\n"; }, "model *2 is not one of *1..*1");
    ExpectWarning([](Bsp &b) { b.entities = "{\n\"model\" \"*0\"\n}\n"; }, "model *0");
    ExpectWarning([](Bsp &b) { b.entities = "{\n\"model\" \"*99999999999\"\n}\n"; }, "model *99999999999");
    ExpectWarning([](Bsp &b) { b.entities = "{\n\"classname\"\n}\n"; }, "the key classname has no value");
}

TEST(Damage, OverlappingLumpsAreReadWithAWarning) {
    auto file = WriteBsp(SampleBsp(), {});
    SetInt(file, 8 + 8 * LUMP_LIGHTGRID, IntAt(file, 8 + 8 * LUMP_SHADERS));
    KeptLog listener;
    EXPECT_EQ(ReadBsp(file, "x.bsp", {}, listener.log).gridPoints.size(), 18u);
    EXPECT_THAT(listener.text, HasSubstr("overlaps"));
}
