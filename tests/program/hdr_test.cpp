// GPL-2.0-or-later. Maps with HDR light, as a user works with them.
#include "common/files/files.h"
#include "common/image/float_image.h"
#include "common/image/image.h"
#include "libs/math/packed_color.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/run_program.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

/// The demo map with HDR light: row 0 of each page is green, the others are 4.
class HdrProgramTest : public ProgramTest {
  protected:
    HdrProgramTest() {
        Bsp bsp = Load();
        bsp.lightmaps.resize(std::max(bsp.lightmaps.size(), kLightmapPageBytes));
        bsp.lightmapsE5bgr9.assign(bsp.lightmaps.size() / 3, EncodeE5bgr9({4, 4, 4}));
        for (std::size_t i = 0; i < bsp.lightmapsE5bgr9.size(); ++i)
            if (i % (128 * 128) < 128)
                bsp.lightmapsE5bgr9[i] = EncodeE5bgr9({0, 1, 0});
        bsp.vertexE5bgr9.assign(bsp.drawVerts.size(), EncodeE5bgr9({1, 2, 3}));
        bsp.rnm.emplace().header = {.side = 128, .pageCount = 1};
        bsp.rnm->pages.resize(1);
        for (auto &map : bsp.rnm->pages[0].maps)
            map.assign(128 * 128, EncodeE5bgr9({0, 0, 2}));
        KeptLog quiet;
        WriteBspFile(Map(".bsp"), bsp, {}, quiet.log);
    }

    Bsp Load() const {
        KeptLog quiet;
        return ReadBspFile(Map(".bsp"), {}, quiet.log);
    }
    std::filesystem::path Page(std::string_view name) const { return Map("") / name; }
};

TEST_F(HdrProgramTest, InfoListsIt) {
    const Outcome outcome = RunWell("-info MAP");
    EXPECT_TRUE(outcome.Printed("HDR lightmaps"));
    EXPECT_TRUE(outcome.Printed("HDR vertices"));
    EXPECT_TRUE(outcome.Printed("RNM lightmaps"));
}

TEST_F(HdrProgramTest, EditedImagesComeBack) {
    const Bsp before = Load();
    RunWell("-export -hdrformat hdr MAP");
    EXPECT_TRUE(std::filesystem::exists(Page("lightmap_0000.tga")));
    FloatImage image = ReadFloatImage(Page("lightmap_0000.hdr"));
    EXPECT_EQ(image.Texel(5, 0), Vec3f(4, 4, 4));
    EXPECT_EQ(image.Texel(5, 127), Vec3f(0, 1, 0)) << "row 0 of the page is below";
    image.texels[0] = {8, 0, 0};
    WriteFloatImage(Page("lightmap_0000.hdr"), image);
    RunWell("-import -hdrformat hdr MAP");
    const Bsp after = Load();
    EXPECT_EQ(DecodeE5bgr9(after.lightmapsE5bgr9[127 * 128]), Vec3f(8, 0, 0));
    EXPECT_EQ(after.lightmaps, before.lightmaps);
    EXPECT_EQ(after.rnm->pages[0].maps, before.rnm->pages[0].maps);
    ExpectError("-export -hdrformat jpg MAP", "jpg");
}

TEST_F(HdrProgramTest, DefaultFormatIsExact) {
    RunWell("-export MAP");
    const auto before = MapBytes();
    EXPECT_TRUE(std::filesystem::exists(Page(HasOpenExr() ? "lightmap_0000_b2.exr" : "lightmap_0000_b2.pfm")));
    RunWell("-import MAP");
    EXPECT_EQ(MapBytes(), before);
}

TEST_F(HdrProgramTest, LightingAgainDropsIt) {
    RunWell("-light -fast -onlygrid MAP");
    EXPECT_FALSE(Load().lightmapsE5bgr9.empty()) << "the lightmaps are the same";
    RunWell("-light -fast -nogrid MAP");
    const Bsp lit = Load();
    EXPECT_TRUE(lit.lightmapsE5bgr9.empty());
    EXPECT_TRUE(lit.vertexE5bgr9.empty());
    EXPECT_FALSE(lit.rnm);
}

TEST_F(HdrProgramTest, PackedJsonIsTheSameFile) {
    const auto before = MapBytes();
    RunWell("-json MAP");
    RunWell("-json -pack MAP");
    EXPECT_EQ(ReadFile(Map("_json.bsp")), before);
}

TEST_F(HdrProgramTest, ToneMapShowsPagesAndImages) {
    const std::string png = (folder_ / "page.png").string(), tga = (folder_ / "page.tga").string();
    RunWell("-tonemap -operator clamp -exposure -2 MAP " + png);
    const Image page = DecodePng(ReadFile(png), png);
    EXPECT_EQ(page.width, 128);
    EXPECT_EQ(page.Texel(0, 0), (std::array<std::uint8_t, 4>{255, 255, 255, 255}));
    EXPECT_EQ(page.Texel(0, 127), (std::array<std::uint8_t, 4>{0, 137, 0, 255})) << "0.25 in sRGB";
    RunWell("-export -hdrformat pfm MAP");
    RunWell("-tonemap -operator clamp -exposure -2 " + Page("lightmap_0000.pfm").string() + " " + tga);
    EXPECT_EQ(DecodeTga(ReadFile(tga), tga).rgba, page.rgba) << "the same picture";
    RunWell("-tonemap MAP " + png);
    EXPECT_EQ(DecodePng(ReadFile(png), png).Texel(0, 127)[1], 232);
}

TEST_F(HdrProgramTest, ToneMapNamesWhatIsWrong) {
    const std::string png = (folder_ / "page.png").string();
    ExpectError("-tonemap MAP", "usage: q3map2 -tonemap");
    ExpectError("-tonemap -page 99 MAP " + png, "no HDR lightmap 99, expected one of 0 to");
    ExpectError("-tonemap MAP " + (folder_ / "page.jpg").string(), "expected .png or .tga");
    folder_.Write("page.gif", "GIF89a");
    ExpectError("-tonemap " + (folder_ / "page.gif").string() + " " + png, "expected hdr, exr or pfm");
    ExpectError("-tonemap -operator best MAP " + png, "best");
    Bsp bsp = Load();
    DropStaleLumps(bsp, StaleAfter::SurfaceBake);
    KeptLog quiet;
    WriteBspFile(Map(".bsp"), bsp, {}, quiet.log);
    ExpectError("-tonemap MAP " + png, "the map has no HDR lightmaps");
    EXPECT_FALSE(std::filesystem::exists(png));
}

} // namespace

} // namespace q3::test
