// GPL-2.0-or-later. Light as L1 spherical harmonics, deluxe maps, packed colors.
#include "libs/directional/directional.h"
#include "q3map2/lightmap/encode/directional_encode.h"
#include "tests/lightmap/encode/light_sets.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

L1Light OneLight(const Vec3f &direction, const Vec3f &color = {1, 1, 1}) {
    L1Light light;
    light.AddLight(color, direction);
    return light;
}

Vec3f DecodedL1(const L1Light &light, const Vec3f &normal) {
    float sh[4][3], rgb[3];
    for (std::size_t k = 0; k < 4; k++)
        for (std::size_t c = 0; c < 3; c++)
            sh[k][c] = light.c[k][c];
    const float n[3] = {normal.x, normal.y, normal.z};
    directional_l1(&sh[0][0], n, rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

TEST(L1Light, OneLightByAngle) {
    const L1Light light = OneLight({0, 0, 1});
    EXPECT_NEAR(light.Evaluate({0, 0, 1}).x, 0.75, 1e-6);
    EXPECT_NEAR(light.Evaluate({1, 0, 0}).x, 0.25, 1e-6);
    EXPECT_NEAR(light.Evaluate({0, 0, -1}).x, -0.25, 1e-6);
    EXPECT_NEAR(DecodedL1(light, {0, 0, 1}).x, 0.75, 1e-6);
    EXPECT_EQ(DecodedL1(light, {0, 0, -1}).x, 0);
    EXPECT_NEAR(light.c[0].x, std::numbers::pi * 0.282095, 1e-5);
    EXPECT_NEAR(kL1Flat, 0.282095, 5e-7);
    EXPECT_NEAR(kL1Directed, 0.325735, 5e-7);
    EXPECT_NEAR(kL1Directed, 0.488603 * 2 / 3, 5e-7);
    EXPECT_EQ(DIRECTIONAL_L0, kL1Flat);
    EXPECT_EQ(DIRECTIONAL_L1, kL1Directed);
}

TEST(L1Light, ErrorOfOneLightOverAllNormals) {
    // Root mean square over the sphere: the cosine is spread evenly over -1 .. 1.
    const L1Light light = OneLight({0, 0, 1});
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; i++) {
        const double x = -1 + (2 * i + 1.0) / kSteps;
        const double v = light.Evaluate({float(std::sqrt(1 - x * x)), 0, float(x)}).x - std::max(0.0, x);
        sum += v * v;
    }
    EXPECT_NEAR(std::sqrt(sum / kSteps), 0.1443, 5e-5);
}

TEST(L1Light, EachAxisHasItsCoefficient) {
    const Vec3f axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const std::size_t slots[3] = {3, 1, 2};
    for (std::size_t axis = 0; axis < 3; axis++)
        for (const float sign : {1.0f, -1.0f}) {
            const L1Light light = OneLight(axes[axis] * sign);
            for (std::size_t k = 1; k < 4; k++)
                EXPECT_NEAR(light.c[k].y, k == slots[axis] ? sign * std::numbers::pi * 0.488603 : 0, 1e-5);
            EXPECT_NEAR(light.Evaluate(axes[axis] * sign).y, 0.75, 1e-6);
            EXPECT_NEAR(DecodedL1(light, axes[axis] * sign).y, 0.75, 1e-6);
        }
}

TEST(L1Light, UniformLightIsTheSameForEveryNormal) {
    L1Light light;
    light.AddUniform({0.25f, 0.5f, 2});
    EXPECT_NEAR(light.c[0].y, 0.5 * 3.544908, 1e-5);
    LightSets sets(1);
    for (int i = 0; i < 100; i++) {
        const Vec3f n = sets.Direction(), rgb = light.Evaluate(n);
        EXPECT_NEAR(rgb.x, 0.25, 1e-6);
        EXPECT_NEAR(rgb.y, 0.5, 1e-6);
        EXPECT_NEAR(rgb.z, 2, 1e-6);
    }
}

TEST(L1Light, SumsScalesAndLuminance) {
    const L1Light a = OneLight({0, 0, 1}, {1, 0, 0}), b = OneLight({0, 1, 0}, {0, 1, 2});
    const L1Light sum = a * 2 + b;
    EXPECT_NEAR(sum.Evaluate({0, 0, 1}).x, 1.5, 1e-6);
    EXPECT_NEAR(sum.Evaluate({0, 1, 0}).z, 1.5, 1e-6);
    const auto luminance = (a + b).Luminance();
    EXPECT_NEAR(luminance[0], std::numbers::pi * 0.282095 * (0.30 + 0.59 + 2 * 0.11), 1e-5);
    EXPECT_NEAR(luminance[2], std::numbers::pi * 0.488603 * 0.30, 1e-5);
    EXPECT_NEAR(luminance[1], std::numbers::pi * 0.488603 * (0.59 + 2 * 0.11), 1e-5);
    EXPECT_EQ(luminance[3], 0);
}

TEST(L1Light, HeaderAgreesWithEncoderOnRandomLamps) {
    LightSets sets(7);
    for (int i = 0; i < 1000; i++) {
        L1Light light;
        for (const Lamp &lamp : sets.Lamps({0, 0, 1}))
            light.AddLight(lamp.color, lamp.direction);
        const Vec3f n = sets.Direction(), expected = light.Evaluate(n), got = DecodedL1(light, n);
        for (std::size_t c = 0; c < 3; c++)
            EXPECT_NEAR(got[c], std::max(0.0f, expected[c]), 1e-5);
    }
}

using SHArray = float[4][3];
void ToArray(const L1Light &light, SHArray &sh) {
    for (std::size_t k = 0; k < 4; k++)
        for (std::size_t c = 0; c < 3; c++)
            sh[k][c] = light.c[k][c];
}

TEST(L1Light, WithFlatLightTheFlatNormalIsExact) {
    LightSets sets(9);
    for (int i = 0; i < 1000; i++) {
        const auto lamps = sets.Lamps({0, 0, 1});
        L1Light light;
        for (const Lamp &lamp : lamps)
            light.AddLight(lamp.color, lamp.direction);
        SHArray sh;
        ToArray(light, sh);
        const Vec3f lit = Received(lamps, {0, 0, 1});
        const float flat[3] = {0, 0, 1}, received[3] = {lit.x, lit.y, lit.z};
        float rgb[3];
        directional_l1_with_flat(&sh[0][0], received, flat, flat, rgb);
        for (std::size_t c = 0; c < 3; c++)
            EXPECT_NEAR(rgb[c], lit[c], 1e-5 * (1 + lit[c]));
    }
}

TEST(L1Light, WithFlatLightGuards) {
    SHArray dark{}, behind;
    ToArray(OneLight({0, 0, -1}), behind);
    const float flat[3] = {0, 0, 1}, down[3] = {0, 0, -1}, received[3] = {0.5f, 0.25f, -1};
    float rgb[3];
    directional_l1_with_flat(&dark[0][0], received, flat, flat, rgb);
    EXPECT_EQ(rgb[0], 0.5f);
    EXPECT_EQ(rgb[2], 0);
    directional_l1_with_flat(&behind[0][0], received, flat, down, rgb); // 1 over 0.25 / 16
    EXPECT_NEAR(rgb[0], 0.5 * 64, 1e-3);
}

TEST(L1Light, CurvedAtBothEnds) {
    LightSets sets(10);
    L1Light uniform;
    uniform.AddUniform({0.5f, 1, 0});
    SHArray one, even;
    ToArray(uniform, even);
    for (int i = 0; i < 200; i++) {
        const Vec3f w = sets.Direction(), n = sets.Direction();
        const float normal[3] = {n.x, n.y, n.z};
        float rgb[3];
        directional_l1_curved(&even[0][0], normal, rgb);
        EXPECT_NEAR(rgb[0], 0.5, 1e-6);
        EXPECT_NEAR(rgb[1], 1, 1e-6);
        EXPECT_EQ(rgb[2], 0);
        ToArray(OneLight(w), one);
        directional_l1_curved(&one[0][0], normal, rgb); // c q^3
        EXPECT_NEAR(rgb[0], std::pow((1 + Dot(n, w)) / 2, 3), 1e-5);
    }
}

TEST(L1Light, CurvedKeepsTheMean) {
    // Over the sphere, about the axis of a light of 1 with 0.3 from everywhere.
    L1Light light = OneLight({0, 0, 1});
    light.AddUniform({0.3f, 0.3f, 0.3f});
    SHArray sh;
    ToArray(light, sh);
    double mean = 0;
    constexpr int kSteps = 4000;
    for (int i = 0; i < kSteps; i++) {
        const double x = -1 + (2 * i + 1.0) / kSteps;
        const float n[3] = {float(std::sqrt(1 - x * x)), 0, float(x)};
        float rgb[3];
        directional_l1_curved(&sh[0][0], n, rgb);
        mean += double(rgb[0]) / kSteps;
    }
    EXPECT_NEAR(mean, 0.55, 1e-5);
}

TEST(Deluxe, OneLightIsExact) {
    LightSets sets(8);
    const float flat[3] = {0, 0, 1}, color[3] = {0.5f, 1, 2};
    for (int i = 0; i < 1000; i++) {
        const Vec3f w = Tilted(sets.Uniform(0, 75), sets.Uniform(0, 360)), n = sets.DirectionAbove({0, 0, 1});
        const float d[3] = {w.x, w.y, w.z}, normal[3] = {n.x, n.y, n.z};
        const float received[3] = {0.5f * w.z, w.z, 2 * w.z};
        float full[3], divided[3];
        directional_deluxe(color, d, normal, full);
        directional_deluxe_received(received, d, flat, 0.25f, normal, divided);
        for (std::size_t c = 0; c < 3; c++) {
            EXPECT_NEAR(full[c], color[c] * std::max(0.0f, Dot(n, w)), 1e-6);
            EXPECT_NEAR(divided[c], full[c], 2e-6);
        }
    }
}

TEST(Deluxe, LowLightIsDividedByTheFloor) {
    const Vec3f w = Tilted(85);
    const float flat[3] = {0, 0, 1}, color[3] = {1, 1, 1}, d[3] = {w.x, w.y, w.z};
    float rgb[3];
    directional_deluxe_received(color, d, flat, 0.25f, d, rgb);
    EXPECT_NEAR(rgb[0], 4, 1e-5);
}

TEST(PackedColor, E5bgr9) {
    float rgb[3];
    directional_e5bgr9(256u | 128u << 9 | 1u << 18 | 16u << 27, rgb); // exponent 16: mantissa / 256
    EXPECT_EQ(rgb[0], 1);
    EXPECT_EQ(rgb[1], 0.5f);
    EXPECT_EQ(rgb[2], 1 / 256.0f);
    directional_e5bgr9(256u | 18u << 27, rgb);
    EXPECT_EQ(rgb[0], 4);
    directional_e5bgr9(0xffffffffu, rgb);
    EXPECT_EQ(rgb[0], 65408);
    EXPECT_EQ(rgb[2], 65408);
    directional_e5bgr9(1, rgb);
    EXPECT_EQ(rgb[0], std::ldexp(1.0f, -24));
    directional_e5bgr9(0, rgb);
    EXPECT_EQ(rgb[0], 0);
}

TEST(PackedColor, Rgbe) {
    float rgb[3];
    const unsigned char one[4] = {128, 64, 1, 129}, black[4] = {255, 255, 255, 0}, four[4] = {128, 0, 0, 131};
    directional_rgbe(one, rgb);
    EXPECT_EQ(rgb[0], 1);
    EXPECT_EQ(rgb[1], 0.5f);
    EXPECT_EQ(rgb[2], 1 / 128.0f);
    directional_rgbe(black, rgb);
    EXPECT_EQ(rgb[0], 0);
    EXPECT_EQ(rgb[2], 0);
    directional_rgbe(four, rgb);
    EXPECT_EQ(rgb[0], 4);
}

TEST(PackedColor, Exp32) {
    float rgb[3];
    const unsigned char bright[4] = {150, 75, 0, 1}, dim[4] = {128, 64, 25, 0xf8};
    directional_exp32(bright, rgb);
    EXPECT_FLOAT_EQ(rgb[0], 300 / 255.0f);
    EXPECT_FLOAT_EQ(rgb[1], 150 / 255.0f);
    EXPECT_EQ(rgb[2], 0);
    directional_exp32(dim, rgb);
    EXPECT_FLOAT_EQ(rgb[0], 0.5f / 255);
    EXPECT_FLOAT_EQ(rgb[1], 0.25f / 255);
    EXPECT_FLOAT_EQ(rgb[2], 25.0f / 256 / 255);
}

} // namespace

} // namespace q3::test
