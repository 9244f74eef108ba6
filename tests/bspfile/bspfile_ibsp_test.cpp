// GPL-2.0-or-later. The layouts of the container: what is written, and what is read.
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;

namespace {

const BspFormat kQuake3{};
const BspFormat kWolfenstein{.version = 47};

using Bytes = std::vector<std::byte>;

Bytes Lump(const Bytes &file, std::size_t slot) {
    const auto at = file.begin() + IntAt(file, 8 + 8 * slot);
    return {at, at + IntAt(file, 12 + 8 * slot)};
}

Bsp Read(const Bytes &file, const BspFormat &format = kQuake3) {
    KeptLog listener;
    Bsp bsp = ReadBsp(file, "x.bsp", format, listener.log);
    EXPECT_EQ(listener.text, "");
    return bsp;
}

/// The lumps in another layout, as other compilers lay them out: slot order, text between the header and the first
/// lump.
Bytes Relayout(const std::vector<Bytes> &lumps, int version, const std::string &text) {
    Bytes file(8 + 8 * lumps.size());
    std::memcpy(file.data(), "IBSP", 4);
    SetInt(file, 4, version);
    for (const char c : text)
        file.push_back(std::byte(c));
    for (std::size_t slot = 0; slot < lumps.size(); slot++) {
        file.resize((file.size() + 3) / 4 * 4);
        SetInt(file, 8 + 8 * slot, int(file.size()));
        SetInt(file, 12 + 8 * slot, int(lumps[slot].size()));
        file.insert(file.end(), lumps[slot].begin(), lumps[slot].end());
    }
    return file;
}

std::vector<Bytes> ClassicLumps(const Bsp &bsp) {
    const Bytes file = WriteBsp(bsp, kQuake3);
    std::vector<Bytes> lumps;
    for (std::size_t slot = 0; slot < 17; slot++)
        lumps.push_back(Lump(file, slot));
    return lumps;
}

Bytes AdBytes() {
    Bytes bytes(sizeof(bspAdvertisement_t));
    const bspAdvertisement_t ad = SampleAdvertisement();
    std::memcpy(bytes.data(), &ad, sizeof ad);
    return bytes;
}

const std::string kText = "Compiled by some other tool, 1.0, on Mon Jan  1 00:00:00 2024\n";

} // namespace

TEST(Layout, Version46HasSeventeenSlotsInTheUsualOrder) {
    const Bytes file = WriteBsp(SampleBsp(), kQuake3);
    EXPECT_EQ(std::memcmp(file.data(), "IBSP", 4), 0);
    EXPECT_EQ(IntAt(file, 4), 46);
    std::size_t position = 144;
    for (const std::size_t slot : {1, 2, 4, 3, 8, 9, 5, 6, 7, 10, 13, 16, 14, 15, 0, 12, 11}) {
        EXPECT_EQ(IntAt(file, 8 + 8 * slot), int(position)) << slot;
        position = (position + std::size_t(IntAt(file, 12 + 8 * slot)) + 3) / 4 * 4;
    }
    EXPECT_EQ(file.size(), position);
}

TEST(Layout, EntityLumpEndsWithOneNulThatCounts) {
    const Bsp bsp = SampleBsp();
    const Bytes lump = Lump(WriteBsp(bsp, kQuake3), LUMP_ENTITIES);
    ASSERT_EQ(lump.size(), bsp.entities.size() + 1);
    EXPECT_EQ(lump.back(), std::byte(0));
    EXPECT_EQ(std::memcmp(lump.data(), bsp.entities.data(), bsp.entities.size()), 0);
}

TEST(Layout, PaddingIsZero) {
    Bsp bsp = SampleBsp();
    bsp.entities += "\n";
    while ((bsp.entities.size() + 1) % 4 != 1)
        bsp.entities += "\n";
    const Bytes file = WriteBsp(bsp, kQuake3);
    const auto end = std::size_t(IntAt(file, 8) + IntAt(file, 12));
    for (std::size_t i = end; i < end + 3; i++)
        EXPECT_EQ(file[i], std::byte(0));
    EXPECT_EQ(file.size() % 4, 0u);
}

TEST(Layout, SHGridGoesToLump18OfVersion47) {
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    const Bytes file = WriteBsp(bsp, kQuake3);
    EXPECT_EQ(IntAt(file, 4), 47);
    EXPECT_EQ(IntAt(file, 8 + 8 * 1), 160); // shaders first, right after 19 slots
    EXPECT_EQ(IntAt(file, 8 + 8 * 17), 0);
    EXPECT_EQ(IntAt(file, 12 + 8 * 17), 0);
    EXPECT_EQ(IntAt(file, 12 + 8 * 18), 40 + 108 * 6);
    EXPECT_EQ(std::size_t(IntAt(file, 8 + 8 * 18) + IntAt(file, 12 + 8 * 18)), file.size());
    const Bytes lump = Lump(file, 18);
    EXPECT_EQ(IntAt(lump, 24), 2);
    EXPECT_EQ(IntAt(lump, 28), 3);
    EXPECT_EQ(IntAt(lump, 32), 1);
    EXPECT_EQ(IntAt(lump, 36), 6);
    float value = 0;
    std::memcpy(&value, &lump[40 + 5 * 108 + (3 * 3 + 2) * 4], 4); // point 5, coefficient 3, blue
    EXPECT_EQ(value, 15.0f);
}

TEST(Layout, EveryWrittenLayoutIsReadBackToTheSameBytes) {
    Bsp bsp = SampleBsp();
    bsp.lightmaps.resize(49152);
    std::iota(bsp.lightmaps.begin(), bsp.lightmaps.end(), std::uint8_t(0));
    bsp.drawSurfaces[0].lightmapNum[0] = 0;
    for (const BspFormat &format : {kQuake3, kQuakeLive, kWolfenstein})
        for (const int sh : {0, 1, 2})
            for (const bool foreign : {false, true}) {
                bsp.gridSH.reset();
                bsp.gridSHContainer = sh == 2 ? GridSHContainer::Bspx : GridSHContainer::Lump;
                if (sh > 0)
                    bsp.gridSH = SampleGridSH();
                bsp.bspx.clear();
                if (foreign)
                    bsp.bspx = {{"LMSHIFT", Bytes(5, std::byte(9))}, {"EMPTY", {}}};
                bsp.advertisements.clear();
                if (format.advertisements)
                    bsp.advertisements.push_back(SampleAdvertisement());
                const Bytes file = WriteBsp(bsp, format);
                const Bsp back = Read(file, format);
                EXPECT_EQ(back.gridSH.has_value(), sh > 0);
                EXPECT_EQ(back.gridSHContainer == GridSHContainer::Bspx, sh == 2);
                EXPECT_EQ(back.advertisements.size(), format.advertisements ? 1u : 0u);
                EXPECT_EQ(back.bspx.size(), foreign ? 2u : 0u);
                EXPECT_EQ(WriteBsp(back, format), file);
            }
}

TEST(Layout, AFileWithLump18RelightsUnderQuake3) {
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    Bsp back = Read(WriteBsp(bsp, kQuake3), kQuake3);
    back.gridSH.reset();
    EXPECT_EQ(WriteBsp(back, kQuake3), WriteBsp(SampleBsp(), kQuake3));
}

TEST(Layout, BytesThatMeanNothingSurvive) {
    Bsp bsp = SampleBsp();
    bsp.shaders[0].shader[60] = 'g'; // garbage after the NUL
    bsp.drawVerts[5].lightmap[0] = {std::numeric_limits<float>::quiet_NaN(), 1e30f};
    bsp.planes[9].normal[0] = 1e-7f; // noise between the two of a pair
    bsp.entities += "\n\n";
    const Bytes file = WriteBsp(bsp, kQuake3);
    EXPECT_EQ(WriteBsp(Read(file), kQuake3), file);
}

TEST(Layout, HeadersOfOtherCompilersAreRead) {
    std::vector<Bytes> lumps = ClassicLumps(SampleBsp());
    const Bytes expected = WriteBsp(SampleBsp(), kQuake3);
    for (const std::string &text : {std::string(), kText}) {
        EXPECT_EQ(WriteBsp(Read(Relayout(lumps, 46, text)), kQuake3), expected) << text;
        EXPECT_EQ(WriteBsp(Read(Relayout(lumps, 47, text), kWolfenstein), kQuake3), expected) << text;
        EXPECT_EQ(WriteBsp(Read(Relayout(lumps, 47, text), kQuakeLive), kQuake3), expected) << text;
        auto eighteen = lumps;
        eighteen.emplace_back();
        EXPECT_EQ(WriteBsp(Read(Relayout(eighteen, 46, text)), kQuake3), expected) << text;
        eighteen.back() = AdBytes();
        const Bytes live = Relayout(eighteen, 47, text);
        EXPECT_EQ(Read(live, kQuakeLive).advertisements.size(), 1u) << text;
        EXPECT_EQ(Read(live, kWolfenstein).advertisements.size(), 0u) << text;
    }
}

TEST(Layout, Lump18BehindTextIsRead) {
    std::vector<Bytes> lumps = ClassicLumps(SampleBsp());
    lumps.emplace_back();
    lumps.push_back(GridLump(SampleGridSH()));
    EXPECT_EQ(Read(Relayout(lumps, 47, kText)).gridSH->points.size(), 6u);
    EXPECT_EQ(Read(Relayout(lumps, 46, kText)).gridSH.has_value(), false); // version 46 has no such slot
}

TEST(Layout, DamagedLump18IsAnErrorInOurOwnLayoutOnly) {
    std::vector<Bytes> lumps = ClassicLumps(SampleBsp());
    lumps.emplace_back();
    lumps.push_back(GridLump(SampleGridSH()));
    lumps.back().resize(41); // not 40 + 108 n
    KeptLog listener;
    const Bsp bsp = ReadBsp(Relayout(lumps, 47, kText), "x.bsp", kQuake3, listener.log);
    EXPECT_FALSE(bsp.gridSH);
    EXPECT_THAT(listener.text, HasSubstr("slot 18"));
    EXPECT_THAT(ErrorOf([&] { Read(Relayout(lumps, 47, "")); }), HasSubstr("SH light grid: length 41"));
    Bytes outside = Relayout(lumps, 47, "");
    SetInt(outside, 8 + 8 * 18, int(outside.size()));
    EXPECT_THAT(ErrorOf([&] { Read(outside); }), HasSubstr("lump 18"));
}

TEST(Layout, FilesOver2GBAreRefusedWithAdvice) {
    constexpr std::array<int, 1> kSlots{LUMP_LIGHTGRID_SH};
    std::array<std::uint64_t, kNumLumps> lengths{};
    lengths[LUMP_LIGHTGRID_SH] = 0x7fffffff - 160 - 3;
    EXPECT_EQ(PlanFile(19, kSlots, lengths, {}).size, 0x7ffffffcu);
    lengths[LUMP_LIGHTGRID_SH] += 4;
    EXPECT_THAT(ErrorOf([&] { PlanFile(19, kSlots, lengths, {}); }), HasSubstr("-gridsh"));
    lengths[LUMP_LIGHTGRID_SH] = std::uint64_t(1) << 40;
    EXPECT_THAT(ErrorOf([&] { PlanFile(19, kSlots, lengths, {}); }), HasSubstr("2147483647"));
}

TEST(Layout, ForceTurnsMismatchesIntoWarnings) {
    const Bytes good = WriteBsp(SampleBsp(), kQuake3);
    const BspFormat forced{.force = true};
    const auto lenient = [&forced](const Bytes &file) {
        KeptLog listener;
        ReadBsp(file, "x.bsp", forced, listener.log);
        return listener.text;
    };
    Bytes ident = good;
    ident[0] = std::byte('T');
    EXPECT_THAT(ErrorOf([&] { Read(ident); }), HasSubstr("IBSP"));
    EXPECT_THAT(lenient(ident), HasSubstr("IBSP"));
    Bytes version = good;
    SetInt(version, 4, 38);
    EXPECT_THAT(ErrorOf([&] { Read(version); }),
                HasSubstr("the file is a map of Quake II (IBSP 38); expected a .bsp of Quake III"));
    EXPECT_THAT(lenient(version), HasSubstr("38"));
    Bytes source = good;
    SetInt(source, 0, 0x400CCCCD), SetInt(source, 4, 'R' | 'M' << 8 | 'F' << 16); // version 2.2
    EXPECT_THAT(ErrorOf([&] { Read(source); }), HasSubstr("Worldcraft or Hammer (rmf): export it as .map"));
    Bytes ragged = good;
    SetInt(ragged, 12 + 8 * LUMP_LIGHTGRID, 18 * 8 - 1);
    EXPECT_THAT(ErrorOf([&] { Read(ragged); }), HasSubstr("lump 15 (light grid): length 143"));
    EXPECT_THAT(lenient(ragged), HasSubstr("dropped"));
    Bsp pages = SampleBsp();
    pages.lightmaps.resize(49152 + 4); // one page and a bit
    KeptLog listener;
    EXPECT_THAT(ErrorOf([&] { ValidateBsp(pages, "x.bsp", listener.log); }), HasSubstr("lightmaps: 49156 bytes"));
    ragged = WriteBsp(pages, kQuake3);
    EXPECT_THAT(ErrorOf([&] { Read(ragged); }), HasSubstr("lump 14 (lightmaps): length 49156"));
    EXPECT_EQ(ReadBsp(ragged, "x.bsp", forced, listener.log).lightmaps.size(), 0u);
}

TEST(Ibsp, PagesHaveTheSizeOfTheGameIfTheLumpIsMadeOfSuch) {
    BspFormat large = kQuake3;
    large.lightmapSide = 512;
    Bsp bsp = SampleBsp();
    KeptLog listener;
    const auto pagesIn = [&](std::size_t bytes) {
        bsp.lightmaps.resize(bytes);
        const Bsp read = ReadBsp(WriteBsp(bsp, kQuake3), "x.bsp", large, listener.log);
        return std::pair(read.lightmapSide, read.LightmapPages());
    };
    EXPECT_EQ(pagesIn(2 * LightmapPageBytes(512)), (std::pair<int, std::size_t>{512, 2}));
    EXPECT_EQ(pagesIn(LightmapPageBytes(128)), (std::pair<int, std::size_t>{128, 1})) << "lit for another game";
}

TEST(Bspx, ForeignLumpsComeFirstAndOursLast) {
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    bsp.gridSHContainer = GridSHContainer::Bspx;
    bsp.bspx = {{"LMSHIFT", Bytes(5, std::byte(9))}};
    const Bytes file = WriteBsp(bsp, kQuake3);
    EXPECT_EQ(IntAt(file, 4), 46);
    const std::size_t start = WriteBsp(SampleBsp(), kQuake3).size();
    EXPECT_EQ(std::memcmp(&file[start], "BSPX\2\0\0\0LMSHIFT", 16), 0);
    EXPECT_EQ(std::memcmp(&file[start + 8 + 32], "LIGHTGRID_SH", 13), 0);
    EXPECT_EQ(IntAt(file, start + 8 + 24), int(start + 8 + 64)); // payloads follow the directory
    EXPECT_EQ(IntAt(file, start + 8 + 28), 5);
    EXPECT_EQ(IntAt(file, start + 40 + 24), int(start + 8 + 64 + 8));
    EXPECT_EQ(IntAt(file, start + 40 + 28), 40 + 108 * 6);
    EXPECT_EQ(Read(file).gridSH->points[5].coeffs, SampleGridSH().points[5].coeffs);
}

TEST(Bspx, AMalformedDirectoryIsDroppedWithAWarning) {
    Bsp bsp = SampleBsp();
    bsp.bspx = {{"FIRST", Bytes(8, std::byte(1))}, {"SECOND", Bytes(8, std::byte(2))}};
    const Bytes good = WriteBsp(bsp, kQuake3);
    const std::size_t start = WriteBsp(SampleBsp(), kQuake3).size();
    const auto damaged = [&](std::size_t at, std::int32_t value) {
        Bytes file = good;
        SetInt(file, start + at, value);
        KeptLog listener;
        EXPECT_EQ(ReadBsp(file, "x.bsp", kQuake3, listener.log).bspx.size(), 0u);
        return listener.text;
    };
    EXPECT_THAT(damaged(4, 3), HasSubstr("3 entries"));
    EXPECT_THAT(damaged(4, -1), HasSubstr("4294967295 entries"));
    EXPECT_THAT(damaged(8 + 24, 0), HasSubstr("entry 0: offset 0"));
    EXPECT_THAT(damaged(8 + 28, 1000), HasSubstr("length 1000"));
    EXPECT_THAT(damaged(40 + 24, -4), HasSubstr("entry 1: offset 4294967292"));
    EXPECT_THAT(damaged(8 + 28, 16), HasSubstr("share bytes"));
    EXPECT_EQ(damaged(0, 0x58585858), ""); // other bytes after the lumps are no directory
}

TEST(Bspx, OfTwoLumpsWithOneNameTheFirstIsKept) {
    Bsp bsp = SampleBsp();
    bsp.bspx = {{"SAME", Bytes(8, std::byte(1))}, {"SAME", Bytes(8, std::byte(2))}};
    KeptLog listener;
    const Bsp back = ReadBsp(WriteBsp(bsp, kQuake3), "x.bsp", kQuake3, listener.log);
    ASSERT_EQ(back.bspx.size(), 1u);
    EXPECT_EQ(back.bspx[0].data[0], std::byte(1));
    EXPECT_THAT(listener.text, HasSubstr("two BSPX lumps are named SAME"));
}

TEST(Bspx, ADamagedSHGridIsAnError) {
    Bsp bsp = SampleBsp();
    bsp.bspx = {{"LIGHTGRID_SH", GridLump(SampleGridSH())}};
    EXPECT_EQ(Read(WriteBsp(bsp, kQuake3)).gridSH->points.size(), 6u);
    bsp.bspx[0].data.resize(40);
    EXPECT_THAT(ErrorOf([&] { Read(WriteBsp(bsp, kQuake3)); }), HasSubstr("SH light grid: length 40"));
}

TEST(Bspx, OfTwoSHGridsLump18Counts) {
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    LightGridSH other = SampleGridSH();
    other.points[0].coeffs[0] = {99, 99, 99};
    bsp.bspx = {{"LIGHTGRID_SH", GridLump(other)}};
    KeptLog listener;
    const Bsp back = ReadBsp(WriteBsp(bsp, kQuake3), "x.bsp", kQuake3, listener.log);
    EXPECT_EQ(back.gridSH->points[0].coeffs, SampleGridSH().points[0].coeffs);
    EXPECT_EQ(back.bspx.size(), 0u);
    EXPECT_EQ(back.gridSHContainer, GridSHContainer::Lump);
    EXPECT_THAT(listener.text, HasSubstr("lump 18 is used"));
}

TEST(Bspx, NamesOf24BytesSurviveAndLongerOnesAreRefused) {
    Bsp bsp = SampleBsp();
    bsp.bspx = {{std::string(24, 'n'), Bytes(3)}};
    EXPECT_EQ(Read(WriteBsp(bsp, kQuake3)).bspx[0].name, std::string(24, 'n'));
    bsp.bspx[0].name += "n";
    EXPECT_THAT(ErrorOf([&] { WriteBsp(bsp, kQuake3); }), HasSubstr("24 bytes"));
    KeptLog listener;
    EXPECT_THAT(ErrorOf([&] { ValidateBsp(bsp, "x.bsp", listener.log); }), HasSubstr("BSPX lump 0: the name has 25"));
    bsp.bspx[0].name = "LIGHTGRID_SH";
    EXPECT_THAT(ErrorOf([&] { ValidateBsp(bsp, "x.bsp", listener.log); }), HasSubstr("BSPX lump 0: the name LIGHT"));
}
