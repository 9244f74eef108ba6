// GPL-2.0-or-later. Macro textures: where texels are, and what they do to light.
#include "common/error.h"
#include "common/files/files.h"
#include "common/image/image.h"
#include "q3map2/lightmap/raw/macro_texture.h"
#include "tests/program/lit_room.h"

#include <algorithm>
#include <cmath>

namespace q3::test {

namespace {

/// The light of an sRGB byte, by its definition.
double Linear(int byte) {
    const double c = byte / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

void ExpectFactor(const Vec3f &got, const Vec3d &wanted) {
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_NEAR(got[i], wanted[i], 1e-5) << i;
}

/// Three columns, two rows: red grows by column, green is 255 in the upper row, blue tells alpha.
Image SmallImage() {
    Image image{3, 2, {}};
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column)
            for (const int c : {100 * column, row == 0 ? 255 : 0, 255, column == 1 ? 51 : 255})
                image.rgba.push_back(std::uint8_t(c));
    return image;
}

TEST(MacroTexture, TexelsLieOverTheWorldFromAbove) {
    const Image image = SmallImage();
    const MacroTexture texture(image, {{-300, 100, -50}, {300, 500, 50}});
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 2; ++row) {
            const double alpha = column == 1 ? 51 / 255.0 : 1;
            const Vec3d wanted = Vec3d{Linear(100 * column), row == 0 ? 1.0 : 0.0, 1} * alpha;
            const float x = -300 + 200 * (float(column) + 0.5f), y = 500 - 200 * (float(row) + 0.5f);
            for (const float dx : {-99.0f, 0.0f, 99.0f})
                for (const float dy : {-99.0f, 0.0f, 99.0f})
                    ExpectFactor(texture.At({x + dx, y + dy, 7777}), wanted);
        }
}

TEST(MacroTexture, OutsideTheEdgeGoesOn) {
    const Image image = SmallImage();
    const MacroTexture texture(image, {{0, 0, 0}, {300, 200, 0}});
    ExpectFactor(texture.At({-1e6f, 1e6f, 0}), {0, 1, 1});
    ExpectFactor(texture.At({1e6f, -1e6f, 0}), {Linear(200), 0, 1});
    ExpectFactor(texture.At({300, 200, 0}), {Linear(200), 1, 1});
    ExpectFactor(texture.At({0, 0, 0}), {0, 0, 1});
}

// ---- in lit maps -----------------------------------------------------------------------------------------------

/// The image of 4 x 4 texels of the room, of different grays and colors, with one that alpha darkens.
class MacroTextureRoomTest : public LitRoomTest {
  protected:
    MacroTextureRoomTest() {
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                for (const int c : {60 + 40 * column, 90 + 30 * row, 255, column == 3 && row == 3 ? 128 : 255})
                    image_.rgba.push_back(std::uint8_t(c));
        folder_.Write("base/baseq3/textures/macro/room.tga", EncodeTga(image_.rgba, 4, 4, 4, TgaRows::TopFirst));
    }
    void CompileWith(const Keys &worldKeys, const std::string &brushes = {}) {
        Compile(Lamp({-100, 50, 200}, 300) + Lamp({60, -70, 100}, 200, {0.3f, 1, 0.5f}), worldKeys, brushes);
    }
    /// What the image does to the light at a point of the floor, for an image over -256..256 on both axes.
    Vec3d FactorAt(const Vec3f &p) const {
        const int column = std::clamp(int(std::floor((p.x + 256) / 128)), 0, 3);
        const int row = std::clamp(int(std::floor((256 - p.y) / 128)), 0, 3);
        const auto texel = image_.Texel(column, row);
        return Vec3d{Linear(texel[0]), Linear(texel[1]), Linear(texel[2])} * (texel[3] / 255.0);
    }
    /// Floor points that are not on the border of two texels.
    static std::vector<Vec3f> Points() {
        std::vector<Vec3f> points = FloorPoints();
        std::erase_if(points, [](const Vec3f &p) { return int(p.x) % 128 == 0 || int(p.y) % 128 == 0; });
        return points;
    }
    std::vector<Vec3f> FloorLight(std::string_view suffix = "") const {
        const LitFace floor = FaceOf(Load(), "textures/test/floor", kUpward);
        const FloatImage page = Pfm(floor.page, suffix);
        std::vector<Vec3f> light;
        for (const Vec3f &p : Points())
            light.push_back(page.texels.at(std::size_t(floor.TexelAt(p))));
        return light;
    }
    /// Lights with and without the texture and compares at the floor.
    void ExpectTinted(std::string_view options, std::string_view with, std::string_view suffix = "") {
        Light(fmt::format("-hdr -hdrfiles pfm {} -macrotexture textures/macro/white", options));
        const std::vector<Vec3f> plain = FloorLight(suffix);
        Light(fmt::format("-hdr -hdrfiles pfm {} {}", options, with));
        const std::vector<Vec3f> tinted = FloorLight(suffix);
        const std::vector<Vec3f> points = Points();
        for (std::size_t i = 0; i < points.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(tinted[i][c], double(plain[i][c]) * FactorAt(points[i])[c],
                            1e-5 + 1e-4 * double(plain[i][c]))
                    << points[i].x << ' ' << points[i].y << ' ' << suffix;
        const float most = std::ranges::max(plain, {}, &Vec3f::x).x;
        EXPECT_GT(most, 0.1f);
    }

    void WriteWhite() {
        const std::vector<std::uint8_t> white(4, 255);
        folder_.Write("base/baseq3/textures/macro/white.tga", EncodeTga(white, 1, 1, 4, TgaRows::TopFirst));
    }

    Image image_{4, 4, {}};
};

constexpr std::string_view kMins = "-256 -256 0", kMaxs = "256 256 256";

TEST_F(MacroTextureRoomTest, LightOfTheFloorIsMultiplied) {
    WriteWhite();
    CompileWith({{"world_mins", std::string(kMins)}, {"world_maxs", std::string(kMaxs)}});
    ExpectTinted("", "-macrotexture textures/macro/room.tga");
    ExpectTinted("-super 2", "-macrotexture textures/macro/room");
}

TEST_F(MacroTextureRoomTest, TheKeyDoesTheSameAndBouncesStayAsTheyAre) {
    WriteWhite();
    CompileWith({{"_macrotexture", "textures/macro/room"},
                 {"world_mins", std::string(kMins)},
                 {"world_maxs", std::string(kMaxs)}});
    ExpectTinted("-bounce 2", "");
}

/// The bounds of the world's model are those of the room's brushes.
TEST_F(MacroTextureRoomTest, WithoutBoundsTheImageCoversTheWorld) {
    WriteWhite();
    CompileWith({});
    const bspModel_t world = Load().models.front();
    EXPECT_LE(world.mins[0], -256);
    EXPECT_GE(world.mins[0], -273);
    Light("-hdr -hdrfiles pfm -macrotexture textures/macro/white");
    const std::vector<Vec3f> plain = FloorLight();
    Light("-hdr -hdrfiles pfm -macrotexture textures/macro/room");
    const std::vector<Vec3f> tinted = FloorLight(), points = Points();
    for (std::size_t i = 0; i < points.size(); ++i)
        EXPECT_NEAR(tinted[i].x, double(plain[i].x) * FactorAt(points[i]).x, 1e-4 * double(plain[i].x));
}

TEST_F(MacroTextureRoomTest, BasisMapsKeepTheirRatioToTheFlatLight) {
    WriteWhite();
    CompileWith({{"world_mins", std::string(kMins)}, {"world_maxs", std::string(kMaxs)}});
    for (const std::string_view suffix : {"_b1", "_b2", "_b3"})
        ExpectTinted("-rnmall -rnmstorage raw", "-macrotexture textures/macro/room", suffix);
}

TEST_F(MacroTextureRoomTest, AShaderMayHaveNoneOrAnother) {
    WriteWhite();
    const auto floorScript = [&](std::string_view image) {
        folder_.Write("base/baseq3/scripts/shaderlist.txt", "own\ntest\n");
        folder_.Write(
            "base/baseq3/scripts/own.shader",
            fmt::format("textures/test/floor\n{{\nq3map_macroTexture {}\n{{\nmap $lightmap\n}}\n}}\n", image));
    };
    CompileWith({{"world_mins", std::string(kMins)}, {"world_maxs", std::string(kMaxs)}});
    ExpectTinted("", "-macrotexture textures/macro/room");
    const std::vector<Vec3f> tinted = FloorLight();
    floorScript("textures/macro/room");
    Light("-hdr -hdrfiles pfm");
    EXPECT_EQ(FloorLight(), tinted);
    floorScript("none");
    Light("-hdr -hdrfiles pfm");
    const std::vector<Vec3f> plain = FloorLight();
    Light("-hdr -hdrfiles pfm -macrotexture textures/macro/room");
    EXPECT_EQ(FloorLight(), plain);
}

TEST_F(MacroTextureRoomTest, VertexLightIsMultiplied) {
    WriteWhite();
    CompileWith({{"world_mins", std::string(kMins)}, {"world_maxs", std::string(kMaxs)}});
    const auto corners = [&](std::string_view texture) {
        Light(fmt::format("-nolm -scale 10 -macrotexture textures/macro/{}", texture));
        const Bsp bsp = Load();
        const LitFace floor = FaceOf(bsp, "textures/test/floor", kUpward);
        const bspDrawSurface_t &surface = bsp.drawSurfaces[std::size_t(floor.surface)];
        return std::vector<bspDrawVert_t>(bsp.drawVerts.begin() + surface.firstVert,
                                          bsp.drawVerts.begin() + surface.firstVert + surface.numVerts);
    };
    const auto plain = corners("white"), tinted = corners("room");
    ASSERT_EQ(plain.size(), tinted.size());
    ASSERT_GE(plain.size(), 4u);
    for (std::size_t v = 0; v < plain.size(); ++v)
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(tinted[v].color[0][c], plain[v].color[0][c] * FactorAt(Vec3f(plain[v].xyz))[c], 1.01) << v;
    EXPECT_GT(int(plain[0].color[0][0]), 50);
    EXPECT_LT(int(plain[0].color[0][0]), 255);
}

TEST_F(MacroTextureRoomTest, AMissingImageAndAnEmptyWorldAreErrors) {
    CompileWith({{"world_mins", "5 5 5"}, {"world_maxs", "5 9 9"}});
    Outcome outcome = Run("-macrotexture textures/macro/nothing");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.Printed("macro texture textures/macro/nothing: no such image")) << outcome.text;
    outcome = Run("-macrotexture textures/macro/room");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.Printed("expected world_mins below world_maxs")) << outcome.text;
}

} // namespace

} // namespace q3::test
