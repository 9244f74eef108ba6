// GPL-2.0-or-later. Light of the SH grid: the shaders, read as C++, give what the reader gives.
#include "tests/libs/shgrid/shgrid_shaders.h"

#include <cstring>
#include <random>

namespace q3::test {
namespace {

using namespace shaders;

float Uniform(std::mt19937 &random, float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(random);
}

vec3 RandomNormal(std::mt19937 &random) {
    const float z = Uniform(random, -1, 1), angle = Uniform(random, 0, 6.2831853f), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

shgrid_coeffs RandomCoefficients(std::mt19937 &random) {
    shgrid_coeffs coeffs;
    for (auto &coefficient : coeffs.c)
        for (float &channel : coefficient)
            channel = Uniform(random, -1, 1);
    for (float &channel : coeffs.c[0])
        channel = Uniform(random, 0, 4);
    return coeffs;
}

void ExpectNear(const vec3 &light, const float rgb[3], float tolerance) {
    ASSERT_NEAR(light.x, rgb[0], tolerance);
    ASSERT_NEAR(light.y, rgb[1], tolerance);
    ASSERT_NEAR(light.z, rgb[2], tolerance);
}

TEST(ShgridShader, LightIsThatOfTheReader) {
    std::mt19937 random(53);
    int dark = 0;
    for (int i = 0; i < 2000; ++i) {
        const shgrid_coeffs coeffs = RandomCoefficients(random);
        const vec3 n = RandomNormal(random);
        const float normal[3] = {n.x, n.y, n.z};
        float rgb[3];
        shgrid_evaluate(&coeffs, normal, rgb);
        dark += rgb[0] == 0;
        vec3 sh[9];
        for (std::size_t k = 0; k < 9; ++k)
            sh[k] = {coeffs.c[k][0], coeffs.c[k][1], coeffs.c[k][2]};
        ExpectNear(glsl::ShgridLight(sh, n), rgb, 1e-5f);
        ExpectNear(hlsl::ShgridLight(sh, n), rgb, 1e-5f);
    }
    EXPECT_GT(dark, 100) << "light below zero is clamped";
}

template <typename Tone> Tone ToneConstants(const shgrid_tone &tone) {
    return {tone.contrast, 1 / tone.gamma,      tone.exposure,          tone.saturation,
            tone.scale,    tone.maxlight / 255, tone.srgb ? 1.0f : 0.0f};
}

TEST(ShgridShader, ToneIsThatOfTheReader) {
    const char *const kTones[] = {nullptr,
                                  "gamma 1.4 scale 0.25",
                                  "contrast 1.5",
                                  "exposure 300",
                                  "saturation 0.3",
                                  "saturation 2",
                                  "maxlight 200",
                                  "srgb 1",
                                  "gamma 2.2 srgb 1",
                                  "maxlight 0",
                                  "contrast 1.2 gamma 1.3 exposure 200 saturation 1.4 scale 0.5 maxlight 220 srgb 1"};
    std::mt19937 random(59);
    for (const char *text : kTones) {
        shgrid_tone tone;
        ASSERT_EQ(shgrid_parse_tone(text, &tone), SHGRID_OK) << text;
        for (int i = 0; i < 500; ++i) {
            float rgb[3];
            for (float &channel : rgb)
                channel = i < 10 ? 0 : Uniform(random, 0, i % 2 != 0 ? 0.5f : 3);
            const vec3 light(rgb[0], rgb[1], rgb[2]);
            shgrid_apply_tone(&tone, rgb);
            ExpectNear(glsl::ShgridApplyTone(ToneConstants<glsl::ShgridTone>(tone), light), rgb, 1e-5f);
            ExpectNear(hlsl::ShgridApplyTone(ToneConstants<hlsl::ShgridTone>(tone), light), rgb, 1e-5f);
        }
    }
}

/// A lump of the uniform grid with random coefficients.
std::vector<unsigned char> RandomLump(std::mt19937 &random) {
    const float header[6] = {-64, 32, 8, 32, 16, 64};
    const std::int32_t bounds[4] = {5, 4, 3, 5 * 4 * 3};
    std::vector<unsigned char> lump(SHGRID_HEADER_BYTES + SHGRID_POINT_BYTES * std::size_t(bounds[3]));
    std::memcpy(lump.data(), header, sizeof header);
    std::memcpy(lump.data() + sizeof header, bounds, sizeof bounds);
    for (std::size_t i = 0; i < std::size_t(bounds[3]); ++i) {
        const shgrid_coeffs coeffs = RandomCoefficients(random);
        std::memcpy(&lump[SHGRID_HEADER_BYTES + SHGRID_POINT_BYTES * i], coeffs.c, SHGRID_POINT_BYTES);
    }
    return lump;
}

TEST(ShgridShader, TexturesOfTheWholeGridGiveTheLightOfTheReader) {
    std::mt19937 random(61);
    const std::vector<unsigned char> lump = RandomLump(random);
    shgrid_grid grid;
    ASSERT_EQ(shgrid_parse(lump.data(), lump.size(), &grid), SHGRID_OK);
    std::array<std::vector<std::uint16_t>, 7> halfs;
    std::array<void *, 7> pointers{};
    for (std::size_t i = 0; i < 7; ++i) {
        halfs[i].resize(4 * std::size_t(grid.count));
        pointers[i] = halfs[i].data();
    }
    shgrid_fill_half(&grid, pointers.data());
    std::array<sampler3D, 7> t;
    for (std::size_t i = 0; i < 7; ++i) {
        t[i].size = {grid.bounds[0], grid.bounds[1], grid.bounds[2]};
        for (std::size_t h = 0; h < halfs[i].size(); h += 4)
            t[i].texels.emplace_back(FromHalf(halfs[i][h]), FromHalf(halfs[i][h + 1]), FromHalf(halfs[i][h + 2]),
                                     FromHalf(halfs[i][h + 3]));
    }
    const vec3 mins(grid.mins[0], grid.mins[1], grid.mins[2]), cell(grid.cell[0], grid.cell[1], grid.cell[2]),
        bounds(grid.bounds[0], grid.bounds[1], grid.bounds[2]);
    for (int i = 0; i < 2000; ++i) {
        // Also outside, where the border continues.
        const float position[3] = {Uniform(random, -150, 150), Uniform(random, 0, 120), Uniform(random, -80, 250)};
        const vec3 n = RandomNormal(random), p(position[0], position[1], position[2]);
        const float normal[3] = {n.x, n.y, n.z};
        float rgb[3];
        shgrid_light(&grid, position, normal, rgb);
        ExpectNear(glsl::ShgridLightAt(t[0], t[1], t[2], t[3], t[4], t[5], t[6], {mins, cell, bounds}, p, n), rgb,
                   4e-3f);
        ExpectNear(hlsl::ShgridLightAt(t[0], t[1], t[2], t[3], t[4], t[5], t[6], {}, {mins, cell, bounds}, p, n), rgb,
                   4e-3f);
    }
}

} // namespace
} // namespace q3::test
