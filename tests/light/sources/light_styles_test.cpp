// GPL-2.0-or-later. Styles of patterns and switches, and the waves that stand for patterns.
#include "common/error.h"
#include "q3map2/light/sources/light_styles.h"
#include "tests/support/game_folder.h"
#include "tests/support/light_fixture.h"

#include <cmath>

namespace q3::test {

namespace {

using LampKeys = std::initializer_list<std::pair<std::string, std::string>>;

Entity StyleLamp(LampKeys keys) {
    return MakeEntity("light", keys);
}

class LightStylesTest : public testing::Test {
  protected:
    /// Numbers the styles of these lights and sets their keys.
    void Number(std::vector<Entity> lights, bool switchable = false, const std::set<int> &taken = {}) {
        styles = LightStyles(lights, world, switchable, taken, quiet.log);
        for (Entity &light : lights)
            styles.Set(light);
        styles.Record(world);
        numbered = std::move(lights);
    }
    std::string StyleOf(std::size_t light) const { return std::string(numbered.at(light).Value({"_style", "style"})); }
    std::string World(std::string_view key) const { return std::string(world.Value(key)); }

    KeptLog quiet;
    Entity world = MakeEntity("worldspawn", {});
    LightStyles styles;
    std::vector<Entity> numbered;
};

TEST_F(LightStylesTest, LightsOfOnePatternShareAFreeStyle) {
    Number({StyleLamp({{"pattern", "mmaa"}}), StyleLamp({{"pattern", "az"}}), StyleLamp({{"pattern", "MMAA"}}),
            StyleLamp({}), StyleLamp({{"style", "12"}})},
           false, {14});
    EXPECT_EQ(StyleOf(0), "13"); // 12 and 14 are taken
    EXPECT_EQ(StyleOf(1), "15");
    EXPECT_EQ(StyleOf(2), "13");
    EXPECT_EQ(StyleOf(3), "");
    EXPECT_EQ(StyleOf(4), "12");
    EXPECT_EQ(World("_style13pattern"), "mmaa");
    EXPECT_EQ(World("_style15pattern"), "az");
    EXPECT_EQ(world.pairs.size(), 3u);
}

TEST_F(LightStylesTest, AStyleThatIsGivenStays) {
    world.Set("_style13rgbgen", "wave sin 0 1 0 1");
    Number({StyleLamp({{"pattern", "mmaa"}}), StyleLamp({{"pattern", "mmaa"}, {"_style", "7"}}),
            StyleLamp({{"pattern", "za"}}), StyleLamp({{"pattern", "zz"}})});
    EXPECT_EQ(StyleOf(0), "7");
    EXPECT_EQ(StyleOf(1), "7");
    EXPECT_EQ(StyleOf(2), "12");
    EXPECT_EQ(StyleOf(3), "14") << "13 has an rgbGen";
}

TEST_F(LightStylesTest, TargetnamesAreSwitchesOnlyIfAskedFor) {
    const std::vector<Entity> lights{StyleLamp({{"targetname", "hall"}}), StyleLamp({{"targetname", "cellar"}}),
                                     StyleLamp({{"targetname", "hall"}}), StyleLamp({})};
    Number(lights);
    for (std::size_t i = 0; i < lights.size(); ++i)
        EXPECT_EQ(StyleOf(i), "");
    EXPECT_EQ(world.pairs.size(), 1u);
    Number(lights, true);
    EXPECT_EQ(StyleOf(0), "32");
    EXPECT_EQ(StyleOf(1), "33");
    EXPECT_EQ(StyleOf(2), "32");
    EXPECT_EQ(StyleOf(3), "");
    EXPECT_EQ(World("_switch32"), "hall");
    EXPECT_EQ(World("_switch33"), "cellar");
    EXPECT_EQ(World("_switch32dark"), "");
}

TEST_F(LightStylesTest, SpawnflagOneIsDarkAtFirstWithLightInByteValues) {
    Number({StyleLamp({{"targetname", "a"}, {"_light", "255 255 255 200"}, {"spawnflags", "1"}}),
            StyleLamp({{"targetname", "b"}, {"light", "300"}, {"spawnflags", "1"}}),
            StyleLamp({{"targetname", "c"}, {"_light", "255 255 255 200"}}),
            StyleLamp({{"targetname", "d"}, {"light", "300"}, {"_quadratic_attn", "1"}, {"spawnflags", "1"}})},
           true);
    EXPECT_EQ(World("_switch32dark"), "1");
    EXPECT_EQ(World("_switch33dark"), "") << "linear falloff";
    EXPECT_EQ(World("_switch34dark"), "");
    EXPECT_EQ(World("_switch35dark"), "1");
}

TEST_F(LightStylesTest, ASecondRunGivesTheSameKeys) {
    const std::vector<Entity> lights{StyleLamp({{"targetname", "hall"}}), StyleLamp({{"pattern", "mmaa"}}),
                                     StyleLamp({{"targetname", "door"}, {"pattern", "az"}})};
    Number(lights, true);
    const Entity first = world;
    Number(numbered, true); // kept lights have their styles
    EXPECT_EQ(world.pairs, first.pairs);
    Number(lights, true);
    EXPECT_EQ(world.pairs, first.pairs);
    Number({}, true);
    EXPECT_EQ(world.pairs.size(), 1u) << "keys of an earlier run go";
}

TEST_F(LightStylesTest, ConflictsAreWarnings) {
    Number({StyleLamp({{"pattern", "mmaa"}, {"style", "7"}}), StyleLamp({{"pattern", "az"}, {"style", "7"}}),
            StyleLamp({{"pattern", "mmaa"}, {"style", "8"}})});
    EXPECT_EQ(World("_style7pattern"), "mmaa");
    EXPECT_NE(quiet.text.find("style 7 has the patterns \"mmaa\" and \"az\"; the first counts"), std::string::npos);
    EXPECT_NE(quiet.text.find("style 8 is not used, lights of the same pattern have style 7"), std::string::npos);
}

TEST_F(LightStylesTest, BadPatternsNameTheLight) {
    for (const std::string &bad : std::vector<std::string>{"mm1", "m m", std::string(257, 'm')})
        try {
            Number({StyleLamp({{"origin", "1 2 3"}, {"pattern", bad}})});
            ADD_FAILURE() << bad;
        } catch (const Error &error) {
            EXPECT_EQ(std::string_view(error.what()).find("light at \"1 2 3\": pattern \""), 0u) << error.what();
        }
}

TEST_F(LightStylesTest, AllStylesCanBeTakenButNoMore) {
    std::vector<Entity> lights;
    for (int i = 0; i < 254; ++i)
        lights.push_back(StyleLamp({{"targetname", fmt::format("n{}", i)}}));
    Number(lights, true);
    std::set<std::string> used;
    for (std::size_t i = 0; i < lights.size(); ++i)
        used.insert(StyleOf(i));
    EXPECT_EQ(used.size(), 254u);
    EXPECT_FALSE(used.contains("0") || used.contains("255"));
    lights.push_back(StyleLamp({{"targetname", "more"}}));
    EXPECT_THROW(Number(lights, true), Error);
}

// ---- waves -----------------------------------------------------------------------------------------------------

/// Mean squared difference of a wave from the pattern, at many times in many repetitions.
double WaveDifference(const StyleWave &wave, std::string_view pattern) {
    const double period = double(pattern.size()) / 10;
    double sum = 0;
    constexpr int kTimes = 20'000;
    for (int i = 0; i < kTimes; ++i) {
        const double time = 3 * period * (i + 0.5) / kTimes;
        const double letter = pattern[std::size_t(time * 10) % pattern.size()] - 'a';
        sum += std::pow(wave.At(time) - letter / 12, 2);
    }
    return sum / kTimes;
}

TEST(StyleWave, LettersAreTwelfths) {
    EXPECT_EQ(BrightnessOf("amyM"), (std::vector<double>{0, 1, 2, 1}));
}

TEST(StyleWave, OnAndOffIsASquare) {
    EXPECT_EQ(FitWave("mmmaaa").ShaderText(), "wave square 0.5 0.5 0 1.66667");
    EXPECT_EQ(FitWave("aammmmaa").ShaderText(), "wave square 0.5 0.5 0.75 1.25");
    EXPECT_EQ(FitWave("ma").ShaderText(), "wave square 0.5 0.5 0 5");
    for (const std::string_view pattern : {"mmmaaa", "aaammm", "yayayaya", "gggmmmgggmmm"})
        EXPECT_NEAR(WaveDifference(FitWave(pattern), pattern), 0, 1e-6) << pattern;
}

TEST(StyleWave, RampsAreSawteeth) {
    const StyleWave up = FitWave("abcdefghijklmnopqrstuvwxy");
    EXPECT_EQ(up.form, StyleWave::Sawtooth);
    EXPECT_NEAR(up.base, 0, 0.05);
    EXPECT_NEAR(up.amplitude, 2, 0.1);
    EXPECT_EQ(FitWave("yxwvutsrqponmlkjihgfedcba").form, StyleWave::InverseSawtooth);
}

TEST(StyleWave, UpAndDownIsATriangleOrASine) {
    const StyleWave triangle = FitWave("acegikmoqsuwywusqomkigec");
    EXPECT_EQ(triangle.form, StyleWave::Triangle);
    EXPECT_NEAR(triangle.base, 1, 0.01);
    EXPECT_NEAR(triangle.amplitude, 1, 0.05);
    std::string sine;
    for (int i = 0; i < 40; ++i)
        sine += char('a' + std::lround(12 + 12 * std::sin(2 * std::numbers::pi * (i + 0.5) / 20)));
    const StyleWave wave = FitWave(sine);
    EXPECT_EQ(wave.form, StyleWave::Sine);
    EXPECT_NEAR(wave.frequency, 0.5, 1e-6);
    EXPECT_NEAR(wave.amplitude, 1, 0.02);
}

TEST(StyleWave, ConstantPatternsAreConstant) {
    EXPECT_EQ(FitWave("m").ShaderText(), "const ( 1 1 1 )");
    EXPECT_EQ(FitWave("gggg").ShaderText(), "const ( 0.5 0.5 0.5 )");
    EXPECT_EQ(FitWave("z").ShaderText(), "const ( 1 1 1 )") << "engines limit it";
}

/// No wave of a grid of others is nearer.
TEST(StyleWave, IsTheNearest) {
    for (const std::string_view pattern : {"mmaammmaa", "aazzmm", "abcddcbahh"}) {
        const StyleWave best = FitWave(pattern);
        ASSERT_NE(best.form, StyleWave::Noise) << pattern;
        const double least = WaveDifference(best, pattern);
        for (int form = StyleWave::Sine; form <= StyleWave::InverseSawtooth; ++form)
            for (int periods = 1; periods <= 2; ++periods)
                for (int i = 0; i < 8; ++i)
                    for (const double amplitude : {0.3, 0.6, 1.0})
                        for (const double base : {0.2, 0.5, 0.8}) {
                            const StyleWave other{StyleWave::Form(form), base, amplitude, i / 8.0,
                                                  10.0 * periods / double(pattern.size())};
                            EXPECT_GE(WaveDifference(other, pattern), least - 2e-3)
                                << pattern << ' ' << other.ShaderText();
                        }
    }
}

TEST(StyleWave, FlickerIsNoiseOfTheSameMean) {
    const std::string_view pattern = "mzakfxbwtdqlaznchyeuxbjvoidrtgaypsqmzbfk";
    const StyleWave wave = FitWave(pattern);
    EXPECT_EQ(wave.form, StyleWave::Noise);
    double mean = 0;
    for (const double one : BrightnessOf(pattern))
        mean += one / double(pattern.size());
    EXPECT_NEAR(wave.base, mean, 1e-9);
    EXPECT_GT(wave.amplitude, 0.5);
    EXPECT_EQ(wave.frequency, 10);
}

} // namespace

} // namespace q3::test
