// GPL-2.0-or-later. Placement of the light grid, and the SH lump.
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;

TEST(Grid, PointsAreTheMultiplesOfTheCellInsideTheWorld) {
    const Float3 mins{-130, -64, 1}, maxs{200, 65, 1000}, size{64, 32, 128};
    const GridLayout grid = LayoutGrid(mins, maxs, size);
    EXPECT_EQ(grid.size, size);
    for (std::size_t axis = 0; axis < 3; axis++) {
        std::vector<float> inside;
        for (int k = -100; k <= 100; k++)
            if (const float at = float(k) * size[axis]; at >= mins[axis] && at <= maxs[axis])
                inside.push_back(at);
        EXPECT_EQ(grid.mins[axis], inside.front());
        EXPECT_EQ(grid.bounds[axis], int(inside.size()));
    }
    EXPECT_EQ(grid.Position(5, 4, 6), (Float3{192, 64, 896}));
    EXPECT_EQ(grid.Count(), 6 * 5 * 7);
}

TEST(Grid, OddCellsKeepSingleArithmetic) {
    // 3.7 is not a float: origin and count are those of the float next to it.
    const GridLayout grid = LayoutGrid({-10, -10, -10}, {10, 10, 10}, {3.7f, 3.7f, 3.7f});
    EXPECT_EQ(grid.mins[0], 3.7f * -2.0f);
    EXPECT_EQ(grid.bounds[0], 5);
}

TEST(Grid, AThinWorldStillHasOnePoint) {
    const GridLayout grid = LayoutGrid({10, 10, 10}, {50, 500, 100}, {64, 64, 128});
    EXPECT_EQ(grid.bounds, (Int3{1, 7, 1}));
    EXPECT_EQ(grid.Count(), 7);
}

TEST(Grid, AbsurdSizesAreErrors) {
    const Float3 mins{-1000, -1000, -1000}, maxs{1000, 1000, 1000};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    for (const float bad : {0.0f, -64.0f, nan, inf})
        EXPECT_THAT(ErrorOf([&] { LayoutGrid(mins, maxs, {64, bad, 64}); }), HasSubstr("cell size"));
    EXPECT_THAT(ErrorOf([&] { LayoutGrid(mins, maxs, {1e-7f, 64, 64}); }), HasSubstr("cannot be counted"));
    EXPECT_THAT(ErrorOf([&] { LayoutGrid(mins, maxs, {1e-44f, 64, 64}); }), HasSubstr("cannot be counted"));
    EXPECT_THAT(ErrorOf([&] { LayoutGrid({nan, 0, 0}, maxs, {64, 64, 64}); }), HasSubstr("cannot be counted"));
    EXPECT_THAT(ErrorOf([&] { LayoutGrid(mins, {1e38f, 1e38f, inf}, {64, 64, 64}); }), HasSubstr("cannot be counted"));
    EXPECT_THAT(ErrorOf([&] { LayoutGrid(mins, maxs, {1e-6f, 1e-6f, 1e-6f}); }), HasSubstr("too many"));
}

TEST(Grid, TheLumpIsTheHeadThenThePoints) {
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    const auto file = WriteBsp(bsp, {});
    const auto at = file.begin() + IntAt(file, 8 + 8 * 18);
    ASSERT_EQ(IntAt(file, 12 + 8 * 18), 40 + 108 * 6);
    EXPECT_EQ(std::vector(at, at + 40 + 108 * 6), GridLump(*bsp.gridSH));
}

TEST(Grid, SHLumpOfAnyOtherLengthIsRefused) {
    const auto lump = GridLump(SampleGridSH());
    Bsp bsp = SampleBsp();
    KeptLog listener;
    for (std::size_t length = 0; length < lump.size(); length++) {
        bsp.bspx = {{"LIGHTGRID_SH", {lump.begin(), lump.begin() + std::ptrdiff_t(length)}}};
        EXPECT_THAT(ErrorOf([&] { ReadBsp(WriteBsp(bsp, {}), "x.bsp", {}, listener.log); }),
                    HasSubstr("x.bsp: SH light grid: "))
            << length;
    }
}
