// GPL-2.0-or-later. Radiosity normal maps and self-shadowed bump maps: encoder and decoder.
#include "libs/directional/directional.h"
#include "q3map2/lightmap/encode/directional_encode.h"
#include "tests/lightmap/encode/light_sets.h"

#include <gtest/gtest.h>

namespace q3::test {

namespace {

constexpr Vec3f kFlat{0, 0, 1};
using Maps = float[3][3];

/// The maps as the decoder takes them.
struct MapArray {
    explicit MapArray(const RnmLight &light) {
        for (std::size_t i = 0; i < 3; i++)
            for (std::size_t c = 0; c < 3; c++)
                values[i][c] = light.map[i][c];
    }
    Maps values;
};

template <typename Decoder> Vec3f DecodedMaps(Decoder decoder, const RnmLight &light, const Vec3f &normal) {
    const MapArray maps(light);
    const float n[3] = {normal.x, normal.y, normal.z};
    float rgb[3];
    decoder(&maps.values[0][0], n, rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

RnmLight RawMaps(const std::vector<Lamp> &lamps) {
    RnmLight light;
    for (std::size_t i = 0; i < 3; i++)
        light.map[i] = Received(lamps, kRnmBasis[i]);
    return light;
}

RnmLight OneWhite(const Vec3f &direction) {
    return RawMaps({{{1, 1, 1}, direction}});
}

TEST(RnmBasis, OrthonormalAndAsPublished) {
    float basis[3][3];
    directional_rnm_basis(basis);
    for (std::size_t i = 0; i < 3; i++)
        for (std::size_t k = 0; k < 3; k++) {
            EXPECT_NEAR(Dot(Vec3d(kRnmBasis[i]), Vec3d(kRnmBasis[k])), i == k, 1e-7);
            EXPECT_EQ(basis[i][k], kRnmBasis[i][k]);
        }
    EXPECT_NEAR(kRnmBasis[0].x, std::sqrt(2.0 / 3), 1e-7);
    EXPECT_NEAR(kRnmBasis[1].x, -1 / std::sqrt(6.0), 1e-7);
    EXPECT_NEAR(kRnmBasis[1].y, 1 / std::sqrt(2.0), 1e-7);
    EXPECT_NEAR(kRnmBasis[2].y, -1 / std::sqrt(2.0), 1e-7);
    EXPECT_NEAR(kRnmBasis[2].z, 1 / std::sqrt(3.0), 1e-7);
}

TEST(Rnm, LightAlongABasisVectorIsInThatMapAlone) {
    for (std::size_t i = 0; i < 3; i++) {
        const RnmLight light = RawMaps({{{2, 1, 0.5f}, kRnmBasis[i]}});
        for (std::size_t k = 0; k < 3; k++)
            for (std::size_t c = 0; c < 3; c++)
                EXPECT_NEAR(light.map[k][c], i == k ? (Vec3f{2, 1, 0.5f}[c]) : 0, 1e-6);
    }
}

TEST(Rnm, RawMapsAreExactInTheOctantOfTheBasis) {
    // tan 35.26 degrees = 1 / sqrt(2): the inscribed cone of the octant.
    LightSets sets(1);
    for (int i = 0; i < 1000; i++) {
        const Vec3f light = Tilted(sets.Uniform(0, 35.26f), sets.Uniform(0, 360)),
                    normal = Tilted(sets.Uniform(0, 35.26f), sets.Uniform(0, 360));
        EXPECT_NEAR(DecodedMaps(directional_rnm_raw, OneWhite(light), normal).x, Dot(light, normal), 2e-6);
    }
}

TEST(Rnm, RawMapsBeyondTheOctant) {
    const auto flat = [](double degrees) {
        return DecodedMaps(directional_rnm_raw, OneWhite(Tilted(degrees, 180)), kFlat).x;
    };
    EXPECT_NEAR(flat(40), 0.8137, 5e-5);
    EXPECT_NEAR(flat(50), 0.7896, 5e-5);
    EXPECT_NEAR(flat(60), 0.7416, 5e-5);
    EXPECT_NEAR(Tilted(40).z, 0.7660, 5e-5);
    EXPECT_NEAR(Tilted(50).z, 0.6428, 5e-5);
    EXPECT_NEAR(Tilted(60).z, 0.5, 5e-5);
}

TEST(Rnm, SquaredWeightsOnRawMaps) {
    const struct {
        double degrees, flat, facing;
    } rows[] = {{0, 0.57735, 0.57735},
                {30, 0.50000, 0.80103},
                {45, 0.40825, 0.96083},
                {60, 0.33193, 0.99578},
                {80, 0.30145, 0.90435}};
    for (const auto &row : rows) {
        const Vec3f light = Tilted(row.degrees);
        EXPECT_NEAR(DecodedMaps(directional_rnm_squared, OneWhite(light), kFlat).x, row.flat, 6e-6) << row.degrees;
        EXPECT_NEAR(DecodedMaps(directional_rnm_squared, OneWhite(light), light).x, row.facing, 6e-6) << row.degrees;
    }
}

TEST(Rnm, LightAlongTheNormalIsSqrtOneThirdInEachMap) {
    for (const Vec3f &map : OneWhite(kFlat).map)
        EXPECT_NEAR(map.x, 0.57735, 5e-6);
}

TEST(Rnm, UniformLightIsTooBrightInRawMapsAndExactInRescaledOnes) {
    const RnmLight light{{Vec3f{1, 1, 1}, Vec3f{1, 1, 1}, Vec3f{1, 1, 1}}};
    EXPECT_NEAR(DecodedMaps(directional_rnm_raw, light, kFlat).x, 1.73205, 1e-5);
    EXPECT_NEAR(DecodedMaps(directional_rnm_squared, light, kFlat).x, 1, 1e-6);
    EXPECT_NEAR(DecodedMaps(directional_rnm_rescaled, RescaleToFlat(light, {1, 1, 1}), kFlat).x, 1, 1e-6);
}

TEST(Rnm, RescaledMapsGiveTheFlatLightForAnyLamps) {
    LightSets sets(2);
    for (int i = 0; i < 1000; i++) {
        const auto lamps = sets.Lamps(kFlat);
        const Vec3f flat = Received(lamps, kFlat);
        const RnmLight light = RescaleToFlat(RawMaps(lamps), flat);
        const Vec3f linear = DecodedMaps(directional_rnm_rescaled, light, kFlat),
                    squared = DecodedMaps(directional_rnm_squared, light, kFlat);
        for (std::size_t c = 0; c < 3; c++) {
            EXPECT_NEAR(linear[c], flat[c], 2e-6 * (1 + flat[c]));
            EXPECT_NEAR(squared[c], flat[c], 2e-6 * (1 + flat[c]));
        }
    }
}

TEST(Rnm, RescaledAndOverflowedBytesGiveTheFlatLightWithinOneCode) {
    LightSets sets(3);
    for (int i = 0; i < 1000; i++) {
        auto lamps = sets.Lamps(kFlat);
        const float brightest = std::max(1.0f, MaxComponent(Received(lamps, kFlat)));
        for (Lamp &lamp : lamps)
            lamp.color *= 1 / brightest;
        const Vec3f flat = Received(lamps, kFlat);
        RnmLight light = OverflowToOthers(RescaleToFlat(RawMaps(lamps), flat));
        for (Vec3f &map : light.map)
            for (std::size_t c = 0; c < 3; c++) {
                ASSERT_LE(map[c], 1);
                map[c] = std::round(map[c] * 255) / 255;
            }
        for (std::size_t c = 0; c < 3; c++)
            EXPECT_NEAR(DecodedMaps(directional_rnm_squared, light, kFlat)[c] * 255, flat[c] * 255, 0.51);
    }
}

TEST(Rnm, RescaledEqualsRawWhereRawIsExact) {
    LightSets sets(4);
    for (int i = 0; i < 100; i++) {
        const Vec3f direction = Tilted(sets.Uniform(0, 35), sets.Uniform(0, 360)),
                    normal = Tilted(sets.Uniform(0, 35), sets.Uniform(0, 360));
        const RnmLight raw = OneWhite(direction),
                       rescaled = RescaleToFlat(raw, {direction.z, direction.z, direction.z});
        EXPECT_NEAR(DecodedMaps(directional_rnm_rescaled, rescaled, normal).x,
                    DecodedMaps(directional_rnm_raw, raw, normal).x, 2e-6);
    }
}

TEST(Rnm, RescaleGuards) {
    const RnmLight dark = RescaleToFlat({}, {0.5f, 0, 0.25f});
    for (const Vec3f &map : dark.map)
        EXPECT_EQ(map, (Vec3f{0.5f, 0, 0.25f}));
    EXPECT_EQ(RescaleToFlat(OneWhite(kFlat), {0, 0, 0}), RnmLight{});
    const float nan = std::nanf("");
    const RnmLight damaged = RescaleToFlat({{Vec3f{nan, -1, 1}, Vec3f{3, 1, nan}, Vec3f{0, 1, -2}}}, {1, 1, nan});
    EXPECT_EQ(damaged.map[0], (Vec3f{0, 0, 0}));
    EXPECT_EQ(damaged.map[1], (Vec3f{3, 1.5f, 0}));
    EXPECT_EQ(damaged.map[2], (Vec3f{0, 1.5f, 0}));
}

TEST(Rnm, OverflowMovesHalfAndHalf) {
    // Columns: one map over 1; one over it so far that a second overflows; more light than three maps hold.
    const RnmLight light = OverflowToOthers({{Vec3f{1.5f, 1.8f, 3}, Vec3f{0.25f, 0.9f, 2}, Vec3f{0, 0.1f, 0.5f}}});
    EXPECT_FLOAT_EQ(light.map[0].x, 1);
    EXPECT_FLOAT_EQ(light.map[1].x, 0.5f);
    EXPECT_FLOAT_EQ(light.map[2].x, 0.25f);
    EXPECT_FLOAT_EQ(light.map[0].y, 1);
    EXPECT_FLOAT_EQ(light.map[1].y, 1);
    EXPECT_FLOAT_EQ(light.map[2].y, 0.8f);
    EXPECT_FLOAT_EQ(light.map[0].z, 1);
    EXPECT_FLOAT_EQ(light.map[1].z, 1);
    EXPECT_FLOAT_EQ(light.map[2].z, 1);
    const RnmLight dim{{Vec3f{1, 0.5f, 0}, Vec3f{0.2f, 1, 0}, Vec3f{0, 0.3f, 1}}};
    EXPECT_EQ(OverflowToOthers(dim), dim);
}

TEST(Ssbump, FlatTexelUnderFrontalLight) {
    const float texel[3] = {0.57735f, 0.57735f, 0.57735f};
    const MapArray raw(OneWhite(kFlat)), rescaled(RescaleToFlat(OneWhite(kFlat), {1, 1, 1}));
    float rgb[3];
    directional_ssbump(texel, &raw.values[0][0], DIRECTIONAL_RAW, rgb);
    EXPECT_NEAR(rgb[0], 1, 1e-5);
    directional_ssbump(texel, &rescaled.values[0][0], DIRECTIONAL_RESCALED, rgb);
    EXPECT_NEAR(rgb[0], 1, 1e-5);
    directional_ssbump(texel, &rescaled.values[0][0], 1, rgb);
    EXPECT_NEAR(rgb[0], 1.73205, 1e-5);
}

TEST(Ssbump, FlatTexelOnRescaledMapsGivesTheFlatLightForAnyLamps) {
    LightSets sets(11);
    const float texel[3] = {147 / 255.0f, 147 / 255.0f, 147 / 255.0f}; // 0.57735 * 255
    for (int i = 0; i < 1000; i++) {
        const auto lamps = sets.Lamps(kFlat);
        const Vec3f flat = Received(lamps, kFlat);
        float rgb[3];
        const MapArray maps(RescaleToFlat(RawMaps(lamps), flat));
        directional_ssbump(texel, &maps.values[0][0], DIRECTIONAL_RESCALED, rgb);
        for (std::size_t c = 0; c < 3; c++)
            EXPECT_NEAR(rgb[c], flat[c], flat[c] * 0.5 / 147 + 1e-6);
    }
}

TEST(Ssbump, UnoccludedTexelGivesTheCosineToTheByteStep) {
    // Three bytes, each wrong by at most half a step, times maps of at most 1 (sum sqrt(3) for a unit light).
    LightSets sets(6);
    for (int i = 0; i < 1000; i++) {
        const Vec3f light = Tilted(sets.Uniform(0, 35), sets.Uniform(0, 360)),
                    normal = Tilted(sets.Uniform(0, 35), sets.Uniform(0, 360));
        const float n[3] = {normal.x, normal.y, normal.z}, w[3] = {light.x, light.y, light.z};
        float texel[3], rgb[3], back[3];
        directional_rnm_weights(n, texel);
        for (float &channel : texel)
            channel = std::round(channel * 255) / 255;
        const MapArray maps(OneWhite(light));
        directional_ssbump(texel, &maps.values[0][0], DIRECTIONAL_RAW, rgb);
        EXPECT_NEAR(rgb[0], Dot(light, normal), 0.87 / 255);
        EXPECT_NEAR(directional_ssbump_light(texel, w), Dot(light, normal), 0.87 / 255);
        directional_ssbump_normal(texel, back);
        EXPECT_GT(Dot(Vec3f{back[0], back[1], back[2]}, normal), 0.99999);
    }
    const float black[3] = {0, 0, 0};
    float flat[3];
    directional_ssbump_normal(black, flat);
    EXPECT_EQ(flat[2], 1);
}

} // namespace

} // namespace q3::test
