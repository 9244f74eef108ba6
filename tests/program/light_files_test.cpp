// GPL-2.0-or-later. Which lumps and files the light stage makes for HDR light, basis maps and Lightmass's layout.
#include "common/files/files.h"
#include "common/image/image.h"
#include "libs/math/packed_color.h"
#include "tests/program/lit_room.h"

#include <gmock/gmock.h>

#include <set>

namespace q3::test {

namespace {

constexpr std::size_t kLightmapsLump = 14, kEntitiesLump = 0, kLumps = 17;
constexpr std::size_t kAnySize = 0;
constexpr std::size_t kTga = 18 + 3 * kPageTexels, kMassColor = 18 + 4 * kPageTexels, kMassGray = 18 + kPageTexels;
constexpr std::size_t kPfm = 3 + 8 + 5 + 12 * kPageTexels; // "PF\n", "128 128\n", "-1.0\n"
constexpr std::size_t kIoquake3 = 196608;

class LightFilesTest : public LitRoomTest {
  protected:
    LightFilesTest() {
        Compile(Lamp({-120, 40, 60}, 200, {1, 0.25f, 0.5f}, {{"targetname", "lamp1"}}) +
                    Lamp({100, -60, 120}, 200, {0.25f, 1, 0.5f}),
                {{"ambient", "5"}}, BoxText({-8, -96, 0}, {8, 96, 96}, "test/pillar"));
    }
    struct Expected {
        std::size_t bytes = 0, hdrTexels = 0; ///< of lump 14 and LIGHTING_E5BGR9
        bool vertices = false;                ///< VERTEX_E5BGR9
        std::vector<int> rnm{};               ///< lightmapNum of the pages of LIGHTING_RNM
        std::map<std::string, std::size_t> files{};
    };
    void ExpectOutput(std::string_view options, const Expected &expected) {
        SCOPED_TRACE(options);
        std::filesystem::remove_all(Beside(""));
        Light(options);
        const Bsp bsp = Load();
        EXPECT_EQ(bsp.lightmaps.size(), expected.bytes);
        EXPECT_EQ(bsp.lightmapsE5bgr9.size(), expected.hdrTexels);
        EXPECT_EQ(bsp.vertexE5bgr9.size(), expected.vertices ? bsp.drawVerts.size() : 0);
        std::vector<int> pages;
        if (bsp.rnm)
            for (const auto &page : bsp.rnm->pages)
                pages.push_back(page.lightmapNum);
        EXPECT_EQ(pages, expected.rnm);
        auto files = Files();
        std::map<std::string, std::size_t> sizes = expected.files;
        for (auto &[name, size] : sizes)
            if (size == kAnySize && files.contains(name))
                size = files[name];
        EXPECT_EQ(files, sizes);
    }
    /// Runs -light and expects no warning.
    void LightQuietly(std::string_view options) {
        const Outcome outcome = Light(options);
        EXPECT_FALSE(outcome.Printed("WARNING")) << outcome.text;
    }
    std::size_t VertexFileSize() const { return 12 * Load().drawVerts.size(); }
};

TEST_F(LightFilesTest, Range) {
    constexpr std::size_t kPage = 3 * kPageTexels;
    ExpectOutput("", {.bytes = kPage});
    ExpectOutput("-ldr", {.bytes = kPage});
    ExpectOutput("-both", {.bytes = kPage, .hdrTexels = kPageTexels, .vertices = true});
    ExpectOutput("-hdr", {.hdrTexels = kPageTexels, .vertices = true});
    ExpectOutput("-hdr -ldr", {.bytes = kPage});
    ExpectOutput("-ldr -hdrfiles pfm", {.bytes = kPage});
    ExpectOutput("-both -deluxe", {.bytes = 2 * kPage, .hdrTexels = 2 * kPageTexels, .vertices = true});
    const Bsp deluxe = Load();
    EXPECT_TRUE(std::all_of(deluxe.lightmapsE5bgr9.begin() + kPageTexels, deluxe.lightmapsE5bgr9.end(),
                            [](std::uint32_t code) { return code == 0; }));
}

TEST_F(LightFilesTest, LightThatIsNotMadeAgainIsNamed) {
    Light("-both -rnmall -shbspx -shadaptive -ambientcubes -gridsh 128 128 128 -cubesperleaf 1");
    const std::string again = Light("-onlygrid -shbspx -gridsh 128 128 128").text;
    EXPECT_THAT(again, testing::Not(testing::HasSubstr("the SH light grid of the map")));
    EXPECT_THAT(again, testing::Not(testing::HasSubstr("LIGHTING_E5BGR9")));
    EXPECT_THAT(again, testing::HasSubstr("-shadaptive makes one"));
    EXPECT_THAT(again, testing::HasSubstr("the AMBIENT_CUBES of the map ("));
    const std::string plain = Light("").text;
    for (const char *text : {"-shbspx makes one", "the LIGHTING_E5BGR9 of the map (65.5 KB) will be dropped",
                             "the VERTEX_E5BGR9", "the LIGHTING_RNM"})
        EXPECT_THAT(plain, testing::HasSubstr(text));
    EXPECT_THAT(Light("").text, testing::Not(testing::HasSubstr("will be dropped")));
}

TEST_F(LightFilesTest, HdrFiles) {
    const std::size_t vertices = VertexFileSize();
    const Expected both{.bytes = 3 * kPageTexels, .hdrTexels = kPageTexels, .vertices = true};
    const auto with = [&](std::map<std::string, std::size_t> files) {
        Expected all = both;
        all.files = std::move(files);
        return all;
    };
    ExpectOutput("-hdrfiles rend2", with({{"lm_0000.hdr", kAnySize}, {"vertlight.raw", vertices}}));
    ExpectOutput("-hdrfiles ioquake3", with({{"lm_0000.hdr", kIoquake3}, {"vertlight.raw", vertices}}));
    ExpectOutput("-hdrfiles pfm", with({{"lm_0000.pfm", kPfm}}));
    ExpectOutput("-hdrfiles PFM", with({{"lm_0000.pfm", kPfm}}));
    if (HasOpenExr())
        ExpectOutput("-hdrfiles exr", with({{"lm_0000.exr", kAnySize}}));
    Expected deluxe = with({{"lm_0000.pfm", kPfm}});
    deluxe.bytes *= 2, deluxe.hdrTexels *= 2;
    ExpectOutput("-hdrfiles pfm -deluxe", deluxe);
    // Engines replace 8-bit lightmaps that the map has.
    EXPECT_TRUE(Light("-hdr -hdrfiles rend2").Printed("8-bit lightmaps"));
    EXPECT_TRUE(Light("-hdr -deluxe").Printed("light directions belong to 8-bit lightmaps"));
    EXPECT_EQ(Load().lightmapsE5bgr9.size(), kPageTexels);
    EXPECT_TRUE(Light("-hdr -hdrfiles rend2").Printed("8-bit lightmaps"));
    EXPECT_EQ(Load().lightmaps.size(), 3 * kPageTexels);
}

TEST_F(LightFilesTest, BasisMaps) {
    ExpectOutput("-rnmall", {.bytes = 3 * kPageTexels, .rnm = {0}});
    ExpectOutput("-rnmall -hdr", {.hdrTexels = kPageTexels, .vertices = true, .rnm = {0}});
    ExpectOutput("-rnmall -deluxe", {.bytes = 6 * kPageTexels, .rnm = {0}});
    ExpectOutput(
        "-rnmall -hdrfiles pfm",
        {.bytes = 3 * kPageTexels,
         .hdrTexels = kPageTexels,
         .vertices = true,
         .rnm = {0},
         .files = {
             {"lm_0000.pfm", kPfm}, {"lm_0000_b1.pfm", kPfm}, {"lm_0000_b2.pfm", kPfm}, {"lm_0000_b3.pfm", kPfm}}});
    for (const std::string_view debug :
         {"-debugnormals", "-debugaxis", "-debugcluster", "-debugorigin", "-debugsurfaces", "-normalmap", "-dirtdebug"})
        ExpectOutput(fmt::format("-rnmall -lightmass {}", debug), {.bytes = 3 * kPageTexels});
}

TEST_F(LightFilesTest, Lightmass) {
    const std::map<std::string, std::size_t> always{
        {"lightmass.json", kAnySize},         {"lm_0000_coverage.tga", kMassGray},
        {"lm_0000_hq_color.tga", kMassColor}, {"lm_0000_hq_direction.tga", kMassColor},
        {"lm_0000_lq_color.tga", kMassColor}, {"lm_0000_lq_direction.tga", kMassColor}};
    auto all = always;
    all["lm_0000_ao.tga"] = all["lm_0000_shadow_lamp1.tga"] = kMassGray;
    all["lm_0000_sky_occlusion.tga"] = kMassColor;
    ExpectOutput("-lightmass", {.bytes = 3 * kPageTexels, .files = always});
    ExpectOutput("-dirty -skyocclusion -shadowmap lamp1", {.bytes = 3 * kPageTexels, .files = all});
    ExpectOutput("-dirty -skyocclusion -shadowmap lamp1 -shadowmap lamp1 -deluxe -hdr",
                 {.hdrTexels = kPageTexels, .vertices = true, .files = all});
    EXPECT_EQ(Lightmass().at("shadowLights"), nlohmann::json({"lamp1"}));
}

TEST_F(LightFilesTest, ExternalPages) {
    ExpectOutput(
        "-external -rnmall",
        {.rnm = {},
         .files = {
             {"lm_0000.tga", kTga}, {"lm_0000_b1.tga", kTga}, {"lm_0000_b2.tga", kTga}, {"lm_0000_b3.tga", kTga}}});
    ExpectOutput("-external -hdr -rnmall", {.vertices = true,
                                            .files = {{"lm_0000.hdr", kAnySize},
                                                      {"lm_0000_b1.hdr", kAnySize},
                                                      {"lm_0000_b2.hdr", kAnySize},
                                                      {"lm_0000_b3.hdr", kAnySize}}});
    ExpectOutput(
        "-external -both -deluxe",
        {.vertices = true, .files = {{"lm_0000.tga", kTga}, {"lm_0001.tga", kTga}, {"lm_0000.hdr", kAnySize}}});
    constexpr std::size_t kLarge = 18 + 3 * 4 * kPageTexels;
    ExpectOutput("-lightmapsize 256 -both", {.vertices = true, //
                                             .files = {{"lm_0000.tga", kLarge}, {"lm_0000.hdr", kAnySize}}});
    ExpectOutput("-lightmapsize 256 -hdrfiles pfm",
                 {.vertices = true, .files = {{"lm_0000.tga", kLarge}, {"lm_0000.pfm", kPfm + 36 * kPageTexels}}});
}

TEST_F(LightFilesTest, OwnFilesAreNotOld) {
    LightQuietly("-external -both");
    LightQuietly("-external -both");
    LightQuietly("-hdrfiles rend2");
}

TEST_F(LightFilesTest, PagesOfAnotherSizeHaveGeneratedShaders) {
    ExpectOutput("-extlmhacksize 256 -rnmall -both", {.vertices = true,
                                                      .files = {{"lm_0000.tga", 18 + 12 * kPageTexels},
                                                                {"lm_0000.hdr", kAnySize},
                                                                {"lm_0000_b1.tga", 18 + 12 * kPageTexels},
                                                                {"lm_0000_b2.tga", 18 + 12 * kPageTexels},
                                                                {"lm_0000_b3.tga", 18 + 12 * kPageTexels},
                                                                {"lm_0000_b1.hdr", kAnySize},
                                                                {"lm_0000_b2.hdr", kAnySize},
                                                                {"lm_0000_b3.hdr", kAnySize}}});
    const std::string script = folder_.ReadBack("base/baseq3/scripts/q3map2_room.shader");
    EXPECT_THAT(script, testing::HasSubstr("q3map_rnmMaps maps/room/lm_0000_b1 maps/room/lm_0000_b2 "
                                           "maps/room/lm_0000_b3 rescaled\n"));
    EXPECT_TRUE(Light("-extlmhacksize 256 -hdrfiles ioquake3").Printed("of 128 x 128 only, not of 256 x 256"));
}

TEST_F(LightFilesTest, EightBitLightIsThatOfAPlainBake) {
    for (const std::string_view more : {"", "-deluxe ", "-bounce 1 "}) {
        const std::string plain(more);
        Light(plain);
        const auto before = MapBytes();
        for (const std::string_view option : {"-both", "-hdrfiles pfm"}) {
            Light(plain + std::string(option));
            const auto after = MapBytes();
            for (std::size_t lump = kEntitiesLump + 1; lump < kLumps; ++lump)
                EXPECT_EQ(LumpOf(after, lump), LumpOf(before, lump)) << option << " lump " << lump;
        }
    }
}

/// Directional channels forbid twins and solid lightmaps; without those, the bytes stay.
TEST_F(LightFilesTest, DirectionalLightLeavesTheBytes) {
    Light("-nocollapse");
    const auto before = LumpOf(MapBytes(), kLightmapsLump);
    Light("-nocollapse -rnmall -lightmass -skyocclusion -shadowmap lamp1");
    EXPECT_EQ(LumpOf(MapBytes(), kLightmapsLump), before);
}

/// Surfaces with basis maps have pages of their own.
TEST_F(LightFilesTest, ShadersAndImagesChooseBasisMaps) {
    using Bytes = std::vector<std::uint8_t>;
    for (const auto &[name, color] :
         {std::pair{"rough", Bytes{9, 9, 9}}, {"rough_n", {128, 128, 255}}, {"smooth", {9, 9, 9}}})
        folder_.Write(fmt::format("base/baseq3/textures/test/{}.tga", name),
                      EncodeTga(color, 1, 1, 3, TgaRows::TopFirst));
    Compile(Lamp({-120, 40, 60}, 200), {{"ambient", "5"}},
            BoxText({-8, -96, 0}, {8, 96, 96}, "test/pillar") + BoxText({60, 60, 0}, {120, 120, 40}, "test/rough") +
                BoxText({60, -120, 0}, {120, -60, 40}, "test/smooth"));
    Light("-rnm");
    const Bsp bsp = Load();
    ASSERT_TRUE(bsp.rnm);
    std::set<int> pages;
    for (const auto &page : bsp.rnm->pages)
        pages.insert(page.lightmapNum);
    std::map<std::string, bool> mapped;
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
        const bool basis = pages.contains(surface.lightmapNum[0]);
        const std::string shader(FieldName(bsp.shaders[std::size_t(surface.shaderNum)].shader));
        EXPECT_EQ(mapped.try_emplace(shader, basis).first->second, basis) << shader;
    }
    const std::map<std::string, bool> expected{{"textures/test/wall", true},    {"textures/test/ceiling", true},
                                               {"textures/test/rough", true},   {"textures/test/smooth", false},
                                               {"textures/test/pillar", false}, {"textures/test/floor", false}};
    EXPECT_EQ(mapped, expected);
}

TEST_F(LightFilesTest, LightingAgainRemovesLumpsAndWarnsOfFiles) {
    Light("-rnmall -rnmstorage raw -hdrfiles rend2");
    EXPECT_THAT(Load().entities, testing::HasSubstr("\"_q3map2_rnm\" \"raw\""));
    EXPECT_EQ(Load().rnm->header.storage, RnmStorage::Raw);
    Light("-rnmall -hdrfiles rend2");
    EXPECT_THAT(Load().entities, testing::HasSubstr("\"_q3map2_rnm\" \"rescaled\""));
    EXPECT_EQ(Load().rnm->header.storage, RnmStorage::Rescaled);
    const Outcome outcome = Light("");
    EXPECT_TRUE(outcome.Printed("lm_0000.hdr: left by an earlier run"));
    EXPECT_TRUE(outcome.Printed("old HDR light: 2)"));
    std::filesystem::remove(Beside("lm_0000.hdr"));
    EXPECT_TRUE(Light("").Printed("vertlight.raw: left by an earlier run"));
    const Bsp plain = Load();
    EXPECT_TRUE(plain.lightmapsE5bgr9.empty() && plain.vertexE5bgr9.empty() && !plain.rnm);
    EXPECT_THAT(plain.entities, testing::Not(testing::HasSubstr("_q3map2_rnm")));
    std::filesystem::remove_all(Beside(""));
    LightQuietly("");
}

/// Engines read three bytes past the floats of the last texel.
TEST_F(LightFilesTest, LastTexelOfIoquake3sPagesIsUnused) {
    Compile(Lamp({0, 0, 100}, 200), {{"ambient", "50"}, {"_lightmapscale", "0.25"}});
    Light("-nocollapse -slowallocate -hdrfiles ioquake3");
    const Bsp bsp = Load();
    const std::size_t pages = bsp.lightmapsE5bgr9.size() / kPageTexels;
    EXPECT_GE(pages, 4u);
    std::size_t used = 0;
    for (std::size_t page = 0; page < pages; ++page) {
        EXPECT_EQ(Files().at(fmt::format("lm_{:04}.hdr", page)), kIoquake3);
        EXPECT_EQ(bsp.lightmapsE5bgr9[(page + 1) * kPageTexels - 1], 0u) << "page " << page;
        used += bsp.lightmapsE5bgr9[page * kPageTexels] != 0;
    }
    EXPECT_EQ(used, pages) << "ambient light reaches every used texel";
}

TEST_F(LightFilesTest, ShadowMapsAreNamedLikeLights) {
    const Outcome outcome = Run("-shadowmap a/b");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.Printed("-shadowmap a/b")) << outcome.text;
    EXPECT_TRUE(Files().empty());
    EXPECT_TRUE(Light("-shadowmap nobody").Printed("-shadowmap nobody: no light has this targetname"));
}

/// Styles have pages or places of their own, each with HDR light, basis maps and coefficients.
TEST_F(LightFilesTest, LightStyles) {
    Compile(Lamp({-120, 40, 60}, 200) + Lamp({100, -60, 120}, 200, {0.25f, 1, 0.5f}, {{"style", "3"}}),
            {{"ambient", "5"}});
    Light("-both -rnmall -lightmass");
    const Bsp bsp = Load();
    std::set<int> styles;
    std::size_t lit = 0;
    const auto json = Lightmass();
    for (const auto &place : json.at("lightmaps")) {
        styles.insert(int(place.at("style")));
        const std::size_t number = json["pages"][std::size_t(place["page"])]["lightmapNum"];
        const std::size_t at = number * kPageTexels +
                               (std::size_t(place["y"]) + std::size_t(place["height"]) / 2) * 128 +
                               std::size_t(place["x"]) + std::size_t(place["width"]) / 2;
        const Vec3f light = DecodeE5bgr9(bsp.lightmapsE5bgr9.at(at));
        lit += place["style"] == 3 && light.y > 2 * light.x;
    }
    EXPECT_EQ(styles, (std::set<int>{0, 3}));
    EXPECT_GE(lit, 3u) << "green light of the style";
    EXPECT_EQ(bsp.rnm->pages.size(), bsp.lightmapsE5bgr9.size() / kPageTexels);
}

TEST_F(LightFilesTest, ThreadsDoNotMatter) {
    const std::string options = "-both -rnmall -lightmass -skyocclusion -shadowmap lamp1 -dirty -bounce 1 -threads ";
    Compile(Lamp({-120, 40, 60}, 200, {1, 0.25f, 0.5f}, {{"targetname", "lamp1"}}), {{"ambient", "5"}},
            DiamondText({100, 100, 0}, 40, 80, "test/pillar"));
    const auto bake = [&](const std::string &words) {
        std::filesystem::remove_all(Beside(""));
        Light(words);
        Bsp bsp = Load();
        bsp.entities.clear(); // holds the command
        KeptLog quiet;
        WriteBspFile(Beside("all.bsp"), bsp, {}, quiet.log);
        std::map<std::string, std::vector<std::byte>> files;
        for (const auto &[name, size] : Files())
            files[name] = ReadFile(Beside(name));
        return files;
    };
    for (const std::string_view more : {"", " -external"}) {
        const auto first = bake(fmt::format("{}1{}", options, more)),
                   second = bake(fmt::format("{}3{}", options, more));
        EXPECT_EQ(first.size(), more.empty() ? 10u : 18u);
        EXPECT_TRUE(first == second) << more;
    }
}

} // namespace

} // namespace q3::test
