// GPL-2.0-or-later. RBSP and FBSP files.
#include "q3map2/bspfile/bspfile_rbsp.h"

#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/grid_table.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>

namespace q3::test {

namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::byte>;

const BspFormat kRbsp{.version = 1, .ident = kRbspIdent}, kFbsp{.version = 1, .ident = kFbspIdent};

/// The sample with light of three styles on a surface, its vertices and the grid.
Bsp StyledBsp() {
    Bsp bsp = SampleBsp();
    bsp.ident = kRbspIdent;
    bsp.lightmaps.assign(2 * kLightmapPageBytes, 7);
    bspDrawSurface_t &surface = bsp.drawSurfaces[0];
    surface.lightmapStyles = surface.vertexStyles = {0, 3, 33, kNoStyle};
    surface.lightmapNum = {0, 1, 0, kLightmapByVertex};
    bsp.brushSides[4].surfaceNum = 0;
    for (bspDrawVert_t &vert : bsp.drawVerts) {
        vert.lightmap[2] = {0.25f, 0.75f};
        vert.color[1] = {1, 2, 3, 4};
    }
    bsp.gridPoints[1].directed[1] = {9, 8, 7};
    bsp.gridPoints[1].styles = {0, 33, kNoStyle, kNoStyle};
    bsp.gridPoints[2].styles = kNoStyles;
    return bsp;
}

Bsp Read(const Bytes &file) {
    KeptLog log;
    return ReadBsp(file, "x.bsp", {}, log.log);
}

std::string WarningsOf(const Bytes &file) {
    KeptLog log;
    ReadBsp(file, "x.bsp", {}, log.log);
    return log.text;
}

int LengthOf(const Bytes &file, int slot) {
    return IntAt(file, 12 + 8 * std::size_t(slot));
}

TEST(Rbsp, RecordsAndLumpsLieAsEnginesReadThem) {
    const Bsp bsp = StyledBsp();
    const Bytes file = WriteBsp(bsp, kRbsp);
    EXPECT_EQ(std::memcmp(file.data(), "RBSP\1\0\0\0", 8), 0);
    const std::map<int, std::size_t> records{{LUMP_BRUSHSIDES, 12 * bsp.brushSides.size()},
                                             {LUMP_DRAWVERTS, 80 * bsp.drawVerts.size()},
                                             {LUMP_SURFACES, 148 * bsp.drawSurfaces.size()},
                                             {LUMP_LIGHTARRAY, 2 * bsp.gridPoints.size()}};
    for (const auto &[slot, bytes] : records)
        EXPECT_EQ(std::size_t(LengthOf(file, slot)), bytes) << slot;
    EXPECT_EQ(LengthOf(file, LUMP_LIGHTGRID) % 30, 0);
    int next = 8 + 8 * 18; // the header
    for (const int slot : {1, 2, 4, 3, 8, 9, 5, 6, 7, 10, 13, 16, 14, 15, 17, 0, 11, 12}) {
        EXPECT_EQ(IntAt(file, 8 + 8 * std::size_t(slot)), next) << slot;
        next += (LengthOf(file, slot) + 3) / 4 * 4;
    }
    const auto surface = std::size_t(IntAt(file, 8 + 8 * LUMP_SURFACES));
    EXPECT_EQ(file[surface + 29], std::byte(3)) << "style of slot 1";
    EXPECT_EQ(IntAt(file, surface + 40), 1) << "page of slot 1";
}

TEST(Rbsp, GivesBackWhatWasWritten) {
    for (const BspFormat &format : {kRbsp, kFbsp}) {
        Bsp bsp = StyledBsp();
        if (format.ident == kFbspIdent) {
            bsp.lightmapSide = kFbspLightmapSide;
            bsp.lightmaps.assign(2 * LightmapPageBytes(bsp.lightmapSide), 7);
        }
        const Bytes file = WriteBsp(bsp, format);
        const Bsp back = Read(file);
        EXPECT_EQ(back.ident, format.ident);
        EXPECT_EQ(back.lightmapSide, bsp.lightmapSide);
        EXPECT_EQ(back.gridPoints, bsp.gridPoints);
        EXPECT_EQ(back.drawSurfaces[0].lightmapStyles, bsp.drawSurfaces[0].lightmapStyles);
        EXPECT_EQ(back.drawSurfaces[0].lightmapNum, bsp.drawSurfaces[0].lightmapNum);
        EXPECT_EQ(back.drawVerts[3].lightmap, bsp.drawVerts[3].lightmap);
        EXPECT_EQ(back.drawVerts[3].color, bsp.drawVerts[3].color);
        EXPECT_EQ(back.brushSides[4].surfaceNum, 0);
        EXPECT_EQ(back.brushSides[5].surfaceNum, -1);
        EXPECT_EQ(WriteBsp(back, format), file);
    }
}

TEST(Rbsp, GridsOfOwnLumpsFollowTheLastLump) {
    Bsp bsp = StyledBsp();
    bsp.gridSH = SampleGridSH();
    bsp.gridSHContainer = GridSHContainer::Bspx;
    const Bytes file = WriteBsp(bsp, kRbsp);
    const Bsp back = Read(file);
    ASSERT_TRUE(back.gridSH);
    EXPECT_EQ(GridLump(*back.gridSH), GridLump(*bsp.gridSH));
    EXPECT_EQ(back.gridSHContainer, GridSHContainer::Bspx);
    EXPECT_EQ(IntAt(file, 4), 1);
    bsp.gridSHContainer = GridSHContainer::Lump;
    EXPECT_THAT(ErrorOf([&] { WriteBsp(bsp, kRbsp); }), HasSubstr("RBSP has no lump 18 for the SH light grid"));
}

TEST(Rbsp, ASecondPageFollowsTheOnlyOne) {
    Bsp bsp = StyledBsp();
    bsp.lightmaps.resize(kLightmapPageBytes);
    bsp.drawSurfaces[0].lightmapNum = {0, kLightmapByVertex, kLightmapByVertex, kLightmapByVertex};
    bsp.drawSurfaces[0].lightmapStyles = kOnlyStyle0;
    bsp.lightmapsE5bgr9.assign(128 * 128, 5);
    const Bytes file = WriteBsp(bsp, kRbsp);
    EXPECT_EQ(LengthOf(file, LUMP_LIGHTMAPS), int(2 * kLightmapPageBytes)) << "the engine reads two pages";
    const Bsp back = Read(file);
    EXPECT_EQ(back.lightmaps, bsp.lightmaps);
    EXPECT_EQ(back.lightmapsE5bgr9, bsp.lightmapsE5bgr9) << "HDR light has a code for each texel of the file";
    EXPECT_EQ(WriteBsp(back, kRbsp), file);
    bsp.lightmapsE5bgr9.clear();
    bsp.lightmapSide = kFbspLightmapSide;
    bsp.lightmaps.assign(LightmapPageBytes(kFbspLightmapSide), 7);
    EXPECT_EQ(Read(WriteBsp(bsp, kFbsp)).LightmapPages(), 1u);
}

TEST(Rbsp, NumbersPastTheGridsRecordsAreWalls) {
    Bytes file = WriteBsp(StyledBsp(), kRbsp);
    const auto numbers = std::size_t(IntAt(file, 8 + 8 * LUMP_LIGHTARRAY));
    file[numbers] = file[numbers + 1] = std::byte(0xFF);
    EXPECT_THAT(WarningsOf(file), HasSubstr("1 of 18 light grid points name a record past the"));
    const bspGridPoint_t point = Read(file).gridPoints[0];
    EXPECT_EQ(point.styles, kNoStyles);
    EXPECT_EQ(point.ambient[0], (std::array<std::uint8_t, 3>{}));
}

TEST(Rbsp, GridsAreLimitedAndJoinedWithAWarning) {
    Bsp bsp = StyledBsp();
    bsp.gridPoints.resize(kMaxGridPoints + 1);
    EXPECT_THAT(ErrorOf([&] { WriteBsp(bsp, kRbsp); }), HasSubstr("engines take at most 1048576: use a larger grid"));
    bsp.gridPoints.assign(kMaxGridRecords + 2, {});
    for (std::size_t i = 0; i < bsp.gridPoints.size(); ++i)
        bsp.gridPoints[i].ambient[0] = {std::uint8_t(i), std::uint8_t(i >> 8), std::uint8_t(i >> 16)};
    KeptLog log;
    const ByteRanges bytes = EncodeRbsp(bsp, kRbsp, log.log);
    EXPECT_THAT(log.text, HasSubstr("the light grid has 65537 different points, but the file holds 65535"));
    EXPECT_THAT(log.text, HasSubstr("and by at most 1"));
    EXPECT_GT(bytes.Size(), 30 * kMaxGridRecords);
}

TEST(Rbsp, SizeOfPagesIsSaidByTheWorld) {
    Bsp bsp = StyledBsp();
    bsp.lightmapSide = 128;
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"_lightmapimagesize\" \"128\"\n}\n";
    EXPECT_EQ(Read(WriteBsp(bsp, kFbsp)).lightmapSide, 128);
    EXPECT_EQ(Read(WriteBsp(bsp, kFbsp)).LightmapPages(), 2u);
    EXPECT_EQ(Read(WriteBsp(bsp, kRbsp)).lightmapSide, 128);
    for (const char *value : {"100", "0", "-128", "1e9", "x", "nan"}) {
        bsp.entities = fmt::format("{{\n\"classname\" \"worldspawn\"\n\"_lightmapimagesize\" \"{}\"\n}}\n", value);
        EXPECT_THAT(ErrorOf([&] { Read(WriteBsp(bsp, kFbsp)); }), HasSubstr("record size 786432")) << value;
    }
}

TEST(Rbsp, PublishedMapsAreTaken) {
    Bsp bsp = StyledBsp();
    bsp.fogs.clear();
    for (bspDrawSurface_t &surface : bsp.drawSurfaces)
        surface.fogNum = surface.surfaceType == MST_FLARE ? 0 : -1;
    bsp.drawVerts[2].lightmap[3] = {std::numeric_limits<float>::quiet_NaN(), 0};
    const Bsp back = Read(WriteBsp(bsp, kRbsp));
    for (const bspDrawSurface_t &surface : back.drawSurfaces)
        EXPECT_EQ(surface.fogNum, -1) << "flares name fog 0 although there is none";
}

TEST(Rbsp, FaultsAreNamed) {
    const Bytes good = WriteBsp(StyledBsp(), kRbsp);
    Bytes version = good;
    SetInt(version, 4, 2);
    EXPECT_THAT(ErrorOf([&] { Read(version); }), HasSubstr("version 2 of an RBSP or FBSP file, expected 1"));
    Bytes ragged = good;
    SetInt(ragged, 12 + 8 * LUMP_SURFACES, 147);
    EXPECT_THAT(ErrorOf([&] { Read(ragged); }), HasSubstr("length 147 is not a multiple of the record size 148"));
    EXPECT_THAT(ErrorOf([&] { Read({good.begin(), good.begin() + 100}); }), HasSubstr("100 bytes"));
}

} // namespace

} // namespace q3::test
