// GPL-2.0-or-later. Maps in the format of another game.
#include "q3map2/convert/game/format_change.h"

#include "q3map2/bspfile/bspfile.h"
#include "tests/support/kept_log.h"
#include "tests/support/small_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

constexpr std::array<std::uint8_t, 3> kBlack{}, kDim{3, 2, 1};

TEST(ChangeFormat, OneStyleToFour) {
    Bsp bsp = SmallBsp();
    bsp.gridPoints[0].ambient[0] = kBlack;
    bsp.advertisements.resize(2);
    bsp.gridSH.emplace();
    KeptLog log;
    ChangeFormat(bsp, kRbspIdent, log.log);
    EXPECT_EQ(bsp.ident, kRbspIdent);
    EXPECT_EQ(bsp.gridPoints[0].styles, kNoStyles) << "black ambient light is a wall in IBSP";
    EXPECT_EQ(bsp.gridPoints[1].styles, kOnlyStyle0);
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapStyles, kOnlyStyle0);
    EXPECT_EQ(bsp.gridSHContainer, GridSHContainer::Bspx);
    EXPECT_THAT(log.text, HasSubstr("2 advertisements are dropped: RBSP has no place for them"));
}

TEST(ChangeFormat, FourStylesToOne) {
    Bsp bsp = SmallBsp();
    bsp.ident = kRbspIdent;
    bsp.drawSurfaces[0].lightmapStyles = bsp.drawSurfaces[0].vertexStyles = {0, 33, kNoStyle, kNoStyle};
    bsp.drawSurfaces[0].lightmapNum[1] = 0;
    bsp.gridPoints[0].styles = kNoStyles;
    bsp.gridPoints[0].ambient[0] = kDim;
    bsp.gridPoints[1].ambient[0] = kBlack;
    bsp.gridPoints[1].directed[0] = kDim;
    KeptLog log;
    ChangeFormat(bsp, kIbspIdent, log.log);
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapStyles, kOnlyStyle0);
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapNum[1], kLightmapByVertex);
    EXPECT_EQ(bsp.gridPoints[0].ambient[0], kBlack) << "a wall";
    EXPECT_EQ(bsp.gridPoints[1].ambient[0], (std::array<std::uint8_t, 3>{1, 1, 1})) << "no wall";
    EXPECT_THAT(log.text, HasSubstr("surfaces with light of other styles than 0: 1; one style is kept"));
}

TEST(ChangeFormat, Style0IsFoundInAnySlot) {
    Bsp bsp = SmallBsp();
    bsp.ident = kRbspIdent;
    bsp.drawSurfaces[0].vertexStyles = {33, 0, kNoStyle, kNoStyle};
    bsp.drawVerts[0].color[1] = {7, 8, 9, 255};
    bsp.gridPoints[0].styles = {33, 0, kNoStyle, kNoStyle};
    bsp.gridPoints[0].ambient[1] = kDim;
    bsp.gridPoints[1].styles = {33, kNoStyle, kNoStyle, kNoStyle};
    KeptLog log;
    ChangeFormat(bsp, kIbspIdent, log.log);
    EXPECT_EQ(bsp.drawVerts[0].color[0], (std::array<std::uint8_t, 4>{7, 8, 9, 255}));
    EXPECT_EQ(bsp.gridPoints[0].ambient[0], kDim);
    EXPECT_EQ(bsp.gridPoints[1].ambient[0], (std::array<std::uint8_t, 3>{1, 1, 1})) << "dark, but no wall";
}

TEST(ChangeFormat, StylesThatEnginesOfRavenDoNotHave) {
    Bsp bsp = SmallBsp();
    bsp.ident = kFbspIdent;
    bsp.lightmapSide = kLightmapSide;
    bsp.drawSurfaces[0].lightmapStyles = {0, 33, 64, kNoStyle};
    KeptLog log;
    ChangeFormat(bsp, kRbspIdent, log.log);
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapStyles, (Styles{0, 33, kNoStyle, kNoStyle}));
    EXPECT_THAT(log.text, HasSubstr("light styles above 63"));
}

TEST(ChangeFormat, PagesOfOtherSizes) {
    Bsp bsp = SmallBsp();
    bsp.lightmaps.assign(kLightmapPageBytes, 9);
    bsp.drawSurfaces[0].lightmapNum[0] = 0;
    KeptLog log;
    ChangeFormat(bsp, kFbspIdent, log.log);
    EXPECT_EQ(bsp.LightmapPages(), 1u);
    EXPECT_THAT(bsp.entities, HasSubstr("\"_lightmapimagesize\" \"128\""));
    EXPECT_EQ(log.text, "");
    ChangeFormat(bsp, kRbspIdent, log.log);
    EXPECT_EQ(bsp.LightmapPages(), 1u) << "pages of 128 texels fit";
    bsp.ident = kFbspIdent;
    bsp.lightmapSide = 512;
    bsp.lightmaps.assign(LightmapPageBytes(512), 9);
    ChangeFormat(bsp, kIbspIdent, log.log);
    EXPECT_EQ(bsp.drawSurfaces[0].lightmapNum[0], kLightmapByVertex);
    EXPECT_TRUE(bsp.lightmaps.empty());
    EXPECT_THAT(log.text, HasSubstr("lightmap pages of 512 texels are dropped, IBSP has pages of 128"));
}

} // namespace

} // namespace q3::test
