// GPL-2.0-or-later. HDR light of lightmap pages as images.
#include "common/error.h"
#include "common/files/files.h"
#include "common/image/float_image.h"
#include "libs/math/packed_color.h"
#include "q3map2/lightmap/store/hdr_store.h"
#include "q3map2/lightmap/store/lightmap_pages.h"
#include "tests/support/game_folder.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>

namespace q3::test {

namespace {

constexpr int kPageSide = 32;

/// Two pages, and maps of basis vectors for the second.
Bsp HdrPages() {
    Bsp bsp;
    const auto fill = [](std::vector<std::uint32_t> &codes, std::size_t count, float scale) {
        for (std::size_t i = 0; i < count; ++i)
            codes.push_back(EncodeE5bgr9({scale * float(i % 37), scale * float(i / kPageSide), 4}));
    };
    fill(bsp.lightmapsE5bgr9, 2 * kPageSide * kPageSide, 0.11f);
    bsp.rnm.emplace().header = {.side = kPageSide, .pageCount = 1};
    bsp.rnm->pages = {{1, {}}};
    for (std::size_t k = 0; k < 3; ++k)
        fill(bsp.rnm->pages[0].maps[k], kPageSide * kPageSide, float(k + 1));
    bsp.lightmaps.resize(2 * 3 * kPageSide * kPageSide);
    return bsp;
}

Bsp Darkened(Bsp bsp) {
    std::ranges::fill(bsp.lightmapsE5bgr9, 0u);
    for (auto &map : bsp.rnm->pages[0].maps)
        std::ranges::fill(map, 0u);
    return bsp;
}

std::vector<std::string> FormatsHere() {
    std::vector<std::string> formats = {"pfm", "hdr", "exp32"};
    if (HasOpenExr())
        formats.push_back("exr");
    return formats;
}

/// Largest error as a part of the largest channel.
float WorstError(const std::vector<std::uint32_t> &a, const std::vector<std::uint32_t> &b) {
    float worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Vec3f x = DecodeE5bgr9(a[i]), y = DecodeE5bgr9(b[i]);
        for (std::size_t k = 0; k < 3; ++k)
            worst = std::max(worst, std::abs(x[k] - y[k]) / MaxComponent(x));
    }
    return worst;
}

TEST(HdrPagesTest, ExportThenImportKeepsTheLight) {
    const Bsp before = HdrPages();
    for (const std::string &format : FormatsHere()) {
        const GameFolder game;
        KeptLog log;
        ExportLightmaps(before, kPageSide, game / "room", log.log, {format});
        for (const bool named : {true, false}) {
            Bsp after = Darkened(before);
            ImportLightmaps(after, kPageSide, game / "room", log.log, {named ? format : ""});
            if (format == "pfm" || format == "exr") {
                EXPECT_EQ(after.lightmapsE5bgr9, before.lightmapsE5bgr9) << format;
                EXPECT_EQ(after.rnm->pages[0].maps, before.rnm->pages[0].maps) << format;
            }
            // Half a step of 8 bits, and half a step of 9 bits when it is stored again.
            const float bound = 1.0f / 256 + 1.0f / 512;
            EXPECT_LE(WorstError(before.lightmapsE5bgr9, after.lightmapsE5bgr9), bound) << format;
            EXPECT_LE(WorstError(before.rnm->pages[0].maps[2], after.rnm->pages[0].maps[2]), bound) << format;
            EXPECT_EQ(DecodeE5bgr9(after.lightmapsE5bgr9[0]).z, 4.0f) << format;
        }
        EXPECT_EQ(log.log.WarningCount("HDR lightmap images"), 0);
    }
}

/// The files that engines load come back, with the light of vertices.
TEST(HdrPagesTest, EngineFilesAreExportedAndImported) {
    Bsp before;
    before.lightmaps.resize(kLightmapPageBytes);
    for (int i = 0; i < 128 * 128; ++i)
        before.lightmapsE5bgr9.push_back(EncodeE5bgr9({float(i % 128) / 32, 4, 0}));
    before.drawVerts.resize(3);
    before.vertexE5bgr9 = {EncodeE5bgr9({4, 2, 1}), EncodeE5bgr9({0, 0, 0}), EncodeE5bgr9({0.5f, 16, 1})};
    for (const std::string format : {"rend2", "ioquake3"}) {
        const GameFolder game;
        KeptLog log;
        ExportLightmaps(before, 128, game / "room", log.log, {format});
        const std::string vertices = game.ReadBack("room/vertlight.raw");
        ASSERT_EQ(vertices.size(), 36u);
        float first = 0;
        std::memcpy(&first, vertices.data(), sizeof first);
        EXPECT_EQ(first, format == "rend2" ? 4 : 4 * 255) << format;
        EXPECT_TRUE(std::filesystem::exists(game / "room/lm_0000.hdr"));
        Bsp after = before;
        std::ranges::fill(after.lightmapsE5bgr9, 0u);
        std::ranges::fill(after.vertexE5bgr9, 0u);
        ImportLightmaps(after, 128, game / "room", log.log, {""}); // not by itself: the name does not tell the engine
        EXPECT_EQ(after.lightmapsE5bgr9[7], 0u);
        ImportLightmaps(after, 128, game / "room", log.log, {format});
        EXPECT_EQ(after.vertexE5bgr9, before.vertexE5bgr9) << format;
        EXPECT_LE(WorstError(before.lightmapsE5bgr9, after.lightmapsE5bgr9),
                  format == "rend2" ? 1.0f / 256 + 1.0f / 512 : 0)
            << format;
    }
}

/// Pages of light styles that a generated shader names are images beside the file, and stay in it.
TEST(HdrPagesTest, PagesWithAnImageStayInTheFile) {
    LightmapOptions options;
    options.hdr = true;
    StoredLightmaps stored;
    for (int i = 0; i < 3; ++i) {
        LightmapPage &page = stored.pages.emplace_back();
        page.number = i < 2 ? i : -1; // the last is a page that the file cannot hold
        page.needsImage = i > 0;
        page.light.assign(page.Texels(), Vec3f{float(i + 1), 0, 0});
        page.basis.fill(page.light);
    }
    Bsp bsp;
    StoreHdrLight(options, stored, bsp);
    ASSERT_EQ(bsp.lightmapsE5bgr9.size(), 2u * 128 * 128);
    EXPECT_EQ(DecodeE5bgr9(bsp.lightmapsE5bgr9.back()), (Vec3f{2, 0, 0}));
    ASSERT_EQ(bsp.rnm->pages.size(), 2u);
    EXPECT_EQ(bsp.rnm->pages[1].lightmapNum, 1);
    options.external = true;
    Bsp other;
    StoreHdrLight(options, stored, other);
    EXPECT_TRUE(other.lightmapsE5bgr9.empty());
    EXPECT_FALSE(other.rnm);
}

TEST(HdrPagesTest, PicturesHaveTheFirstRowBelowAndListsAbove) {
    const GameFolder game;
    KeptLog log;
    const Bsp bsp = HdrPages();
    for (const char *format : {"pfm", "exp32"})
        ExportLightmaps(bsp, kPageSide, game / "room", log.log, {format});
    const FloatImage picture = ReadFloatImage(game / "room/lightmap_0001_b3.pfm");
    const auto list = nlohmann::json::parse(game.ReadBack("room/lightmap_0001_b3.exp32.json"));
    EXPECT_EQ(list.at("width"), kPageSide);
    for (int y = 0; y < kPageSide; ++y)
        for (int x = 0; x < kPageSide; ++x) {
            const Vec3f stored = DecodeE5bgr9(bsp.rnm->pages[0].maps[2][std::size_t(y * kPageSide + x)]);
            EXPECT_EQ(picture.Texel(x, kPageSide - 1 - y), stored);
            const auto &texel = list.at("texels").at(std::size_t(y * kPageSide + x));
            for (std::size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(std::ldexp(texel.at(k).get<double>(), texel.at(3).get<int>()) / 255, double(stored[k]),
                            double(MaxComponent(stored)) / 250);
        }
    EXPECT_EQ(list.at("texels").at(0), nlohmann::json({0, 0, 255, 2})) << "4 is 255 * 2^2";
}

TEST(HdrPagesTest, OnlyImagesThatAreThereAndFitAreTaken) {
    const GameFolder game;
    KeptLog log;
    const Bsp before = HdrPages();
    ExportLightmaps(before, kPageSide, game / "room", log.log, {"pfm"});
    std::filesystem::remove(game / "room/lightmap_0000.pfm");
    WriteFloatImage(game / "room/lightmap_0001_b2.pfm", {1, 1, {{1, 1, 1}}});
    WriteFloatImage(game / "room/lightmap_0001.hdr", {1, 1, {{1, 1, 1}}});
    Bsp after = Darkened(before);
    ImportLightmaps(after, kPageSide, game / "room", log.log);
    EXPECT_EQ(after.lightmapsE5bgr9[0], 0u);
    EXPECT_EQ(after.lightmapsE5bgr9[kPageSide * kPageSide], before.lightmapsE5bgr9[kPageSide * kPageSide]);
    EXPECT_EQ(after.rnm->pages[0].maps[1][0], 0u);
    EXPECT_EQ(after.rnm->pages[0].maps[2], before.rnm->pages[0].maps[2]);
    EXPECT_EQ(log.log.WarningCount("lightmap image size"), 1);
    EXPECT_EQ(log.log.WarningCount("HDR lightmap images"), 1) << "two formats of one page";
    EXPECT_EQ(log.log.WarningCount("lightmap image missing"), 0);
}

TEST(HdrPagesTest, LightmapsBesideTheMapCountToo) {
    const GameFolder game;
    KeptLog log;
    Bsp bsp = HdrPages();
    bsp.lightmaps.clear();
    ExportLightmaps(bsp, kPageSide, game / "room", log.log, {"hdr"});
    EXPECT_EQ(log.log.WarningCount("no lightmaps"), 0);
    EXPECT_TRUE(std::filesystem::exists(game / "room/lightmap_0001.hdr"));
    EXPECT_NO_THROW(ImportLightmaps(bsp, kPageSide, game / "room", log.log));
    EXPECT_THROW(ExportLightmaps(bsp, 48, game / "room", log.log), Error) << "no pages of that side";
}

TEST(Exp32JsonTest, FaultsAreErrors) {
    const auto fault = [](std::string_view text) -> std::string {
        try {
            DecodeExp32Json(std::as_bytes(std::span(text)), "a.json");
        } catch (const Error &error) {
            return error.what();
        }
        return "no error";
    };
    EXPECT_EQ(fault(R"({"width": 1, "height": 1, "texels": [[1, 2, 3, -128]]})"), "no error");
    EXPECT_EQ(fault("{"), "a.json: not valid JSON");
    EXPECT_EQ(fault("[]"), "a.json: width: missing");
    EXPECT_EQ(fault(R"({"width": 0})"), "a.json: width: expected an integer in 1..16384");
    EXPECT_EQ(fault(R"({"width": 1.5})"), "a.json: width: expected an integer in 1..16384");
    EXPECT_EQ(fault(R"({"width": 1, "height": 99999999999999})"), "a.json: height: expected an integer in 1..16384");
    EXPECT_EQ(fault(R"({"width": 2, "height": 1, "texels": [[1, 2, 3, 4]]})"),
              "a.json: texels: expected an array of 2 x 1");
    EXPECT_EQ(fault(R"({"width": 1, "height": 1, "texels": [[1, 2, 3]]})"),
              "a.json: texels: expected [r, g, b, exponent] for each");
    EXPECT_EQ(fault(R"({"width": 1, "height": 1, "texels": [[1, 256, 3, 4]]})"),
              "a.json: texels: expected an integer in 0..255");
    EXPECT_EQ(fault(R"({"width": 1, "height": 1, "texels": [[1, 2, 3, 128]]})"),
              "a.json: texels: expected an integer in -128..127");
}

} // namespace

} // namespace q3::test
