// GPL-2.0-or-later. Files that the program writes, read by the engine-side reader.
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/scene/demo_scene.h"

#include <gtest/gtest.h>

#include <string_view>

namespace q3 {
namespace {

Bsp LitDemo(GridSHContainer container) {
    Bsp bsp = DemoScene().bsp;
    LightGridSH grid{{{-512, -384, 0}, {64, 32, 128}, {3, 2, 2}, 12}, {}};
    for (int i = 0; i < 12; i++) {
        bspGridPointSH_t point{};
        for (std::size_t k = 0; k < 9; k++)
            point.coeffs[k] = {float(i), float(k) * 0.5f, -float(i) * float(k)};
        grid.points.push_back(point);
    }
    bsp.gridSH = grid;
    bsp.gridSHContainer = container;
    return bsp;
}

void ExpectReadable(const Bsp &bsp, const BspFormat &format) {
    const std::vector<std::byte> file = WriteBsp(bsp, format);
    shgrid_grid grid;
    ASSERT_EQ(shgrid_load(file.data(), file.size(), &grid), SHGRID_OK);
    ASSERT_EQ(grid.count, 12);
    EXPECT_EQ(grid.mins[0], -512);
    EXPECT_EQ(grid.cell[1], 32);
    EXPECT_EQ(grid.bounds[2], 2);
    for (int i = 0; i < 12; i++) {
        shgrid_coeffs coeffs;
        shgrid_point(&grid, i % 3, i / 3 % 2, i / 6, &coeffs);
        for (std::size_t k = 0; k < 9; k++)
            for (std::size_t channel = 0; channel < 3; channel++)
                EXPECT_EQ(coeffs.c[k][channel], bsp.gridSH->points[std::size_t(i)].coeffs[k][channel]);
    }
}

TEST(ShgridFile, ReadsLump18) {
    ExpectReadable(LitDemo(GridSHContainer::Lump), {});
}

TEST(ShgridFile, ReadsBspx) {
    ExpectReadable(LitDemo(GridSHContainer::Bspx), {});
}

TEST(ShgridFile, ReadsBspxBehindOtherLumpsAndAdvertisements) {
    Bsp bsp = LitDemo(GridSHContainer::Bspx);
    bsp.bspx.push_back({"LIGHTGRID_OCTREE", std::vector<std::byte>(13)});
    ExpectReadable(bsp, {});
    bsp.advertisements.push_back({1, {0, 0, 1}, {}, {}});
    ExpectReadable(bsp, {47, true, false});
    bsp.gridSHContainer = GridSHContainer::Lump;
    ExpectReadable(bsp, {47, true, false});
}

TEST(ShgridFile, ReadsRbspAndFbsp) {
    for (const std::string_view ident : {kRbspIdent, kFbspIdent})
        ExpectReadable(LitDemo(GridSHContainer::Bspx), {.version = 1, .ident = ident});
}

TEST(ShgridFile, SaysThatAMapHasNone) {
    for (const BspFormat &format : {BspFormat{46, false, false},
                                    {47, false, false},
                                    {47, true, false},
                                    {.version = 1, .ident = kRbspIdent},
                                    {.version = 1, .ident = kFbspIdent}}) {
        const std::vector<std::byte> file = WriteBsp(DemoScene().bsp, format);
        shgrid_grid grid;
        EXPECT_EQ(shgrid_load(file.data(), file.size(), &grid), SHGRID_ABSENT);
    }
}

} // namespace
} // namespace q3
