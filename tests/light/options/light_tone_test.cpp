// GPL-2.0-or-later. The tone of lightmaps for readers of the SH grid: the engine-side reader agrees with the program,
// and a model in the open with the floor beside it.
#include "libs/shgrid/shgrid.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/light/options/light_tone.h"
#include "tests/support/light_fixture.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace q3::test {

namespace {

shgrid_tone ParsedTone(const std::string &text) {
    shgrid_tone tone;
    EXPECT_EQ(shgrid_parse_tone(text.c_str(), &tone), SHGRID_OK) << text;
    return tone;
}

std::string ToneOf(const Bsp &bsp) {
    return std::string(ParseEntities(bsp.entities, "test").front().Value(kToneKey));
}

TEST(ToneText, IsEmptyForAPlainToneOnly) {
    EXPECT_EQ(ToneText({}, 1), "");
    EXPECT_EQ(ToneText({.compensate = 2}, 2), "") << "nothing changes";
    EXPECT_EQ(ToneText({.gamma = 1.4f, .compensate = 4}, 1), "gamma 1.4 scale 0.25");
    EXPECT_EQ(ToneText({.exposure = 200, .saturation = 0.5f, .contrast = 1.25f, .sRgb = true, .maxLight = 99}, 3),
              "contrast 1.25 exposure 200 saturation 0.5 scale 3 maxlight 99 srgb 1");
}

// Through the text, so that its numbers are exact too. A byte is the value cut, or rounded after sRGB.
TEST(ToneText, ReaderGivesTheBytesOfTheStore) {
    std::mt19937 random(7);
    const auto pick = [&](std::initializer_list<float> values) { return values.begin()[random() % values.size()]; };
    std::uniform_real_distribution<float> any(0, 1);
    int compared = 0, clamped = 0;
    for (int t = 0; t < 400; ++t) {
        const ToneOptions tone{.gamma = pick({1, 1.4f, 2.2f, 0.7f, 0.5f + any(random)}),
                               .exposure = pick({0, 0, 200, 64.5f, 400 * any(random) + 1}),
                               .compensate = pick({1, 4, 1.5f, 0.3f + any(random)}),
                               .saturation = pick({1, 1, 0, 1.7f, -0.4f, any(random)}),
                               .contrast = pick({1, 1, 0.6f, 1.9f}),
                               .sRgb = random() % 3 == 0,
                               .maxLight = pick({255, 255, 128, 77.7f})};
        const float brightness = pick({1, 1, 2, 0.37f});
        const ToneMapper mapper(1, brightness, tone);
        const shgrid_tone read = ParsedTone(ToneText(tone, brightness));
        for (int c = 0; c < 250; ++c) {
            const float level = 600 * any(random) * any(random);
            const Vec3f color{level * any(random), level, c % 7 == 0 ? 0 : level * any(random)};
            float rgb[3] = {color.x / 255, color.y / 255, color.z / 255};
            shgrid_apply_tone(&read, rgb);
            const auto bytes = mapper.Bytes(color);
            for (const std::size_t i : {0u, 1u, 2u}) {
                const double exact = 255 * double(rgb[i]) + (tone.sRgb ? 0.5 : 0);
                if (std::abs(exact - std::round(exact)) < 1e-3)
                    continue; // either byte is right
                ASSERT_EQ(int(bytes[i]), int(exact)) << ToneText(tone, brightness) << " of " << color[i];
                ++compared;
                clamped += bytes[i] == int(tone.maxLight);
            }
        }
    }
    EXPECT_GT(compared, 250000);
    EXPECT_GT(clamped, 1000);
}

/// A room under a wide lamp, and colored light from everywhere: no shadows, and light that L2 and a fine grid hold
/// well.
SceneBuilder ToneRoom() {
    SceneBuilder scene = Room();
    scene.SetWallShader(BoxFace::PlusZ, TestShader("textures/vec/lite"));
    scene.SetWorldKey("_ambient", "60");
    scene.SetWorldKey("_color", "0.2 0.5 1");
    return scene;
}

/// Mean and largest difference of bytes between luxels of the floor and the grid just above.
struct FloorDifference {
    double mean = 0, largest = 0;
    int luxels = 0;
};

class ToneTest : public LightTest {
  protected:
    ToneTest() { surfaces = true; }
    static FloorDifference CompareFloor(const Bsp &bsp, const shgrid_tone *tone);
};

/// Calls f(position, red green blue bytes) for the luxels inside the rectangle that the surface is.
template <typename F> void ForLuxels(const Bsp &bsp, const bspDrawSurface_t &surface, const F &f) {
    const auto vert = [&](int k) -> const bspDrawVert_t & { return bsp.drawVerts[std::size_t(surface.firstVert + k)]; };
    const auto at = [&](int k) { return std::array{vert(k).lightmap[0][0] * 128, vert(k).lightmap[0][1] * 128}; };
    const auto a = at(0), b = at(1), c = at(2);
    const float u1 = b[0] - a[0], v1 = b[1] - a[1], u2 = c[0] - a[0], v2 = c[1] - a[1], d = u1 * v2 - v1 * u2;
    const auto point = [&](int k) { return Vec3f{vert(k).xyz[0], vert(k).xyz[1], vert(k).xyz[2]}; };
    Boundsf box;
    for (int k = 0; k < surface.numVerts; ++k)
        box.Add({at(k)[0], at(k)[1], 0});
    for (int y = int(box.mins.y) + 1; y < int(box.maxs.y) - 1; ++y)
        for (int x = int(box.mins.x) + 1; x < int(box.maxs.x) - 1; ++x) {
            const float u = float(x) + 0.5f - a[0], v = float(y) + 0.5f - a[1];
            const float s = (u * v2 - v * u2) / d, t = (u1 * v - v1 * u) / d;
            const Vec3f p = point(0) + (point(1) - point(0)) * s + (point(2) - point(0)) * t;
            f(p, &bsp.lightmaps[std::size_t((surface.lightmapNum[0] * 128 + y) * 128 + x) * 3]);
        }
}

FloorDifference ToneTest::CompareFloor(const Bsp &bsp, const shgrid_tone *tone) {
    const GridView grid(bsp);
    FloorDifference sum;
    const double cut = tone && tone->srgb ? 0 : 0.5; // bytes of sRGB are rounded, others cut
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces) {
        if (surface.lightmapNum[0] < 0 || bsp.drawVerts[std::size_t(surface.firstVert)].normal != Float3{0, 0, 1})
            continue;
        ForLuxels(bsp, surface, [&](const Vec3f &p, const std::uint8_t *bytes) {
            const Vec3d light = Evaluate(grid.Sample(Vec3d(p) + Vec3d{0, 0, 1}), {0, 0, 1});
            float rgb[3] = {float(light.x), float(light.y), float(light.z)};
            if (tone)
                shgrid_apply_tone(tone, rgb);
            for (const std::size_t i : {0u, 1u, 2u}) {
                const double off = std::abs(255 * std::clamp(double(rgb[i]), 0.0, 1.0) - double(bytes[i]) - cut);
                sum.mean += off, sum.largest = std::max(sum.largest, off);
            }
            ++sum.luxels;
        });
    }
    sum.mean /= 3 * std::max(1, sum.luxels);
    return sum;
}

TEST_F(ToneTest, AModelAndTheFloorBesideItComeOutAlike) {
    // Bounds in bytes: the error of L2 and of the lightmap's own estimates is about 1, which steep curves magnify.
    struct Case {
        std::string options;
        double mean, largest;
    };
    for (const auto &[options, mean, largest] :
         {Case{"-gamma 1.4 -compensate 4", 1.5, 3}, Case{"-gamma 1.5 -exposure 200 -compensate 2", 1.5, 3},
          Case{"-sRGBlight", 4, 7}, Case{"-exposure 60", 1.5, 4},
          Case{"-gamma 1.5 -exposure 200 -compensate 2 -sRGBlight", 1.5, 3},
          Case{"-contrast 80 -saturation 0.4 -brightness 1.5", 2.5, 18}}) {
        const Bsp bsp = Lit(ToneRoom(), "-gridsh 16 16 16 " + options);
        const shgrid_tone tone = ParsedTone(ToneOf(bsp));
        const FloorDifference with = CompareFloor(bsp, &tone), without = CompareFloor(bsp, nullptr);
        EXPECT_GT(with.luxels, 400);
        EXPECT_LE(with.mean, mean) << options;
        EXPECT_LE(with.largest, largest) << options;
        EXPECT_GE(without.mean, 25) << options;
    }
}

TEST_F(ToneTest, MostLightOfTheWorldIsPartOfTheTone) {
    SceneBuilder scene = ToneRoom();
    scene.SetWorldKey("_maxlight", "40");
    const Bsp bsp = Lit(scene, "-gridsh 16 16 16");
    EXPECT_EQ(ToneOf(bsp), "maxlight 40");
    const shgrid_tone tone = ParsedTone(ToneOf(bsp));
    EXPECT_LE(CompareFloor(bsp, &tone).mean, 1);
    EXPECT_GE(CompareFloor(bsp, nullptr).mean, 15);
}

TEST_F(ToneTest, KeyFollowsTheLightmaps) {
    const SceneBuilder scene = Room();
    const Bsp plain = Lit(scene), toned = Lit(scene, "-gamma 1.4 -compensate 2");
    EXPECT_EQ(ToneOf(plain), "");
    EXPECT_EQ(plain.entities.find("_q3map2_tone"), std::string::npos);
    EXPECT_EQ(ToneOf(toned), "gamma 1.4 scale 0.5");
    EXPECT_EQ(ToneOf(Lit(toned, "-gamma 2")), "gamma 2") << "all is lit again";
    EXPECT_EQ(Lit(toned).entities.find("_q3map2_tone"), std::string::npos) << "all is lit again, plainly";
    EXPECT_EQ(ToneOf(Lit(toned, "-onlygrid -gamma 1.4 -compensate 2")), "gamma 1.4 scale 0.5");
    EXPECT_FALSE(Printed("-onlygrid keeps"));
    EXPECT_EQ(ToneOf(Lit(toned, "-onlygrid -gamma 2")), "gamma 1.4 scale 0.5") << "the lightmaps stay";
    EXPECT_TRUE(Printed("-onlygrid keeps lightmaps of tone \"gamma 1.4 scale 0.5\", but lights the legacy grid with "
                        "\"gamma 2\""));
    EXPECT_EQ(ToneOf(Lit(toned, "-onlygrid")), "gamma 1.4 scale 0.5");
    EXPECT_TRUE(Printed("but lights the legacy grid without one"));
    EXPECT_EQ(ToneOf(Lit(plain, "-onlygrid")), "");
    EXPECT_EQ(ToneOf(Lit(plain, "-onlygrid -gamma 2")), "gamma 2") << "lightmaps of unknown tone";
}

} // namespace

} // namespace q3::test
