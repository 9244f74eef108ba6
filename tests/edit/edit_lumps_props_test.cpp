// GPL-2.0-or-later. Light of static props and lumps of others in maps that are merged, scaled and moved.
#include "q3map2/bspfile/prop_light.h"
#include "q3map2/edit/edit_lumps.h"
#include "q3map2/edit/merge_maps.h"
#include "q3map2/edit/scale_shift.h"
#include "tests/support/small_bsp.h"

#include <cstring>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

/// A map with `count` props after its world, each with two meshes; colors count up from `first`.
Bsp MapWithProps(std::uint32_t count, std::uint32_t first) {
    Bsp bsp = SmallBsp();
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n}\n";
    PropLight light;
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::string model = fmt::format("models/{}_{}.md3", first, i);
        bsp.entities += fmt::format("{{\n\"classname\" \"misc_gamemodel\"\n\"model\" \"{}\"\n}}\n", model);
        light.props.push_back({i + 1, ModelNameCrc(model), 77 + i, 2 * i, 2});
        light.meshes.push_back({3 * i, 1});
        light.meshes.push_back({3 * i + 1, 2});
        for (std::uint32_t color = 0; color < 3; ++color)
            light.colors.push_back(first + 3 * i + color);
    }
    bsp.propLight = light;
    return bsp;
}

PropLight LightOf(const Bsp &bsp) {
    return bsp.propLight.value();
}

TEST(EditedProps, StayWhenTheMapMoves) {
    const Bsp old = MapWithProps(2, 100);
    KeptLog log;
    Bsp shifted = old, scaled = old;
    ShiftMap(shifted, {100, 50, -20}, "map", log.log);
    ScaleMap(scaled, {.factors = {2, 2, 3}}, "map", log.log);
    for (const Bsp *bsp : {&shifted, &scaled}) {
        ASSERT_TRUE(bsp->propLight);
        EXPECT_EQ(EncodePropLight(*bsp->propLight), EncodePropLight(*old.propLight));
        EXPECT_EQ(PropLightFault(*bsp), "");
    }
    EXPECT_EQ(log.text.find(kBspxPropLight), std::string::npos) << log.text;
}

TEST(EditedProps, OfTheSecondMapFollowWithTheirNumbersInTheMergedOne) {
    const Bsp main = MapWithProps(2, 100), added = MapWithProps(3, 500);
    KeptLog log;
    const Bsp bsp = MergeMaps({main, "main"}, {added, "added"}, {}, log.log);
    EXPECT_EQ(PropLightFault(bsp), "");
    const PropLight light = LightOf(bsp);
    ASSERT_EQ(light.props.size(), 5u);
    EXPECT_EQ(light.props[1].entity, 2u);
    EXPECT_EQ(light.props[2].entity, 3u) << "the second map's entity 1";
    EXPECT_EQ(light.props[4].entity, 5u);
    EXPECT_EQ(light.props[2].modelCrc, 77u);
    EXPECT_EQ(light.colors[light.meshes[light.props[2].firstMesh].firstColor], 500u);
    EXPECT_EQ(light.colors.size(), 15u);
    EXPECT_EQ(log.text.find(kBspxPropLight), std::string::npos) << log.text;
}

TEST(EditedProps, OfOneMapOnlyAreKept) {
    const Bsp lit = MapWithProps(2, 100);
    Bsp unlit = MapWithProps(2, 300);
    unlit.propLight.reset();
    KeptLog log;
    EXPECT_EQ(LightOf(MergeMaps({lit, "lit"}, {unlit, "unlit"}, {}, log.log)).props.back().entity, 2u);
    EXPECT_EQ(LightOf(MergeMaps({unlit, "unlit"}, {lit, "lit"}, {}, log.log)).props.front().entity, 3u);
    EXPECT_EQ(log.text.find(kBspxPropLight), std::string::npos) << log.text;
}

/// A grid lump: cell, counts and corner, then bytes that an edit leaves alone.
std::vector<std::byte> GridLump(const Float3 &cell, const Float3 &mins) {
    const Int3 counts{3, 4, 5};
    std::vector<std::byte> bytes(36, std::byte(0));
    std::memcpy(bytes.data(), cell.data(), 12);
    std::memcpy(bytes.data() + 12, counts.data(), 12);
    std::memcpy(bytes.data() + 24, mins.data(), 12);
    bytes.resize(50, std::byte(9));
    return bytes;
}

TEST(EditedLumps, GridsOfOtherEnginesMoveAlong) {
    Bsp bsp;
    const auto plain = GridLump({64, 64, 128}, {-64, 0, 128});
    std::vector<std::byte> behindLength(4, std::byte(0));
    behindLength[0] = std::byte(plain.size());
    behindLength.insert(behindLength.end(), plain.begin(), plain.end());
    bsp.bspx = {
        {"LIGHTGRID_OCTREE", plain}, {"LIGHTGRIDS", behindLength}, {"RGBLIGHTING", plain}, {"FACENORMALS", plain}};
    KeptLog log;
    TransformRawLumps({.factors = {2, 2, 2}, .shift = {10, 20, 30}}, bsp, log.log);
    ASSERT_EQ(bsp.bspx.size(), 4u);
    const auto moved = GridLump({128, 128, 256}, {-118, 20, 286});
    EXPECT_EQ(bsp.bspx[0].data, moved);
    EXPECT_TRUE(std::ranges::equal(std::span(bsp.bspx[1].data).subspan(4), moved));
    EXPECT_EQ(bsp.bspx[2].data, plain);
    EXPECT_EQ(bsp.bspx[3].data, plain) << "directions stay if all axes are scaled alike";
    EXPECT_EQ(log.text, "");
}

TEST(EditedLumps, WhatMayHoldPositionsIsDroppedWithAWarningEach) {
    Bsp bsp;
    bsp.bspx = {{"BRUSHLIST", {}},
                {"ENVMAP", std::vector<std::byte>(7)},
                {"LIGHTGRID_OCTREE", std::vector<std::byte>(8)},
                {"FACENORMALS", {}}};
    KeptLog log;
    TransformRawLumps({.factors = {1, 1, 2}, .shift = {}}, bsp, log.log);
    EXPECT_TRUE(bsp.bspx.empty());
    for (const char *text : {"BRUSHLIST (0 bytes) is dropped", "ENVMAP (7 bytes) is dropped",
                             "LIGHTGRID_OCTREE (8 bytes) is dropped", "FACENORMALS (0 bytes) is dropped"})
        EXPECT_THAT(log.text, HasSubstr(text));
}

TEST(EditedLumps, AMergeSaysWhatItLeavesOut) {
    Bsp main = SmallBsp(), added = SmallBsp();
    main.bspx = {{"RGBLIGHTING", {}}, {"LIGHTGRID_OCTREE", {}}};
    added.bspx = {{"ENVMAP", {}}, {"LIGHTGRID_OCTREE", {}}, {"LIGHTGRIDS", {}}};
    added.gridSH.emplace();
    Bsp bsp = main;
    KeptLog log;
    MergeLumps({main, added, "main", "added", bsp, log.log, 0, {}});
    ASSERT_EQ(bsp.bspx.size(), 1u);
    EXPECT_EQ(bsp.bspx[0].name, "LIGHTGRID_OCTREE");
    for (const char *text : {"main: the BSPX lump RGBLIGHTING", "added: the BSPX lump ENVMAP",
                             "added: the BSPX lump LIGHTGRIDS", "added: the SH light grid is dropped"})
        EXPECT_THAT(log.text, HasSubstr(text));
    EXPECT_EQ(log.text.find("added: the BSPX lump LIGHTGRID_OCTREE"), std::string::npos) << "the first map has its own";
}

} // namespace

} // namespace q3::test
