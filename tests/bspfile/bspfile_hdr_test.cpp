// GPL-2.0-or-later. BSPX lumps of HDR light, against bytes put together and taken apart here.
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;

namespace {

using FileBytes = std::vector<std::byte>;

void AddInt(FileBytes &bytes, std::uint32_t value) {
    for (int i = 0; i < 4; ++i)
        bytes.push_back(std::byte(value >> 8 * i & 255));
}

/// Two pages of 128 x 128 and a code for each vertex; RNM of side 128 for page 1 alone.
Bsp HdrBsp() {
    Bsp bsp = SampleBsp();
    bsp.lightmaps.resize(2 * kLightmapPageBytes);
    for (std::uint32_t i = 0; i < 2 * 128 * 128; ++i)
        bsp.lightmapsE5bgr9.push_back(i * 2654435761u);
    for (std::uint32_t i = 0; i < bsp.drawVerts.size(); ++i)
        bsp.vertexE5bgr9.push_back(0x80402010u + i);
    RnmLightmaps rnm{.header = {.storage = RnmStorage::Rescaled, .side = 128, .pageCount = 1}, .pages = {{1, {}}}};
    for (std::uint32_t k = 0; k < 3; ++k)
        for (std::uint32_t i = 0; i < 128 * 128; ++i)
            rnm.pages[0].maps[k].push_back(k << 30 | i);
    bsp.rnm = rnm;
    return bsp;
}

/// The lumps of the BSPX directory that follows the other lumps of the file of HdrBsp.
std::map<std::string, FileBytes> LumpsOf(const FileBytes &file, std::vector<std::string> &order) {
    std::map<std::string, FileBytes> lumps;
    std::size_t start = 0;
    for (std::size_t slot = 0; slot < 17; ++slot)
        start = std::max(start, std::size_t(IntAt(file, 8 + 8 * slot) + IntAt(file, 12 + 8 * slot)));
    start = (start + 3) / 4 * 4;
    EXPECT_EQ(std::memcmp(&file[start], "BSPX", 4), 0);
    for (std::size_t i = 0; i < std::size_t(IntAt(file, start + 4)); ++i) {
        const std::size_t entry = start + 8 + 32 * i;
        const std::string name = reinterpret_cast<const char *>(&file[entry]);
        const auto first = file.begin() + IntAt(file, entry + 24);
        lumps[name] = FileBytes(first, first + IntAt(file, entry + 28));
        order.push_back(name);
    }
    return lumps;
}

FileBytes RnmLump(std::uint32_t version, std::uint32_t storage, std::uint32_t side, std::uint32_t pages,
                  const std::vector<std::uint32_t> &body) {
    FileBytes lump;
    for (const char c : {'R', 'N', 'M', '1'})
        lump.push_back(std::byte(c));
    for (const std::uint32_t value : {version, storage, side, pages})
        AddInt(lump, value);
    for (const std::uint32_t value : body)
        AddInt(lump, value);
    return lump;
}

Bsp ReadBack(const Bsp &bsp, KeptLog &listener) {
    return ReadBsp(WriteBsp(bsp, {}), "x.bsp", {}, listener.log);
}

TEST(HdrLumps, BytesAreThoseOfTheFormat) {
    const Bsp bsp = HdrBsp();
    const FileBytes file = WriteBsp(bsp, {});
    EXPECT_EQ(IntAt(file, 4), 46) << "engines load it";
    std::vector<std::string> order;
    const auto lumps = LumpsOf(file, order);
    EXPECT_EQ(order, (std::vector<std::string>{"LIGHTING_E5BGR9", "VERTEX_E5BGR9", "LIGHTING_RNM"}));
    FileBytes codes, vertices;
    for (const std::uint32_t code : bsp.lightmapsE5bgr9)
        AddInt(codes, code);
    for (const std::uint32_t code : bsp.vertexE5bgr9)
        AddInt(vertices, code);
    EXPECT_EQ(lumps.at("LIGHTING_E5BGR9"), codes);
    EXPECT_EQ(lumps.at("VERTEX_E5BGR9"), vertices);
    std::vector<std::uint32_t> body = {1};
    for (std::uint32_t k = 0; k < 3; ++k)
        for (std::uint32_t i = 0; i < 128 * 128; ++i)
            body.push_back(k << 30 | i);
    EXPECT_EQ(lumps.at("LIGHTING_RNM"), RnmLump(1, 1, 128, 1, body));
}

TEST(HdrLumps, RoundTrip) {
    const Bsp bsp = HdrBsp();
    KeptLog listener;
    const Bsp back = ReadBack(bsp, listener);
    EXPECT_EQ(back.lightmapsE5bgr9, bsp.lightmapsE5bgr9);
    EXPECT_EQ(back.vertexE5bgr9, bsp.vertexE5bgr9);
    ASSERT_TRUE(back.rnm);
    EXPECT_EQ(back.rnm->header.storage, RnmStorage::Rescaled);
    EXPECT_EQ(back.rnm->pages[0].lightmapNum, 1);
    EXPECT_EQ(back.rnm->pages[0].maps, bsp.rnm->pages[0].maps);
    EXPECT_TRUE(back.bspx.empty());
    EXPECT_EQ(WriteBsp(back, {}), WriteBsp(bsp, {}));
    EXPECT_EQ(listener.text.find("BSPX"), std::string::npos);
}

TEST(HdrLumps, MalformedLumpsAreErrors) {
    const auto fault = [](std::string_view name, const FileBytes &data) {
        Bsp bsp = SampleBsp();
        bsp.bspx = {{std::string(name), data}};
        KeptLog listener;
        return ErrorOf([&] { ReadBack(bsp, listener); });
    };
    EXPECT_THAT(fault("LIGHTING_E5BGR9", FileBytes(6)), HasSubstr("LIGHTING_E5BGR9: length 6 is not a multiple of 4"));
    EXPECT_THAT(fault("VERTEX_E5BGR9", FileBytes(7)), HasSubstr("VERTEX_E5BGR9: length 7"));
    EXPECT_THAT(fault("LIGHTING_RNM", FileBytes(19)), HasSubstr("length 19 is under the 20 of its head"));
    EXPECT_THAT(fault("LIGHTING_RNM", FileBytes(20)), HasSubstr("does not start with RNM1"));
    EXPECT_THAT(fault("LIGHTING_RNM", RnmLump(2, 0, 1, 1, {0, 0, 0, 0})), HasSubstr("version 2, expected 1"));
    EXPECT_THAT(fault("LIGHTING_RNM", RnmLump(1, 2, 1, 1, {0, 0, 0, 0})), HasSubstr("storage 2, expected 0 or 1"));
    EXPECT_THAT(fault("LIGHTING_RNM", RnmLump(1, 0, 0, 1, {0})), HasSubstr("side 0, expected 1 to 16384"));
    EXPECT_THAT(fault("LIGHTING_RNM", RnmLump(1, 0, 0x80000001u, 1, {0})), HasSubstr("side 2147483649"));
    EXPECT_THAT(fault("LIGHTING_RNM", RnmLump(1, 0, 1, 0, {})), HasSubstr("no pages"));
    EXPECT_THAT(fault("LIGHTING_RNM", RnmLump(1, 0, 1, 2, {0, 0, 0, 0})), HasSubstr("length 36 is not 20 + 2 pages"));
    EXPECT_THAT(fault("LIGHTING_RNM", RnmLump(1, 0, 16384, 0xFFFFFFFFu, {0})), HasSubstr("4294967295 pages"));
    EXPECT_THAT(fault("LIGHTING_RNM", RnmLump(1, 0, 1, 1, {0, 0, 0})), HasSubstr("length 32"));
    EXPECT_EQ(fault("LIGHTING_RNM", RnmLump(1, 0, 1, 1, {0, 0, 0, 0})), "no error");
}

TEST(HdrLumps, WhatDoesNotFitTheMapIsDroppedWithAWarning) {
    const auto warned = [](const std::function<void(Bsp &)> &change) {
        Bsp bsp = HdrBsp();
        // As another program would leave them: lumps that it does not know.
        const FileBytes file = WriteBsp(bsp, {});
        std::vector<std::string> order;
        const auto lumps = LumpsOf(file, order);
        DropStaleLumps(bsp, StaleAfter::SurfaceBake);
        for (const std::string &name : order)
            bsp.bspx.push_back({name, lumps.at(name)});
        change(bsp);
        KeptLog listener;
        const Bsp back = ReadBack(bsp, listener);
        return fmt::format("{}{}{} {}", back.lightmapsE5bgr9.empty() ? "" : "L", back.vertexE5bgr9.empty() ? "" : "V",
                           back.rnm ? "R" : "", listener.text);
    };
    EXPECT_THAT(warned([](Bsp &) {}), testing::StartsWith("LVR "));
    EXPECT_THAT(warned([](Bsp &bsp) { bsp.lightmaps.resize(kLightmapPageBytes); }),
                testing::AllOf(testing::StartsWith("V "),
                               HasSubstr("LIGHTING_E5BGR9 is dropped: 32768 texels, but the lightmaps have 16384"),
                               HasSubstr("LIGHTING_RNM is dropped: lightmapNum 1 is not one of 1 lightmaps")));
    EXPECT_THAT(warned([](Bsp &bsp) { bsp.drawVerts.push_back(bsp.drawVerts[0]); }),
                testing::AllOf(testing::StartsWith("LR "), HasSubstr("VERTEX_E5BGR9 is dropped: ")));
    EXPECT_THAT(warned([](Bsp &bsp) { bsp.lightmaps.clear(); }), testing::StartsWith("LVR "))
        << "pages are files beside the map";
}

TEST(HdrLumps, ProgramsErrorsAreFoundBeforeWriting) {
    const auto fault = [](const std::function<void(Bsp &)> &change) {
        Bsp bsp = HdrBsp();
        change(bsp);
        KeptLog listener;
        const std::string text = ErrorOf([&] { WriteBsp(bsp, {}); });
        EXPECT_NE(ErrorOf([&] { ValidateBsp(bsp, "x", listener.log); }), "no error");
        return text;
    };
    EXPECT_THAT(fault([](Bsp &bsp) { bsp.lightmapsE5bgr9.pop_back(); }), HasSubstr("LIGHTING_E5BGR9: 32767 texels"));
    EXPECT_THAT(fault([](Bsp &bsp) { bsp.lightmaps.clear(), bsp.lightmapsE5bgr9.pop_back(); }),
                HasSubstr("not a multiple of 16384"));
    EXPECT_THAT(fault([](Bsp &bsp) { bsp.vertexE5bgr9.pop_back(); }), HasSubstr("VERTEX_E5BGR9"));
    EXPECT_THAT(fault([](Bsp &bsp) { bsp.rnm->pages[0].maps[2].pop_back(); }), HasSubstr("a map of 16383 texels"));
    EXPECT_THAT(fault([](Bsp &bsp) { bsp.rnm->header.pageCount = 2; }), HasSubstr("pageCount is 2"));
    EXPECT_THAT(fault([](Bsp &bsp) { bsp.rnm->pages[0].lightmapNum = -1; }), HasSubstr("lightmapNum -1"));
    EXPECT_THAT(fault([](Bsp &bsp) { bsp.rnm->header.side = 100; }), HasSubstr("not whole pages of that side"));
    EXPECT_THAT(fault([](Bsp &bsp) {
                    bsp.rnm->pages.push_back(bsp.rnm->pages[0]);
                    bsp.rnm->header.pageCount = 2;
                }),
                HasSubstr("two pages have lightmapNum 1"));
    EXPECT_THAT(fault([](Bsp &bsp) { bsp.rnm->pages.clear(), bsp.rnm->header.pageCount = 0; }), HasSubstr("no pages"));
    Bsp named = SampleBsp();
    named.bspx = {{"LIGHTING_RNM", {}}};
    KeptLog listener;
    EXPECT_THAT(ErrorOf([&] { ValidateBsp(named, "x", listener.log); }), HasSubstr("belongs to HDR light"));
}

} // namespace
