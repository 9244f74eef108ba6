// GPL-2.0-or-later. The stage -ssbump, as a user runs it.
#include "common/files/files.h"
#include "common/image/image.h"
#include "tests/support/run_program.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::Each;
using testing::ElementsAre;

class SsbumpStageTest : public ProgramTest {
  protected:
    std::string File(std::string_view name) const { return (folder_ / name).string(); }
    /// A picture of 9 x 8 texels: black, with a white column and an alpha of 255 or of the column's number.
    void WriteHeights(std::string_view name, int white, bool alpha) {
        std::vector<std::uint8_t> texels;
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 9; ++x) {
                const std::uint8_t value = x == white ? 255 : 0;
                texels.insert(texels.end(), {value, value, value, std::uint8_t(alpha ? x : 255)});
            }
        folder_.Write(name, EncodeTga(texels, 9, 8, 4, TgaRows::TopFirst));
    }
    std::vector<std::byte> Bytes(std::string_view name) const { return ReadFile(folder_ / name); }
};

TEST_F(SsbumpStageTest, WritesTheFormatOfTheName) {
    WriteHeights("height.tga", 4, false);
    EXPECT_TRUE(RunWell("-ssbump " + File("height.tga") + " " + File("out.tga")).Printed("9 x 8 heights of 8 bits"));
    EXPECT_EQ(Bytes("out.tga").size(), 18u + 9u * 8u * 3u);
    RunWell("-ssbump " + File("height.tga") + " " + File("out.png"));
    const Image tga = DecodeTga(Bytes("out.tga"), "out.tga"), png = DecodePng(Bytes("out.png"), "out.png");
    EXPECT_EQ(tga.rgba, png.rgba);
    EXPECT_EQ(std::to_integer<int>(Bytes("out.png").at(25)), 2) << "without alpha";
    EXPECT_THAT(tga.Texel(4, 3), ElementsAre(147, 147, 147, 255)) << "the ridge, seen from the side, is level";
    EXPECT_GT(tga.Texel(5, 3)[0], tga.Texel(3, 3)[0] + 50) << "the right slope faces +s";
    EXPECT_LT(tga.Texel(7, 3)[1], 147) << "the ridge is toward -s, as is the second lobe";
}

TEST_F(SsbumpStageTest, AlphaIsKept) {
    WriteHeights("height.tga", 4, true);
    for (const char *out : {"out.tga", "out.png"}) {
        RunWell("-ssbump " + File("height.tga") + " " + File(out) + " -normals " + File("normals.png"));
        const auto file = Bytes(out);
        const Image image = out[4] == 't' ? DecodeTga(file, out) : DecodePng(file, out);
        EXPECT_EQ(image.Texel(7, 2)[3], 7) << out;
    }
    const Image normals = DecodePng(Bytes("normals.png"), "normals.png");
    EXPECT_THAT(normals.Texel(4, 2), ElementsAre(127, 127, 255, 4));
    EXPECT_THAT(normals.Texel(0, 2), ElementsAre(127, 127, 255, 0));
    EXPECT_GT(normals.Texel(5, 2)[0], 230);
}

TEST_F(SsbumpStageTest, OptionsCount) {
    WriteHeights("height.tga", 0, false);
    const std::string files = File("height.tga") + " " + File("out.png");
    const auto texel = [&](const std::string &options, int x) {
        RunWell("-ssbump " + options + " " + files);
        return DecodePng(Bytes("out.png"), "out.png").Texel(x, 4);
    };
    EXPECT_THAT(texel("-bumpscale 0", 1), ElementsAre(147, 147, 147, 255));
    EXPECT_GT(texel("-notile", 1)[0], 180) << "downhill along +s";
    EXPECT_LT(texel("-bumpscale -8", 1)[0], 60);
    EXPECT_LT(texel("", 8)[0], 60) << "up to the ridge of the next tile";
    const auto open = texel("-notile", 8);
    EXPECT_EQ(open[0], 147) << "nothing to the right";
    EXPECT_TRUE(open[1] < 145 && open[1] > 120) << "the ridge is 8 texels to the left: " << int(open[1]);
    EXPECT_NE(texel("-rays 4", 5), texel("-rays 512", 5));
    EXPECT_EQ(texel("-threads 1", 5), texel("-threads 4", 5));
}

TEST_F(SsbumpStageTest, ErrorsSayWhatIsWrong) {
    WriteHeights("height.tga", 4, false);
    folder_.Write("text.png", "no image at all");
    const std::string height = File("height.tga") + " ", out = " " + File("out.png");
    ExpectError("-ssbump " + File("none.tga") + out, "cannot read");
    ExpectError("-ssbump " + File("text.png") + out, "expected an image");
    ExpectError("-ssbump " + height + File("out.gif"), ".tga or .png");
    ExpectError("-ssbump -normals " + File("n.bmp") + " " + height + out, ".tga or .png");
    ExpectError("-ssbump " + height, "usage");
    ExpectError("-ssbump " + height + File("no/such/folder.png"), "cannot write");
    for (const char *bad : {"-rays 3", "-rays 5000", "-rays x", "-bumpscale 1e5", "-filter -1"})
        ExpectError(std::string("-ssbump ") + bad + " " + height + out, std::string(bad).substr(0, 5));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
}

} // namespace

} // namespace q3::test
