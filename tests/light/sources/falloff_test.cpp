// GPL-2.0-or-later. Falloff and cones of light entities: reference values, limits, what is refused.
#include "common/error.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/sources/light_entities.h"
#include "tests/support/light_fixture.h"

#include <gmock/gmock.h>

#include <cmath>
#include <random>

namespace q3::test {

namespace {

using Keys = std::initializer_list<std::pair<std::string, std::string>>;
using testing::HasSubstr;

constexpr double kDegrees = std::numbers::pi / 180;

class CurvesTest : public LightTest {
  protected:
    std::vector<Light> LightsOf(std::vector<Entity> entities, const LightOptions &options = {}) {
        entities.insert(entities.begin(), MakeEntity("worldspawn", {}));
        return EntityLights(entities, options, log.log);
    }
    Light LightOf(Keys keys, std::string_view className = "light") {
        const std::vector<Light> lights = LightsOf({MakeEntity(className, keys)});
        EXPECT_EQ(lights.size(), 1u);
        return lights.empty() ? Light{} : lights[0];
    }
    std::string ErrorOf(Keys keys, std::string_view className = "light") {
        try {
            LightsOf({MakeEntity(className, keys)});
        } catch (const Error &error) {
            return error.what();
        }
        return {};
    }
    bool Said(std::string_view text) const { return log.text.find(text) != std::string::npos; }
    KeptLog log;
};

struct FiftyPercentRow {
    double fifty, zero, a, b, k, at1, atFifty, atZero;
};
constexpr FiftyPercentRow kFiftyPercentRows[] = {{64, 128, 4.73315e-4, 4.78927e-4, 0.0306513, 31.642, 0.5, 0.12744},
                                                 {100, 1000, 1.10112e-4, 4.49438e-3, 0.449438, 2.2024, 0.5, 0.0086914},
                                                 {128, 192, 1.02892e-4, 2.32492e-3, 0.0166251, 52.485, 0.5, 0.23496},
                                                 {256, 512, 2.95822e-5, 1.19732e-4, 0.0306513, 32.467, 0.5, 0.12744},
                                                 {10, 20, 0.0236148, -0.0395418, 0.0339415, 55.511, 0.5, 0.11509}};

TEST_F(CurvesTest, FiftyPercentDistanceHasTheReferenceValues) {
    for (const FiftyPercentRow &row : kFiftyPercentRows) {
        const auto curve = FiftyPercentCurve(row.fifty, row.zero, true);
        ASSERT_TRUE(curve) << row.fifty;
        EXPECT_NEAR(double(curve->quadratic), row.a, 1e-4 * std::abs(row.a));
        EXPECT_NEAR(double(curve->linear), row.b, 1e-4 * std::abs(row.b));
        EXPECT_NEAR(double(curve->constant), row.k, 1e-4 * row.k);
        Light light;
        light.curve = FalloffCurve::Polynomial;
        light.photons = 1;
        light.attenuation = *curve;
        light.attenuation.fadeFrom = kSunDistance, light.attenuation.end = 2 * kSunDistance; // the polynomial alone
        EXPECT_NEAR(double(Falloff(light).At(1)), row.at1, 1e-4 * row.at1);
        EXPECT_NEAR(double(Falloff(light).At(float(row.fifty))), row.atFifty, 1e-4);
        EXPECT_NEAR(double(Falloff(light).At(float(row.zero))), row.atZero, 1e-4 * row.atZero);
    }
}

TEST_F(CurvesTest, FiftyPercentKeysSetTheCurveAndLeaveTheBrightness) {
    const Light light = LightOf({{"_light", "200"}, {"_fifty_percent_distance", "64"}});
    EXPECT_NEAR(Falloff(light).At(64), 100, 0.02);
    EXPECT_NEAR(Falloff(light).At(128), 200 * 0.12744, 0.005) << "a missing distance is twice the other";
    EXPECT_NEAR(Falloff(light).At(0), 200 * 31.642, 1);
    const Light smaller = LightOf({{"_light", "200"},
                                   {"_fifty_percent_distance", "64"},
                                   {"_zero_percent_distance", "50"},
                                   {"_linear_attn", "1"}});
    EXPECT_EQ(Falloff(smaller).At(300), Falloff(light).At(300));
    EXPECT_TRUE(Said("_linear_attn has no effect together with _fifty_percent_distance"));
}

TEST_F(CurvesTest, HardFalloffFadesSmoothlyToNothing) {
    const Light hard = LightOf({{"_light", "255"},
                                {"_fifty_percent_distance", "64"},
                                {"_zero_percent_distance", "128"},
                                {"_hardfalloff", "1"}});
    const Light soft =
        LightOf({{"_light", "255"}, {"_fifty_percent_distance", "64"}, {"_zero_percent_distance", "128"}});
    const Falloff h(hard), s(soft);
    const float start = 0.75f * 128 + 0.25f * 64;
    for (float d = 0; d <= start; d += 1)
        EXPECT_EQ(h.At(d), s.At(d)) << d;
    EXPECT_NEAR(h.At(start + 0.01f), s.At(start + 0.01f), 1e-4);
    EXPECT_EQ(h.At(128), 0);
    EXPECT_EQ(h.At(500), 0);
    EXPECT_LT((h.At(127.9f) - h.At(128)) / 0.1f, 1e-2) << "slope at the end";
    EXPECT_GT(s.At(128), 32);
    EXPECT_EQ(h.Reach(0), 128);
    EXPECT_EQ(s.Reach(0), kSunDistance);
}

TEST_F(CurvesTest, AVertexEndsTheLight) {
    const Light light = LightOf({{"_light", "1"}, {"_fifty_percent_distance", "10"}, {"_zero_percent_distance", "20"}});
    const double vertex = 0.0395418 / (2 * 0.0236148);
    EXPECT_NEAR(Falloff(light).Reach(0), 10 * vertex, 0.01);
    EXPECT_EQ(Falloff(light).At(float(10 * vertex + 0.01)), 0);
    EXPECT_GT(Falloff(light).At(8), 0);
}

TEST_F(CurvesTest, CurvesNeverRise) {
    for (const double fifty : {10.0, 30.0, 64.0, 500.0, 4000.0})
        for (const double ratio : {1.05, 1.5, 2.0, 10.0, 200.0})
            for (const bool hard : {false, true}) {
                Light light;
                light.curve = FalloffCurve::Polynomial;
                light.photons = 100;
                const auto curve = FiftyPercentCurve(fifty, fifty * ratio, hard);
                ASSERT_TRUE(curve) << fifty << " " << ratio;
                light.attenuation = *curve;
                const Falloff falloff(light);
                float before = falloff.At(1);
                for (double d = 1; d < 10 * fifty * ratio; d += fifty * ratio / 500) {
                    const float here = falloff.At(float(d));
                    ASSERT_LE(here, before * 1.00001f) << fifty << " " << ratio << " " << hard << " at " << d;
                    before = here;
                }
            }
}

TEST_F(CurvesTest, DistancesWithoutACurveAreRefused) {
    EXPECT_THAT(
        ErrorOf({{"origin", "1 2 3"}, {"_fifty_percent_distance", "64"}, {"_zero_percent_distance", "64"}}),
        AllOf(HasSubstr("light at \"1 2 3\""), HasSubstr("are both 64, expected a larger _zero_percent_distance")));
    EXPECT_THAT(ErrorOf({{"_fifty_percent_distance", "2"}}), HasSubstr("expected larger distances"));
}

TEST_F(CurvesTest, PolynomialsGiveTheKeysBrightnessAtAHundredUnits) {
    std::mt19937 random(3);
    for (int i = 0; i < 50; ++i) {
        const auto number = [&] {
            return fmt::format("{:g}", random() % 3 == 0 ? 0 : std::exp(double(random() % 100) * 0.1 - 6));
        };
        const std::string c = number(), l = number(), q = number();
        const Light light =
            LightOf({{"_light", "37"}, {"_constant_attn", c}, {"_linear_attn", l}, {"_quadratic_attn", q}});
        EXPECT_NEAR(Falloff(light).At(100), 37, 37e-6) << c << " " << l << " " << q;
        EXPECT_EQ(Falloff(light).At(0), Falloff(light).At(1));
    }
    // Only ratios of the three count.
    const Light small = LightOf({{"_light", "37"}, {"_quadratic_attn", "0.0001"}});
    EXPECT_NEAR(Falloff(small).At(50), 37 * 4, 1e-4);
    // All zero, and below zero, is a light without falloff.
    const Light constant =
        LightOf({{"_light", "37"}, {"_constant_attn", "-1"}, {"_linear_attn", "0"}, {"_quadratic_attn", "0"}});
    EXPECT_EQ(Falloff(constant).At(5000), 37);
}

TEST_F(CurvesTest, NoNumbersMakeAnythingButLight) {
    std::mt19937 random(5);
    const char *numbers[] = {"0",   "-1",  "1e-40", "1e-300", "0.001", "1", "90",
                             "180", "1e6", "1e30",  "nan",    "inf",   "x", "255 255 255 1e30"};
    const char *names[] = {"_light",
                           "_constant_attn",
                           "_linear_attn",
                           "_quadratic_attn",
                           "_fifty_percent_distance",
                           "_zero_percent_distance",
                           "_hardfalloff",
                           "_radius",
                           "delay",
                           "wait",
                           "_inner_cone",
                           "_cone",
                           "_exponent",
                           "pitch",
                           "angle",
                           "_extradist",
                           "SunSpreadAngle",
                           "_ambient"};
    int lit = 0;
    for (int i = 0; i < 4000; ++i) {
        Entity entity = MakeEntity(i % 5 == 0 ? "light_environment" : i % 5 == 1 ? "light_spot" : "light", {});
        for (int k = 0; k < 5; ++k)
            entity.Set(names[random() % std::size(names)], numbers[random() % std::size(numbers)]);
        std::vector<Light> lights;
        try {
            lights = LightsOf({entity});
        } catch (const Error &) {
            continue;
        }
        for (const Light &light : lights) {
            const float sign = light.photons < 0 ? -1.0f : 1.0f;
            ASSERT_TRUE(std::isfinite(light.photons) && IsFinite(light.color) && IsFinite(light.normal));
            for (const float d : {0.f, 0.5f, 1.f, 16.f, 100.f, 5000.f, 500000.f}) {
                const float value = light.type == LightType::Sun ? light.photons : Falloff(light).At(d);
                ASSERT_TRUE(std::isfinite(value) && value * sign >= 0) << FormatEntities({entity}) << d << " " << value;
                lit += value > 0;
            }
            if (light.type == LightType::Spot) {
                ASSERT_TRUE(std::isfinite(ConeFraction(light, {1, 2, 3})));
            }
        }
    }
    EXPECT_GT(lit, 5000);
}

TEST_F(CurvesTest, ColorsWithBrightnessAreLinearAndFallOffByTheSquare) {
    const Light light = LightOf({{"_light", "255 128 0 200"}});
    EXPECT_NEAR(Falloff(light).At(100), 200, 1e-3);
    EXPECT_NEAR(Falloff(light).At(5), 200 * 400, 1) << "nearer than the 16 units of plain lights";
    EXPECT_EQ(light.color.x, 1);
    EXPECT_NEAR(light.color.y, std::pow(128 / 255.0, 2.2), 1e-6);
    EXPECT_EQ(light.color.z, 0);
    const Light dark = LightOf({{"_light", "100 50 50"}});
    EXPECT_NEAR(Falloff(dark).At(100), 255 * std::pow(100 / 255.0, 2.2), 1e-3) << "three numbers: brightness 255";
    EXPECT_NEAR(dark.color.y, std::pow(0.5, 2.2), 1e-6);
    EXPECT_THAT(ErrorOf({{"_light", "255 -1 0 200"}}), HasSubstr("expected a color and a brightness of at least 0"));
    LightOf({{"_light", "255 128"}});
    EXPECT_TRUE(Said("expected 1, 3 or 4 numbers"));
}

TEST_F(CurvesTest, IntensityOptionsScaleEveryCurve) {
    LightOptions twice;
    twice.pointScale *= 2;
    for (const Entity &entity : {MakeEntity("light", {{"_light", "255 255 255 50"}}),
                                 MakeEntity("light", {{"_light", "50"}, {"_linear_attn", "1"}}),
                                 MakeEntity("light", {{"_light", "50"}, {"_fifty_percent_distance", "99"}}),
                                 MakeEntity("light", {{"_light", "50"}, {"_radius", "400"}})})
        EXPECT_EQ(Falloff(LightsOf({entity}, twice)[0]).At(77), 2 * Falloff(LightsOf({entity})[0]).At(77));
}

TEST_F(CurvesTest, ARadiusOnlyBoundsTheLight) {
    const Falloff bounded(LightOf({{"light", "100"}, {"_radius", "400"}})), plain(LightOf({{"light", "100"}}));
    for (const float d : {0.f, 10.f, 50.f, 200.f, 399.f}) {
        const double window = 1 - std::pow(std::max(16.0f, d) / 400.0, 4);
        EXPECT_NEAR(bounded.At(d), plain.At(d) * window * window, 1e-5 * plain.At(d)) << d;
    }
    EXPECT_EQ(bounded.At(400), 0);
    EXPECT_EQ(bounded.At(900), 0);
    EXPECT_LT((bounded.At(399.9f) - bounded.At(400)) / 0.1f, 1e-3) << "slope at the end";
    EXPECT_EQ(bounded.Reach(0), 400);
    EXPECT_LT(bounded.Reach(100), 100);
    const Falloff quad(LightOf({{"_light", "255 255 255 75"}, {"_radius", "400"}}));
    EXPECT_NEAR(quad.At(50), bounded.At(50), 1e-3) << "75 at distance 100 is 7500 times 100 over its square";
}

TEST_F(CurvesTest, DelayHasTheCurvesOfEricwTools) {
    const auto at = [&](std::string_view delay, float d, std::string_view wait = "2") {
        return double(
            Falloff(LightOf({{"light", "60"}, {"delay", std::string(delay)}, {"wait", std::string(wait)}})).At(d));
    };
    EXPECT_NEAR(at("1", 300), 60 * 128 / 600.0, 1e-4);
    EXPECT_NEAR(at("2", 300), 60 * 128 * 128 / 36e4, 1e-4);
    EXPECT_NEAR(at("3", 300), 60, 1e-4);
    EXPECT_NEAR(at("5", 300), 60 * 128 * 128 / (728.0 * 728), 1e-4);
    EXPECT_NEAR(at("5", 300, "0"), 60 * 128 * 128 / (428.0 * 428), 1e-4);
    EXPECT_EQ(log.text, "");
    EXPECT_NEAR(at("0", 300), 60 * 7500 / 9e4, 1e-4);
    EXPECT_TRUE(Said("delay 0 has no counterpart and is not read; for linear falloff use spawnflags 1 and fade"));
}

TEST_F(CurvesTest, ReachIsWhereTheLightIsFaint) {
    for (const auto &[c, l, q] : {std::array<std::string, 3>{"1", "0", "0.01"}, {"0", "1", "0"}, {"5", "1", "1"}}) {
        const Light light =
            LightOf({{"_light", "100"}, {"_constant_attn", c}, {"_linear_attn", l}, {"_quadratic_attn", q}});
        const float reach = Falloff(light).Reach(2);
        EXPECT_NEAR(Falloff(light).At(reach), 2, 1e-3);
        EXPECT_EQ(Falloff(light).Reach(0), kSunDistance);
        EXPECT_EQ(Falloff(light).Reach(1e9f), 0);
    }
    const Light constant = LightOf({{"_light", "100"}, {"_constant_attn", "1"}});
    EXPECT_EQ(Falloff(constant).Reach(1), kSunDistance);
    EXPECT_EQ(Falloff(constant).Reach(101), 0);
}

/// Toward the light from a place at that angle to the axis.
Vec3f FromAxis(const Light &light, double degrees, double distance) {
    const Vec3d axis(light.normal), aside = Normalize(Cross(axis, Vec3d{0.3, 0.5, 0.1}));
    return Vec3f(-(axis * std::cos(degrees * kDegrees) + aside * std::sin(degrees * kDegrees)) * distance);
}

TEST_F(CurvesTest, ConesHaveAFringeBetweenTwoAngles) {
    const Light light =
        LightOf({{"_inner_cone", "30"}, {"_cone", "45"}, {"_exponent", "3"}, {"angles", "-20 70 0"}}, "light_spot");
    const double inner = std::cos(30 * kDegrees), outer = std::cos(45 * kDegrees);
    for (const double angle : {0.0, 10.0, 29.99})
        EXPECT_NEAR(ConeFraction(light, FromAxis(light, angle, 200)), std::cos(angle * kDegrees), 1e-4);
    EXPECT_NEAR(ConeFraction(light, FromAxis(light, 30, 200)), inner, 1e-4);
    EXPECT_NEAR(ConeFraction(light, FromAxis(light, 38, 200)),
                std::cos(38 * kDegrees) * std::pow((std::cos(38 * kDegrees) - outer) / (inner - outer), 3), 1e-4);
    EXPECT_NEAR(ConeFraction(light, FromAxis(light, 45, 200)), 0, 1e-5);
    for (const double angle : {45.01, 80.0, 91.0, 180.0})
        EXPECT_EQ(ConeFraction(light, FromAxis(light, angle, 200)), 0);
    EXPECT_EQ(ConeFraction(light, {}), 0) << "at the light itself";

    const Light sharp = LightOf({{"_inner_cone", "40"}, {"_cone", "20"}, {"_exponent", "0"}}, "light_spot");
    EXPECT_NEAR(ConeFraction(sharp, FromAxis(sharp, 39.99, 90)), std::cos(40 * kDegrees), 1e-3);
    EXPECT_EQ(ConeFraction(sharp, FromAxis(sharp, 40.01, 90)), 0);
    EXPECT_EQ(log.text, "");
}

TEST_F(CurvesTest, ConesDefaultToTenDegreesAndEndAtNinety) {
    const Light narrow = LightOf({}, "light_spot");
    EXPECT_EQ(narrow.type, LightType::Spot);
    EXPECT_NEAR(narrow.cone.cosInner, std::cos(10 * kDegrees), 1e-6);
    EXPECT_EQ(narrow.cone.cosOuter, narrow.cone.cosInner);
    EXPECT_EQ(LightOf({{"_inner_cone", "180"}, {"_cone", "180"}}, "light_spot").type, LightType::Point);
    EXPECT_EQ(log.text, "");
    const Light wide = LightOf({{"_inner_cone", "60"}, {"_cone", "120"}});
    EXPECT_EQ(wide.type, LightType::Spot);
    EXPECT_NEAR(wide.cone.cosOuter, 0, 1e-6);
    EXPECT_TRUE(Said("_cone 120 is limited to 90"));
}

TEST_F(CurvesTest, SpotlightsAimAsInSource) {
    const auto aim = [&](Keys keys) { return LightOf(keys, "light_spot").normal; };
    const auto expect = [](const Vec3f &got, const Vec3f &wanted) { EXPECT_LT(Length(got - wanted), 1e-6f); };
    expect(aim({}), {1, 0, 0});
    expect(aim({{"angles", "-90 0 0"}}), {0, 0, -1});
    expect(aim({{"angles", "0 90 0"}}), {0, 1, 0});
    expect(aim({{"angles", "30 180 45"}}), {-std::sqrt(0.75f), 0, 0.5f});
    expect(aim({{"angles", "30 180 0"}, {"pitch", "-60"}}), {-0.5f, 0, -std::sqrt(0.75f)});
    expect(aim({{"angles", "-90 0 0"}, {"pitch", "0"}}), {0, 0, -1});
    expect(aim({{"angles", "0 180 0"}, {"angle", "90"}}), {0, 1, 0});
    expect(aim({{"angle", "-1"}}), {0, 0, 1});
    expect(aim({{"angle", "-2"}}), {0, 0, -1});
    const std::vector<Light> lights =
        LightsOf({MakeEntity("light_spot", {{"origin", "0 0 50"}, {"target", "t"}, {"angles", "0 90 0"}}),
                  MakeEntity("info_null", {{"origin", "0 0 10"}, {"targetname", "t"}})});
    expect(lights.at(0).normal, {0, 0, -1});
}

TEST_F(CurvesTest, PlainLightsKeepTheirAnglesToThemselves) {
    const Light light = LightOf({{"angles", "-90 0 0"}, {"angle", "90"}, {"pitch", "-40"}});
    EXPECT_EQ(light.type, LightType::Point);
    EXPECT_EQ(light.curve, FalloffCurve::InverseSquare);
}

TEST_F(CurvesTest, SpheresThatACommonPointMakesAreNotMissed) {
    std::mt19937 random(11);
    const auto number = [&](float scale) { return (float(random() % 20001) / 10000 - 1) * scale; };
    int missed = 0;
    for (int i = 0; i < 3000; ++i) {
        Light light;
        light.type = LightType::Spot;
        light.origin = {number(100), number(100), number(100)};
        light.normal = Normalize(Vec3f{number(1), number(1), number(1) + 2});
        light.cone = {.byAngles = true, .cosInner = 1, .cosOuter = float(random() % 100) / 100};
        const Vec3f center{number(500), number(500), number(500)};
        const float radius = 100 + number(100);
        const bool misses = ConeMisses(light, center, radius);
        missed += misses;
        for (int k = 0; misses && k < 50; ++k) {
            const Vec3f p = center + Normalize(Vec3f{number(1), number(1), number(1) + 0.001f}) * radius;
            EXPECT_EQ(ConeFraction(light, light.origin - p), 0);
        }
    }
    EXPECT_GT(missed, 500);
}

TEST_F(CurvesTest, BadKeysAreNamedWhereTheyAreRead) {
    const auto warning = [](std::string_view className, std::string_view key, std::string_view value) {
        KeptLog quiet;
        Entity entity = MakeEntity(className, {});
        entity.Set(key, value);
        WarnOfBadLightKeys(entity, 7, quiet.log);
        return quiet.text;
    };
    EXPECT_THAT(warning("light", "_radius", "wide"),
                HasSubstr("entity 7 (light): _radius \"wide\": expected a number"));
    EXPECT_EQ(warning("light", "pitch", "x"), "");
    EXPECT_THAT(warning("light_spot", "pitch", "x"), HasSubstr("pitch \"x\": expected a number"));
    EXPECT_EQ(warning("light_spot", "SunSpreadAngle", "200"), "");
    EXPECT_THAT(warning("light_environment", "SunSpreadAngle", "200"),
                HasSubstr("SunSpreadAngle \"200\": expected a number from 0 to 180"));
}

TEST_F(CurvesTest, SpawnflagsOfSourceDoNotChangeTheLight) {
    const Light dark = LightOf({{"_light", "255 255 255 100"}, {"spawnflags", "1"}});
    EXPECT_TRUE(dark.angleAttenuation);
    EXPECT_EQ(dark.curve, FalloffCurve::Polynomial);
    const Light linear = LightOf({{"_light", "100"}, {"spawnflags", "1"}});
    EXPECT_FALSE(linear.angleAttenuation);
    EXPECT_EQ(linear.curve, FalloffCurve::Linear);
    LightOf({{"_light", "255 255 255 100"}, {"_color", "1 0 0"}});
    EXPECT_TRUE(Said("_color has no effect, since _light has a color"));
}

TEST_F(CurvesTest, KeysForHdrLightAloneAreNamed) {
    LightOf({{"_light", "255 255 255 200"}, {"_lightHDR", "-1 -1 -1 1"}, {"_lightscaleHDR", "1"}});
    LightOf({{"_light", "255 255 255 200"}, {"_lightHDR", "255 255 255 200"}});
    EXPECT_EQ(log.text, "");
    LightOf({{"_light", "255 255 255 200"}, {"_lightHDR", "255 255 255 400"}});
    EXPECT_TRUE(Said("_lightHDR is not read: one result serves all ranges, _light counts"));
}

TEST_F(CurvesTest, TheLastEnvironmentCounts) {
    const std::vector<Light> lights =
        LightsOf({MakeEntity("light_environment", {{"_light", "255 255 255 100"}, {"angles", "-90 0 0"}}),
                  MakeEntity("light_environment", {{"_light", "255 0 0 40"}, {"pitch", "-90"}})});
    ASSERT_EQ(lights.size(), 1u);
    EXPECT_EQ(lights[0].type, LightType::Sun);
    EXPECT_NEAR(lights[0].photons, 40, 1e-5);
    EXPECT_LT(Length(lights[0].normal - Vec3f{0, 0, -1}), 1e-6f);
    EXPECT_TRUE(Said("the last light_environment of the map counts"));
    EXPECT_THAT(ErrorOf({{"_ambient", "255 255 255 -3"}}, "light_environment"), HasSubstr("of at least 0"));
}

TEST_F(CurvesTest, TheSkyIsEvenAndTheDiscOfTheSunStratified) {
    double floor = 0, ceiling = 0;
    std::array<double, 8> walls{};
    for (const Light &light : LightsOf({MakeEntity("light_environment", {{"_ambient", "64"}})})) {
        const Vec3d toSky = -Vec3d(light.normal);
        floor += double(light.photons) * std::max(0.0, toSky.z);
        ceiling += double(light.photons) * std::max(0.0, -toSky.z);
        for (std::size_t i = 0; i < walls.size(); ++i) {
            const double turn = double(i) * std::numbers::pi / 4;
            if (toSky.z > 0)
                walls[i] += double(light.photons) * std::max(0.0, toSky.x * std::cos(turn) + toSky.y * std::sin(turn));
        }
    }
    EXPECT_NEAR(floor, 64, 1e-4);
    EXPECT_NEAR(ceiling, 64, 1e-4);
    for (const double wall : walls)
        EXPECT_NEAR(wall, 32, 0.064);

    const std::vector<Light> suns = LightsOf(
        {MakeEntity("light_environment", {{"_light", "255 255 255 100"}, {"SunSpreadAngle", "30"}, {"pitch", "-50"}})});
    ASSERT_EQ(suns.size(), 32u);
    const Vec3d axis{std::cos(-50 * kDegrees), 0, std::sin(-50 * kDegrees)};
    Vec3d mean;
    double sum = 0, widest = 0;
    for (const Light &sun : suns) {
        sum += double(sun.photons);
        mean += Vec3d(sun.normal) / 32.0;
        widest = std::max(widest, std::acos(Dot(Vec3d(sun.normal), axis)) / kDegrees);
    }
    EXPECT_NEAR(sum, 100, 1e-3);
    EXPECT_LT(widest, 15);
    EXPECT_GT(widest, 14);
    EXPECT_LT(Length(Normalize(mean) - axis), 0.01);
}

} // namespace

} // namespace q3::test
