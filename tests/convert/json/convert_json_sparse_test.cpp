// GPL-2.0-or-later. The sparse SH grid as JSON and in -info.
#include "q3map2/convert/bsp_info.h"
#include "tests/convert/json/json_fixture.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

/// SmallBsp with a tree of two nodes and three points.
Bsp SparseBsp() {
    Bsp bsp = SmallBsp();
    SparseGridTree tree;
    tree.mins = {-0.0f, 32.5f, 1e-7f};
    tree.cell = {16, 16, 32};
    tree.roots = {1, 1, 1};
    tree.levels = 2;
    tree.nodes = {{0, 0, 1, 2, 0, 0}, {0, 0, 0, 0x81, 4, 0}};
    for (int i = 0; i < 3; ++i) {
        bspGridPointSH_t &value = tree.values.emplace_back();
        for (std::size_t k = 0; k < 9; ++k)
            value.coeffs[k] = {1, float(k) / -9, float(i)};
    }
    bsp.sparseGridSH = PackSparseGrid(tree);
    return bsp;
}

class SparseJsonTest : public JsonTest {
  protected:
    std::string FaultAfter(std::string_view file, std::string_view from, std::string_view to) {
        return JsonTest::FaultAfter(SparseBsp(), file, from, to);
    }
};

TEST_F(SparseJsonTest, GivesTheSameBytes) {
    Bsp bsp = SparseBsp();
    ExpectSame(bsp);
    EXPECT_THAT(Text("bspx.json"),
                HasSubstr("\"LIGHTGRID_SH_SPARSE\",\n        \"file\": \"GridPointsSHSparse.json\""));
    bsp.sparseGridSH->points[1].bands[5] = -128; // not what this program writes
    ExpectSame(bsp);
    bsp.sparseGridSH->points.clear();
    for (SparseGridNode &node : bsp.sparseGridSH->nodes)
        node.stored = 0, node.points = 0;
    ExpectSame(bsp);
    Unpack(SmallBsp());
    EXPECT_FALSE(std::filesystem::exists(folder_.Path() / "GridPointsSHSparse.json")) << "of the map before";
    EXPECT_EQ(Bytes(Pack()), Bytes(SmallBsp()));
}

TEST_F(SparseJsonTest, FaultsNameTheFileAndTheMember) {
    const std::string_view file = "GridPointsSHSparse.json";
    EXPECT_THAT(FaultAfter(file, "\"levels\": 2", "\"levels\": 13"),
                testing::AllOf(HasSubstr(file), HasSubstr("levels is 13, expected 1 to 12")));
    EXPECT_THAT(FaultAfter(file, "\"levels\": 2", "\"levels\": 1"), HasSubstr("node 0: inner is 1, expected 0"));
    EXPECT_THAT(FaultAfter(file, "129,", "256,"), HasSubstr("nodes: expected integers in 0..255"));
    EXPECT_THAT(FaultAfter(file, "129,", "129, 7,"), HasSubstr("nodes: expected an array of inner"));
    EXPECT_THAT(FaultAfter(file, "129,", "1,"), HasSubstr("3 points, but the nodes have 2"));
    EXPECT_THAT(FaultAfter(file, "[256, ", "[512, "), HasSubstr("points[0]"));
    EXPECT_THAT(FaultAfter(file, "[256, ", "[512, "), HasSubstr("expected three mantissas in 0..511"));
    EXPECT_THAT(FaultAfter(file, "\"nodes\"", "\"others\""), HasSubstr("header or nodes: missing or empty"));
    EXPECT_THAT(FaultAfter("bspx.json", file, "x.json"), HasSubstr("expected the file GridPointsSHSparse.json"));
}

TEST(SparseInfo, CountsPointsByTheSizeOfTheirCells) {
    KeptLog log;
    PrintBspInfo("x.bsp", SparseBsp(), 0, log.log);
    EXPECT_THAT(log.text, HasSubstr("        3 sparse SH grid       172\n")); // 64 + 2 x 12 + 3 x 28
    EXPECT_THAT(log.text, HasSubstr("2 nodes, 14.0 % of the bytes; 2 levels below 1 x 1 x 1 roots"));
    EXPECT_THAT(log.text, HasSubstr("        2   points of cells of 16 x 16 x 32: 66.7 %; 1 hanging, 5 without light"));
    EXPECT_THAT(log.text, HasSubstr("        1   points of cells of 32 x 32 x 64: 33.3 %; 0 hanging, 6 without light"));
}

} // namespace

} // namespace q3::test
