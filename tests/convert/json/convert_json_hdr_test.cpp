// GPL-2.0-or-later. HDR light as JSON, in -info and as pictures.
#include "libs/math/packed_color.h"
#include "q3map2/convert/bsp_info.h"
#include "q3map2/convert/preview/tone_picture.h"
#include "tests/convert/json/json_fixture.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace q3::test {

namespace {

using testing::HasSubstr;

/// FullBsp, whose one page has HDR light, as have its vertices; maps of basis vectors for the page.
Bsp HdrBsp() {
    Bsp bsp = FullBsp(GridSHContainer::Bspx);
    for (std::uint32_t i = 0; i < 128 * 128; ++i)
        bsp.lightmapsE5bgr9.push_back(i * 2654435761u);
    bsp.lightmapsE5bgr9[0] = EncodeE5bgr9({1, 0.5f, 4});
    for (std::uint32_t i = 0; i < bsp.drawVerts.size(); ++i)
        bsp.vertexE5bgr9.push_back(0xFFFFFFFFu - i);
    RnmLightmaps &rnm = bsp.rnm.emplace();
    rnm.header.side = 128;
    rnm.header.pageCount = 1;
    rnm.pages.resize(1);
    for (std::uint32_t k = 0; k < 3; ++k)
        rnm.pages[0].maps[k].assign(128 * 128, k + 7);
    return bsp;
}

/// The same as far as that is without lightmaps in the file: RNM pages of 2 x 2.
Bsp SmallHdrBsp() {
    Bsp bsp = HdrBsp();
    bsp.lightmaps.clear();
    bsp.rnm->header.side = 2;
    for (std::vector<std::uint32_t> &map : bsp.rnm->pages[0].maps)
        map.resize(4);
    return bsp;
}

class HdrJsonTest : public JsonTest {
  protected:
    /// The message of packing after `from` became `to` in a file.
    std::string FaultAfter(std::string_view file, std::string_view from, std::string_view to) {
        return JsonTest::FaultAfter(SmallHdrBsp(), file, from, to);
    }
};

TEST_F(HdrJsonTest, GivesTheSameBytes) {
    Unpack(HdrBsp());
    EXPECT_EQ(Bytes(Pack()), Bytes(HdrBsp()));
    Bsp bsp = SmallHdrBsp();
    bsp.gridSHContainer = GridSHContainer::Lump;
    bsp.vertexE5bgr9.clear();
    bsp.rnm->header.storage = RnmStorage::Rescaled;
    bsp.rnm->pages[0].lightmapNum = 12;
    Unpack(bsp);
    EXPECT_EQ(Bytes(Pack()), Bytes(bsp));
    EXPECT_FALSE(std::filesystem::exists(folder_.Path() / "DrawVertE5BGR9.json")) << "of the map before";
}

TEST_F(HdrJsonTest, ColorsAreMantissasAndExponent) {
    Unpack(SmallHdrBsp());
    // The largest channel, 4, is 256 * 2^(18 - 24): 1 is 64 of these steps.
    EXPECT_THAT(Text("LightTexelsE5BGR9.json"),
                testing::StartsWith("{\n    \"colors\": [\n        [64, 32, 256, 18],\n"));
    EXPECT_THAT(Text("DrawVertE5BGR9.json"), HasSubstr("[\n        [511, 511, 511, 31],\n        [510, 511, 511, 31]"));
    EXPECT_THAT(
        Text("LightTexelsRNM.json"),
        testing::StartsWith("{\n    \"storage\": \"raw\",\n    \"side\": 2,\n    \"lightmapNums\": [\n        0\n"
                            "    ],\n    \"colors\": [\n        [7, 0, 0, 0],\n"));
    EXPECT_THAT(Text("bspx.json"), HasSubstr("\"LIGHTING_E5BGR9\",\n        \"file\": \"LightTexelsE5BGR9.json\""));
}

TEST_F(HdrJsonTest, FaultsNameTheFileAndTheMember) {
    const std::string_view lightmaps = "LightTexelsE5BGR9.json", rnm = "LightTexelsRNM.json";
    EXPECT_THAT(FaultAfter(lightmaps, "[64, 32, 256, 18]", "[512, 32, 256, 18]"),
                testing::AllOf(HasSubstr(lightmaps), HasSubstr("colors[0]: expected three mantissas in 0..511")));
    EXPECT_THAT(FaultAfter(lightmaps, "[64, 32, 256, 18]", "[64, 32, 256, 32]"), HasSubstr("exponent in 0..31"));
    EXPECT_THAT(FaultAfter(lightmaps, "[64, 32, 256, 18]", "[64, 32, -1, 18]"), HasSubstr("colors[0]"));
    EXPECT_THAT(FaultAfter(lightmaps, "[64, 32, 256, 18]", "[64, 32, 256]"), HasSubstr("expected 4 integers"));
    EXPECT_THAT(FaultAfter(lightmaps, "[64, 32, 256, 18],", ""),
                HasSubstr("LIGHTING_E5BGR9: 16383 texels are not a multiple of 16384"));
    EXPECT_THAT(FaultAfter(lightmaps, "colors", "others"), HasSubstr("colors: missing or empty"));
    EXPECT_THAT(FaultAfter(rnm, "\"raw\"", "\"rare\""), HasSubstr("storage: expected \"raw\" or \"rescaled\""));
    EXPECT_THAT(FaultAfter(rnm, "2,", "3,"), HasSubstr("expected 1 pages x 3 x 3 x 3, found 12"));
    EXPECT_THAT(FaultAfter(rnm, "2,", "-1,"), HasSubstr("side: expected an integer in 0..16384"));
    EXPECT_THAT(FaultAfter(rnm, "        0\n", "        -1\n"), HasSubstr("lightmapNums: expected an integer in 0.."));
    EXPECT_THAT(FaultAfter("bspx.json", "LightTexelsRNM.json", "../x.json"),
                HasSubstr("expected the file LightTexelsRNM.json"));
}

TEST(HdrInfo, ListsTheLumps) {
    KeptLog log;
    PrintBspInfo("x.bsp", HdrBsp(), 0, log.log);
    EXPECT_THAT(log.text, HasSubstr("        1 HDR lightmaps      65536\n"));
    EXPECT_THAT(log.text, HasSubstr("        4 HDR vertices          16\n"));
    EXPECT_THAT(log.text, HasSubstr("        1 RNM lightmaps     196632\n"));
    EXPECT_THAT(log.text, HasSubstr("128 x 128 texels for each of three basis vectors, raw\n"));
}

std::array<int, 3> Shown(const Vec3f &color, const ToneMapOptions &options) {
    const Image picture = ToneMapped({1, 1, {color}}, options);
    EXPECT_EQ(picture.rgba[3], 255);
    return {picture.rgba[0], picture.rgba[1], picture.rgba[2]};
}

TEST(ToneMap, ClampShowsLightUpToOneAsSrgb) {
    const ToneMapOptions clamp{.toneOperator = "clamp"};
    EXPECT_EQ(Shown({1, 0.5f, 0}, clamp), (std::array{255, 188, 0}));
    EXPECT_EQ(Shown({0.21586f, 0.002f, 0.0331f}, clamp), (std::array{128, 7, 51}));
    EXPECT_EQ(Shown({4, 2, 0}, clamp), (std::array{255, 188, 0})) << "the hue stays";
    EXPECT_EQ(Shown({0.25f, 0, 0.125f}, {.exposure = 2, .toneOperator = "clamp"}), (std::array{255, 0, 188}));
    EXPECT_EQ(Shown({4, 2, 0}, {.exposure = -2, .toneOperator = "clamp"}), (std::array{255, 188, 0}));
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    EXPECT_EQ(Shown({nan, -1, 1}, clamp), (std::array{0, 0, 255}));
    EXPECT_EQ(Shown({infinity, 1, 0}, clamp), (std::array{255, 0, 0}));
}

TEST(ToneMap, FilmicKeepsRatiosAndDifferences) {
    const ToneMapOptions filmic{};
    const auto linear = [](int byte) {
        const double c = byte / 255.0;
        return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    };
    int last = -1;
    for (const float light : {0.0f, 0.1f, 0.5f, 1.0f, 2.0f, 4.0f, 8.0f}) {
        const auto shown = Shown({light, light / 2, light / 4}, filmic);
        EXPECT_GT(shown[0], last) << light;
        last = shown[0];
        EXPECT_NEAR(linear(shown[1]), linear(shown[0]) / 2, 0.005) << light;
        EXPECT_NEAR(linear(shown[2]), linear(shown[0]) / 4, 0.005) << light;
    }
    // (2.51 + 0.03) / (2.43 + 0.59 + 0.14) = 0.8038, which sRGB shows as 231.6.
    EXPECT_EQ(Shown({1, 1, 1}, filmic), (std::array{232, 232, 232}));
    EXPECT_EQ(Shown({1e38f, 0, 1e38f}, filmic), (std::array{255, 0, 255}));
    EXPECT_EQ(Shown({}, filmic), (std::array{0, 0, 0}));
}

} // namespace

} // namespace q3::test
