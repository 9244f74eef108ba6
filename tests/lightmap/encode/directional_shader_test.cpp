// GPL-2.0-or-later. The shader decoders give the numbers of the C header. Both files are written in the part of GLSL
// and HLSL that C++ can read, given vectors and a few functions.
#include "libs/directional/directional.h"
#include "q3map2/lightmap/encode/directional_encode.h"
#include "tests/lightmap/encode/light_sets.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace shaders {

using uint = unsigned;

struct vec3 {
    float x, y, z;
    vec3() = default;
    explicit vec3(float v) : x(v), y(v), z(v) {}
    vec3(float x_, float y_, float z_) : x(x_), y(y_), z(z_) {}
};
struct vec4 {
    float x, y, z, w;
};
using float3 = vec3;
using float4 = vec4;

inline vec3 operator+(vec3 a, vec3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline vec3 operator-(vec3 a, vec3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline vec3 operator*(vec3 a, vec3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline vec3 operator*(vec3 a, float s) {
    return {a.x * s, a.y * s, a.z * s};
}
inline vec3 operator/(vec3 a, float s) {
    return {a.x / s, a.y / s, a.z / s};
}
inline float max(float a, float b) {
    return a > b ? a : b;
}
inline vec3 max(vec3 a, vec3 b) {
    return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
inline float dot(vec3 a, vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline float length(vec3 a) {
    return std::sqrt(dot(a, a));
}
inline vec3 normalize(vec3 a) {
    return a / length(a);
}
inline vec3 operator/(vec3 a, vec3 b) {
    return {a.x / b.x, a.y / b.y, a.z / b.z};
}
inline float min(float a, float b) {
    return a < b ? a : b;
}
inline float pow(float a, float b) {
    return std::pow(a, b);
}
inline float exp2(float a) {
    return std::exp2(a);
}

// Literals are of type double in C++.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wfloat-conversion"
namespace glsl {
#include "libs/directional/directional.glsl"
}
namespace hlsl {
#include "libs/directional/directional.hlsl"
}
#pragma GCC diagnostic pop

} // namespace shaders

namespace {

using shaders::vec3, shaders::vec4;

/// Compares a function of both shader files with the values that the header gave.
#define EXPECT_SHADERS(call, expected)                                                                                 \
    do {                                                                                                               \
        ExpectSame(shaders::glsl::call, expected, "GLSL " #call);                                                      \
        ExpectSame(shaders::hlsl::call, expected, "HLSL " #call);                                                      \
    } while (false)

void ExpectSame(const vec3 &got, const float expected[3], const char *what) {
    EXPECT_NEAR(got.x, expected[0], 1e-5 * (1 + expected[0])) << what;
    EXPECT_NEAR(got.y, expected[1], 1e-5 * (1 + expected[1])) << what;
    EXPECT_NEAR(got.z, expected[2], 1e-5 * (1 + expected[2])) << what;
}

void ExpectSame(float got, float expected, const char *what) {
    EXPECT_NEAR(got, expected, 1e-5 * (1 + expected)) << what;
}

vec3 Shader(const float v[3]) {
    return {v[0], v[1], v[2]};
}

vec4 Shader4(const float v[4]) {
    return {v[0], v[1], v[2], v[3]};
}

struct Floats {
    float values[4];
    explicit Floats(const Vec3f &v) : values{v.x, v.y, v.z, 0} {}
};

TEST(Shaders, PackedColors) {
    LightSets sets(1);
    for (int i = 0; i < 1000; i++) {
        const std::uint32_t code = std::uint32_t(sets.Uniform(0, 4294967040.0f));
        const unsigned char bytes[4] = {(unsigned char)(code), (unsigned char)(code >> 8), (unsigned char)(code >> 16),
                                        (unsigned char)(i % 40 + 110)}; // exponents within the range of a float
        const unsigned char exp32[4] = {bytes[0], bytes[1], bytes[2], (unsigned char)(i % 40 - 20)};
        float texel[4], rgb[3];
        directional_e5bgr9(code, rgb);
        EXPECT_SHADERS(DecodeE5bgr9(code), rgb);
        directional_rgbe(bytes, rgb);
        directional_texel(bytes, texel);
        EXPECT_SHADERS(DecodeRgbe(Shader4(texel)), rgb);
        directional_exp32(exp32, rgb);
        directional_texel(exp32, texel);
        EXPECT_SHADERS(DecodeExp32(Shader4(texel)), rgb);
    }
    const float black[3] = {0, 0, 0};
    EXPECT_SHADERS(DecodeRgbe({1, 1, 1, 0}), black);
}

TEST(Shaders, DeluxeRnmAndSsbump) {
    LightSets sets(2);
    for (int i = 0; i < 1000; i++) {
        const Floats normal(sets.DirectionAbove({0, 0, 1})), direction(sets.DirectionAbove({0, 0, 1})),
            light({sets.Uniform(0, 4), sets.Uniform(0, 1), 0}), up({0, 0, 1});
        const vec3 n = Shader(normal.values), d = Shader(direction.values), l = Shader(light.values);
        float maps[3][3], rgb[3], texel[3];
        for (auto &map : maps)
            for (float &value : map)
                value = sets.Uniform(0, 2);
        const vec3 a = Shader(maps[0]), b = Shader(maps[1]), c = Shader(maps[2]);
        directional_deluxe(light.values, direction.values, normal.values, rgb);
        EXPECT_SHADERS(DeluxeLight(l, d, n), rgb);
        directional_deluxe_received(light.values, direction.values, up.values, 0.25f, normal.values, rgb);
        EXPECT_SHADERS(DeluxeReceived(l, d, Shader(up.values), 0.25f, n), rgb);
        directional_rnm_raw(&maps[0][0], normal.values, rgb);
        EXPECT_SHADERS(RnmRaw(a, b, c, n), rgb);
        directional_rnm_rescaled(&maps[0][0], normal.values, rgb);
        EXPECT_SHADERS(RnmRescaled(a, b, c, n), rgb);
        directional_rnm_squared(&maps[0][0], normal.values, rgb);
        EXPECT_SHADERS(RnmSquared(a, b, c, n), rgb);
        directional_rnm_weights(normal.values, texel);
        directional_ssbump(texel, &maps[0][0], DIRECTIONAL_RESCALED, rgb);
        EXPECT_SHADERS(SsbumpLight(Shader(texel), a, b, c, DIRECTIONAL_RESCALED), rgb);
        directional_ssbump_normal(texel, rgb);
        EXPECT_SHADERS(SsbumpNormal(Shader(texel)), rgb);
        EXPECT_SHADERS(SsbumpDynamic(Shader(texel), d), directional_ssbump_light(texel, direction.values));
    }
}

TEST(Shaders, L1) {
    LightSets sets(3);
    for (int i = 0; i < 1000; i++) {
        const Floats normal(sets.Direction());
        float sh[4][3], rgb[3];
        for (auto &coefficient : sh)
            for (float &value : coefficient)
                value = sets.Uniform(-1, 2);
        directional_l1(&sh[0][0], normal.values, rgb);
        const vec3 c0 = Shader(sh[0]), cy = Shader(sh[1]), cz = Shader(sh[2]), cx = Shader(sh[3]),
                   n = Shader(normal.values);
        EXPECT_SHADERS(L1Light(c0, cy, cz, cx, n), rgb);
        directional_l1_curved(&sh[0][0], normal.values, rgb);
        EXPECT_SHADERS(L1LightCurved(c0, cy, cz, cx, n), rgb);
        const Floats flat(sets.Direction());
        const float light[3] = {sets.Uniform(0, 2), 1, 0};
        for (float &value : sh[0])
            value = std::abs(value) + 0.1f;
        directional_l1_with_flat(&sh[0][0], light, flat.values, normal.values, rgb);
        EXPECT_SHADERS(L1LightWithFlat(Shader(sh[0]), cy, cz, cx, Shader(light), Shader(flat.values), n), rgb);
    }
}

TEST(Shaders, Lightmass) {
    LightSets sets(4);
    for (int i = 0; i < 1000; i++) {
        const Floats normal(sets.Direction());
        const vec3 n = Shader(normal.values);
        float color[4], direction[4], rgb[3];
        directional_range range{};
        for (std::size_t k = 0; k < 4; k++) {
            color[k] = sets.Uniform(0, 1), direction[k] = sets.Uniform(0, 1);
            range.multiply[0][k] = sets.Uniform(0, 3), range.add[0][k] = sets.Uniform(-2, 1);
            range.multiply[1][k] = k < 3 ? sets.Uniform(0, 1) : 0;
            range.add[1][k] = k < 3 ? sets.Uniform(-0.5f, 0) : 0.282095f;
        }
        const vec4 c = Shader4(color), d = Shader4(direction), cm = Shader4(range.multiply[0]),
                   ca = Shader4(range.add[0]), dm = Shader4(range.multiply[1]), da = Shader4(range.add[1]);
        directional_lightmass_high(color, direction, &range, normal.values, rgb);
        EXPECT_SHADERS(LightmassHigh(c, d, cm, ca, dm, da, n), rgb);
        directional_lightmass_low(color, direction, &range, normal.values, rgb);
        EXPECT_SHADERS(LightmassLow(c, d, cm, ca, dm, da, n), rgb);
        directional_sky_occlusion(color, rgb);
        EXPECT_NEAR(Length(Vec3f{rgb[0], rgb[1], rgb[2]}), color[3] * color[3], 1e-5);
        ExpectSame(shaders::glsl::SkyOcclusion(c) + vec3(1), (Floats(Vec3f{rgb[0] + 1, rgb[1] + 1, rgb[2] + 1})).values,
                   "sky");
        ExpectSame(shaders::hlsl::SkyOcclusion(c) + vec3(1), (Floats(Vec3f{rgb[0] + 1, rgb[1] + 1, rgb[2] + 1})).values,
                   "sky");
        EXPECT_SHADERS(Unoccluded(color[0]), directional_unoccluded(color[0]));
    }
}

} // namespace

} // namespace q3::test
