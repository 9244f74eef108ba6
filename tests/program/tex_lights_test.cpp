// GPL-2.0-or-later. Texlights from the files where the program looks for them, in HDR pages.
#include "tests/program/lit_room.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::test {

namespace {

/// A lamp of 64 x 64 over the middle of the floor, at a height of 64.
const std::string kLampBox = BoxText({-32, -32, 64}, {32, 32, 72}, "test/lamp");

class TexLightFilesTest : public LitRoomTest {
  protected:
    TexLightFilesTest() { Compile({}, {}, Detailed(kLampBox)); }

    static std::string Detailed(std::string box) {
        for (std::size_t at = 0; (at = box.find("0.5 0.5 0 0 0", at)) != std::string::npos; at += 20)
            box.replace(at, 13, "0.5 0.5 134217728 0 0");
        return box;
    }
    /// Light of the luxel at this point of the floor, byte scale.
    float FloorAt(const Vec3f &p, std::string_view options = "") {
        const Outcome outcome = Light(fmt::format("-hdr -hdrfiles pfm {}", options));
        printed_ = outcome.text;
        const LitFace floor = FaceOf(Load(), "textures/test/floor", kUpward);
        const int texel = floor.TexelAt(p);
        EXPECT_GE(texel, 0);
        return 255 * Pfm(floor.page).texels.at(std::size_t(std::max(texel, 0))).x;
    }
    bool Printed(std::string_view text) const { return printed_.find(text) != std::string::npos; }

    std::string printed_;
};

/// The form factor of a centered square of side s at distance h: (4 / pi) u atan u, u = x / sqrt(1 + x^2), x = s / 2h.
/// Here 0.239456, so 255 gives 61.06; the luxel is 1 unit off the floor, so h is 63.
TEST_F(TexLightFilesTest, FormFactorOnTheFloor) {
    folder_.Write("base/baseq3/lights.rad", "test/lamp 255 255 255\r\n");
    const auto wanted = [](double h) {
        const double x = 32 / h, u = x / std::sqrt(1 + x * x);
        return 255 * 4 / std::numbers::pi * u * std::atan(u);
    };
    EXPECT_NEAR(wanted(64), 61.06, 0.005);
    EXPECT_NEAR(FloorAt({0, 0, 0}), wanted(63), 0.02);
}

TEST_F(TexLightFilesTest, LightScale) {
    folder_.Write("base/baseq3/lights.rad", "test/lamp 255 255 255 100\n");
    const float one = FloorAt({0, 0, 0});
    folder_.Write("base/baseq3/maps/room.rad", "lightscale textures/test/lamp 0.25\n");
    EXPECT_NEAR(FloorAt({0, 0, 0}), one / 4, 1e-3f * one);
    folder_.Write("base/baseq3/maps/room.rad", "lightscale textures/test/lamp -1\n");
    EXPECT_NEAR(FloorAt({0, 0, 0}), one, 1e-3f * one);
    EXPECT_TRUE(Printed("room.rad:1: lightscale: expected the name of a material and a factor")) << printed_;
}

TEST_F(TexLightFilesTest, LaterFilesWin) {
    folder_.Write("base/baseq3/lights.rad", "test/lamp 255 255 255 100\n");
    const float one = FloorAt({0, 0, 0});
    EXPECT_GT(one, 20);
    folder_.Write("more.rad", "test/lamp 255 255 255 200\n");
    const std::string more = "-lights " + (folder_ / "more.rad").string();
    EXPECT_NEAR(FloorAt({0, 0, 0}, more), 2 * one, 1e-3f * one);
    EXPECT_TRUE(Printed("more.rad:1: test/lamp: this line counts, not lights.rad:1")) << printed_;
    folder_.Write("base/baseq3/maps/room.rad", "test/lamp 255 255 255 300\n");
    EXPECT_NEAR(FloorAt({0, 0, 0}, more), 3 * one, 1e-3f * one);
    EXPECT_NEAR(FloorAt({0, 0, 0}), 3 * one, 1e-3f * one);
    EXPECT_TRUE(Printed("room.rad:1: test/lamp: this line counts, not lights.rad:1")) << printed_;
}

TEST_F(TexLightFilesTest, FilesAreFoundInArchives) {
    folder_.WriteArchive("base/baseq3/pak1.pk3", {{"lights.rad", "test/lamp 255 255 255 100\n"},
                                                  {"rad/city.rad", "test/lamp 255 255 255 200\n"}});
    const float one = FloorAt({0, 0, 0});
    EXPECT_GT(one, 20);
    EXPECT_NEAR(FloorAt({0, 0, 0}, "-lights rad/city.rad"), 2 * one, 1e-3f * one);
}

TEST_F(TexLightFilesTest, LinesForHdrCountWithHdrPages) {
    folder_.Write("base/baseq3/lights.rad", "ldr:test/lamp 255 255 255 100\n");
    EXPECT_EQ(FloorAt({0, 0, 0}), 0);
    folder_.Write("base/baseq3/lights.rad", "hdr:test/lamp 255 255 255 100\n");
    EXPECT_GT(FloorAt({0, 0, 0}), 20);
}

/// Light that the lamp emits bounces; the lamp's own surface only sends back what falls on it.
TEST_F(TexLightFilesTest, BouncesLikeTheShaderThatEmitsAsMuch) {
    folder_.Write("base/baseq3/lights.rad", "test/lamp 255 255 255 300\n");
    const float direct = FloorAt({128, 0, 0}), bounced = FloorAt({128, 0, 0}, "-bounce 3");
    EXPECT_GT(bounced, direct + 1);
    std::filesystem::remove(folder_ / "base/baseq3/lights.rad");
    folder_.Write("base/baseq3/scripts/shaderlist.txt", "test\nlamp\n");
    folder_.Write("base/baseq3/scripts/lamp.shader",
                  "textures/test/lamp\n{\nq3map_surfaceLight 400\nq3map_lightRGB 1 1 1\nq3map_backsplash 0 0\n"
                  "{\nmap $lightmap\n}\n}\n");
    EXPECT_NEAR(FloorAt({128, 0, 0}), direct, 1e-4f * direct);
    EXPECT_NEAR(FloorAt({128, 0, 0}, "-bounce 3"), bounced, 0.02f * bounced);
}

TEST_F(TexLightFilesTest, AMissingFileIsAnError) {
    const Outcome outcome = Run("-lights nowhere.rad");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.Printed("-lights nowhere.rad: no such file")) << outcome.text;
}

} // namespace

} // namespace q3::test
