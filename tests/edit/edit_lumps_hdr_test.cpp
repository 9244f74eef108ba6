// GPL-2.0-or-later. HDR light of maps that are merged, scaled and moved.
#include "q3map2/edit/merge_maps.h"
#include "q3map2/edit/scale_shift.h"
#include "tests/support/small_bsp.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

/// SmallBsp with `pages` lightmaps; codes count up from `first`. The world's face is in the last page.
Bsp LitBsp(std::uint32_t pages, std::uint32_t first) {
    Bsp bsp = SmallBsp();
    bsp.lightmaps.resize(pages * kLightmapPageBytes);
    bsp.drawSurfaces[0].lightmapNum[0] = int(pages) - 1;
    for (std::uint32_t i = 0; i < pages * 128 * 128; ++i)
        bsp.lightmapsE5bgr9.push_back(first + i);
    for (std::uint32_t i = 0; i < bsp.drawVerts.size(); ++i)
        bsp.vertexE5bgr9.push_back(first + 100 + i);
    RnmLightmaps &rnm = bsp.rnm.emplace();
    rnm.header.side = 128;
    rnm.header.pageCount = 1;
    rnm.pages = {{int(pages) - 1, {}}};
    for (auto &map : rnm.pages[0].maps)
        map.assign(128 * 128, first);
    return bsp;
}

struct MergedMap {
    Bsp bsp;
    std::string warnings;
};
MergedMap MergeBoth(const Bsp &main, const Bsp &added) {
    KeptLog log;
    Bsp bsp = MergeMaps({main, "main"}, {added, "added"}, {.world = true}, log.log);
    return {std::move(bsp), log.text};
}

TEST(HdrMerge, PagesVerticesAndBasisMapsFollowThoseOfTheFirst) {
    const Bsp main = LitBsp(2, 1000), added = LitBsp(1, 500000);
    const auto [bsp, warnings] = MergeBoth(main, added);
    EXPECT_EQ(warnings.find("HDR"), std::string::npos);
    ASSERT_EQ(bsp.lightmapsE5bgr9.size(), 3u * 128 * 128);
    ASSERT_EQ(bsp.vertexE5bgr9.size(), bsp.drawVerts.size());
    const bspDrawSurface_t &face = bsp.drawSurfaces[1];
    EXPECT_EQ(face.lightmapNum[0], 2);
    EXPECT_EQ(bsp.lightmapsE5bgr9[std::size_t(face.lightmapNum[0]) * 128 * 128], 500000u);
    EXPECT_EQ(bsp.vertexE5bgr9[std::size_t(face.firstVert)], 500100u);
    EXPECT_EQ(bsp.vertexE5bgr9[0], 1100u);
    ASSERT_EQ(bsp.rnm->pages.size(), 2u);
    EXPECT_EQ(bsp.rnm->header.pageCount, 2u);
    EXPECT_EQ(bsp.rnm->pages[0].lightmapNum, 1);
    EXPECT_EQ(bsp.rnm->pages[1].lightmapNum, 2);
    EXPECT_EQ(bsp.rnm->pages[1].maps[2][0], 500000u);
}

TEST(HdrMerge, WhatOnlyOneMapHasIsDroppedButBasisMaps) {
    Bsp plain = LitBsp(1, 0);
    DropStaleLumps(plain, StaleAfter::SurfaceBake);
    const auto [first, firstWarnings] = MergeBoth(LitBsp(1, 7), plain);
    EXPECT_TRUE(first.lightmapsE5bgr9.empty());
    EXPECT_TRUE(first.vertexE5bgr9.empty());
    EXPECT_EQ(first.rnm->pages.size(), 1u);
    EXPECT_THAT(firstWarnings, testing::HasSubstr("LIGHTING_E5BGR9 is dropped: only main has it"));
    const auto [second, secondWarnings] = MergeBoth(plain, LitBsp(1, 7));
    EXPECT_TRUE(second.lightmapsE5bgr9.empty());
    ASSERT_TRUE(second.rnm);
    EXPECT_EQ(second.rnm->pages[0].lightmapNum, 1);
    EXPECT_THAT(secondWarnings, testing::HasSubstr("LIGHTING_E5BGR9 is dropped: only added has it"));
}

TEST(HdrMerge, BasisMapsOfOtherStorageAreDropped) {
    Bsp added = LitBsp(1, 7);
    added.rnm->header.storage = RnmStorage::Rescaled;
    const auto [bsp, warnings] = MergeBoth(LitBsp(1, 8), added);
    ASSERT_EQ(bsp.rnm->pages.size(), 1u);
    EXPECT_EQ(bsp.rnm->pages[0].lightmapNum, 0);
    EXPECT_THAT(warnings, testing::HasSubstr("added: the BSPX lump LIGHTING_RNM is dropped"));
}

TEST(HdrMove, LightStaysWithItsLuxels) {
    const Bsp old = LitBsp(1, 7);
    KeptLog log;
    for (const bool scales : {false, true}) {
        Bsp bsp = old;
        scales ? ScaleMap(bsp, {.factors = {2, 2, 2}}, "map", log.log) : ShiftMap(bsp, {64, 0, 0}, "map", log.log);
        EXPECT_EQ(bsp.lightmapsE5bgr9, old.lightmapsE5bgr9);
        EXPECT_EQ(bsp.vertexE5bgr9, old.vertexE5bgr9);
        EXPECT_EQ(bsp.rnm->pages[0].maps, old.rnm->pages[0].maps);
        EXPECT_FALSE(Bytes(bsp).empty());
    }
}

} // namespace

} // namespace q3::test
