// GPL-2.0-or-later. The SH grid that names lights as JSON.
#include "tests/convert/json/json_fixture.h"
#include "tests/support/named_grid.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view kNamedFile = "GridPointsSHLights.json";

Bsp NamedBsp() {
    Bsp bsp = SmallBsp();
    bsp.namedGridSH = SmallNamedGrid(3);
    return bsp;
}

class NamedJsonTest : public JsonTest {
  protected:
    std::string Fault(std::string_view from, std::string_view to) {
        return JsonTest::FaultAfter(NamedBsp(), kNamedFile, from, to);
    }
};

TEST_F(NamedJsonTest, GivesTheSameBytes) {
    Bsp bsp = NamedBsp();
    ExpectSame(bsp);
    const std::string text = Text(kNamedFile);
    EXPECT_THAT(text, AllOf(HasSubstr("\"type\": \"polygons\""), HasSubstr("\"curve\": \"windowed\""),
                            HasSubstr("\"name\": \"lamp \\\"2\\\"\""), HasSubstr("\"name\": \"lamp\xe9\"")));
    EXPECT_EQ(text.find("spread"), text.rfind("spread")) << "only the sun has one";
    NamedGridSH &grid = *bsp.namedGridSH;
    grid.table.lights[0].spread = -0.0f; // what its type does not need
    grid.table.lights[6].curve = SHGRID_POLYNOMIAL, grid.table.lights[6].flags = 3;
    grid.table.lights[6].firstPolygon = 1, grid.table.lights[7].fade = 7;
    grid.points[3].steps[7] = -128;
    ExpectSame(bsp);
    EXPECT_TRUE(std::filesystem::exists(folder_.Path() / kNamedFile));
}

TEST_F(NamedJsonTest, ListsMayBeEmpty) {
    Bsp bsp = NamedBsp();
    NamedGridSH &grid = *bsp.namedGridSH;
    grid.table = {}, grid.names.clear(), grid.shares.clear(), grid.points.clear();
    grid.nodes[0].stored = 0, grid.nodes[0].nameCount = 0;
    NumberNamedNodes(grid);
    ExpectSame(bsp);
}

TEST_F(NamedJsonTest, TablesInAnotherOrderStayInHexadecimal) {
    Bsp bsp = NamedBsp();
    bsp.namedGridSH->table.lights[0].name = bsp.namedGridSH->table.lights[1].name;
    ExpectSame(bsp);
    EXPECT_FALSE(std::filesystem::exists(folder_.Path() / kNamedFile));
    bsp = NamedBsp();
    std::swap(bsp.namedGridSH->table.polygons[0], bsp.namedGridSH->table.polygons[1]);
    ExpectSame(bsp);
    EXPECT_FALSE(std::filesystem::exists(folder_.Path() / kNamedFile));
}

TEST_F(NamedJsonTest, FaultsNameTheFileAndTheMember) {
    EXPECT_THAT(Fault("\"levels\": 1", "\"levels\": 13"), AllOf(HasSubstr(kNamedFile), HasSubstr("number of levels")));
    EXPECT_THAT(Fault("\"levels\": 1", "\"levels\": 1.0"), HasSubstr("header: levels: expected an integer"));
    EXPECT_THAT(Fault("\"windowed\"", "\"steep\""),
                AllOf(HasSubstr(kNamedFile), HasSubstr("lights[2]: curve: expected one of: inverseSquare, linear")));
    EXPECT_THAT(Fault("\"spot\"", "7"), HasSubstr("lights[4]: type: expected a string"));
    EXPECT_THAT(Fault("\"spot\"", "\"moon\""), HasSubstr("lights[4]: type: expected one of: point, spot, sun"));
    EXPECT_THAT(Fault("\"spread\"", "\"spred\""), HasSubstr("lights[6]: spread: missing"));
    EXPECT_THAT(Fault("\"style\": 15", "\"style\": 64"), HasSubstr("lights[3]: style: expected an integer in 0..63"));
    EXPECT_THAT(Fault("\"intensity\": 9000.0", "\"intensity\": Infinity"), HasSubstr("lights[0]: expected finite"));
    EXPECT_THAT(Fault("\"twoSided\": 1", "\"twoSided\": 2"), HasSubstr("lights[7]: twoSided: expected 0 or 1"));
    EXPECT_THAT(Fault("\"polygonCount\": 1", "\"polygonCount\": -1"),
                HasSubstr("lights[7]: polygonCount: expected an integer of at least 0"));
    EXPECT_THAT(Fault("\"polygonCount\": 1", "\"polygonCount\": 3"), HasSubstr("a light that the grid names"));
    EXPECT_THAT(Fault("\"name\": \"sun\"", "\"name\": \"s\\u0000n\""), HasSubstr("lights[6]: name: expected text"));
    EXPECT_THAT(Fault("\"name\": \"sun\"", "\"title\": \"sun\""), HasSubstr("lights[6]: name: missing"));
    EXPECT_THAT(Fault("\"area\": ", "\"area\": NaN, \"x\": "), HasSubstr("polygons[0]: expected finite"));
    EXPECT_THAT(Fault("[[-72.0, ", "[[\"a\", "), HasSubstr("polygons[0]: vertices: expected positions of 3 finite"));
    EXPECT_THAT(Fault("[[-72.0, ", "[[1.0, -72.0, "), HasSubstr("polygons[0]: vertices: expected positions of 3"));
    EXPECT_THAT(Fault("\"vertices\"", "\"corners\""), HasSubstr("polygons[0]: vertices: expected an array of 3 to 64"));
    EXPECT_THAT(Fault("[0, 255, 0, 0, 1,", "[0, 256, 0, 0, 1,"), HasSubstr("nodes[0]: expected masks in 0..255"));
    EXPECT_THAT(Fault("[0, 255, 0, 0, 1,", "[0, 255, 0, 9, 1,"), HasSubstr("nodes[0]: names light 9, but there are 9"));
    EXPECT_THAT(Fault("[0, 255, 0, 0, 1,", "[0, 255, 0, 1,"), HasSubstr("points[0]: expected 8 shares as nodes[0]"));
    EXPECT_THAT(Fault("[0, 255, 0, 0, 1,", "[0, 127, 0, 0, 1,"), HasSubstr("points: expected 7 points"));
    EXPECT_THAT(Fault("255, 235, 215, 195,", "256, 235, 215, 195,"), HasSubstr("points[0]: expected shares in 0..255"));
    EXPECT_THAT(Fault("255, 235, 215, 195,", "255, 235, 215.0, 195,"), HasSubstr("points[0]: expected shares in"));
    EXPECT_THAT(Fault("\"points\"", "\"others\""),
                HasSubstr("points[0]: expected 9 shares as nodes[0] has names, found no point"));
    EXPECT_THAT(Fault("\"nodes\": [", "\"nodes\": 1, \"x\": ["), HasSubstr("nodes: expected an array"));
    EXPECT_THAT(Fault("\"nodes\"", "\"others\""), HasSubstr("header or nodes: missing or empty"));
}

} // namespace

} // namespace q3::test
