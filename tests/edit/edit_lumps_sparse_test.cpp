// GPL-2.0-or-later. The sparse SH grid of maps that are merged, scaled and moved.
#include "q3map2/edit/merge_maps.h"
#include "q3map2/edit/scale_shift.h"
#include "tests/support/small_bsp.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

/// SmallBsp with a root of eight cells of 16 x 16 x 32 from (-64 8 0).
Bsp SparseBsp(float light) {
    Bsp bsp = SmallBsp();
    SparseGridTree tree{{-64, 8, 0}, {16, 16, 32}, {1, 1, 1}, 1, {{0, 0, 0, 255, 0, 0}}, {}};
    tree.values.resize(8);
    for (bspGridPointSH_t &value : tree.values)
        value.coeffs[0] = {light, light, light};
    bsp.sparseGridSH = PackSparseGrid(tree);
    return bsp;
}

TEST(SparseMove, CellsMoveWithTheMap) {
    KeptLog log;
    Bsp bsp = SparseBsp(1);
    ShiftMap(bsp, {64, -8, 16}, "map", log.log);
    ASSERT_TRUE(bsp.sparseGridSH);
    EXPECT_EQ(bsp.sparseGridSH->mins, (Float3{0, 0, 16}));
    EXPECT_EQ(bsp.sparseGridSH->cell, (Float3{16, 16, 32}));
    EXPECT_EQ(bsp.sparseGridSH->points, SparseBsp(1).sparseGridSH->points);
    EXPECT_FALSE(Bytes(bsp).empty());
}

TEST(SparseMove, CellsGrowWithTheMap) {
    KeptLog log;
    Bsp bsp = SparseBsp(1);
    ScaleMap(bsp, {.factors = {2, 4, 0.5}}, "map", log.log);
    ASSERT_TRUE(bsp.sparseGridSH);
    EXPECT_EQ(bsp.sparseGridSH->mins, (Float3{-128, 32, 0}));
    EXPECT_EQ(bsp.sparseGridSH->cell, (Float3{32, 64, 16}));
    EXPECT_NE(log.text.find("directions of the light grids"), std::string::npos);
}

TEST(SparseMove, MergedMapsHaveTheGridOfTheFirst) {
    KeptLog log;
    const Bsp main = SparseBsp(1), added = SparseBsp(0.5f);
    const Bsp merged = MergeMaps({main, "main"}, {added, "added"}, {.world = true}, log.log);
    EXPECT_EQ(merged.sparseGridSH, main.sparseGridSH);
}

} // namespace

} // namespace q3::test
