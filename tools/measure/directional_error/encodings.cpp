// GPL-2.0-or-later. The encodings of a luxel's light that are compared.
#include "tools/measure/directional_error/encodings.h"

#include "libs/directional/directional.h"
#include "libs/math/packed_color.h"
#include "q3map2/lightmap/encode/directional_encode.h"

#include <cmath>

namespace q3::directional {

namespace {

using Maps = std::array<Vec3f, 3>;
using Store = Vec3f (*)(const Vec3f &);

// Stores: a color after a round trip through a storage format.

Vec3f AsFloat(const Vec3f &color) {
    return color;
}

Vec3f AsBytes(const Vec3f &color) {
    const auto byte = [](float c) { return std::round(std::clamp(c, 0.0f, 1.0f) * 255) / 255; };
    return {byte(color.x), byte(color.y), byte(color.z)};
}

Vec3f AsE5bgr9(const Vec3f &color) {
    return DecodeE5bgr9(EncodeE5bgr9(color));
}

/// Half floats: 11 bits of mantissa, and no limits of their exponent.
Vec3f AsHalf(const Vec3f &color) {
    const auto half = [](float c) {
        int exponent = 0;
        const float mantissa = std::frexp(c, &exponent);
        constexpr float kSteps = 2048; // 2^11
        return std::ldexp(std::round(mantissa * kSteps) / kSteps, exponent);
    };
    return {half(color.x), half(color.y), half(color.z)};
}

/// Arrays as the C decoders of libs/directional take them.
struct CMaps {
    explicit CMaps(const Maps &maps) {
        for (std::size_t i = 0; i < 3; ++i)
            value[i][0] = maps[i].x, value[i][1] = maps[i].y, value[i][2] = maps[i].z;
    }
    float value[3][3];
};

/// A vector, likewise.
struct C3 {
    explicit C3(const Vec3f &v) : value{v.x, v.y, v.z} {}
    float value[3];
};

Vec3f FromC(const float rgb[3]) {
    return {rgb[0], rgb[1], rgb[2]};
}

Encoding FlatEncoding(const std::string &name, double bytes, Store store) {
    return {name, bytes, [store](const LuxelSample &luxel, const Vec3f &) { return store(luxel.flat); }};
}

Encoding DeluxeEncoding(const std::string &name, double bytes, Store store) {
    return {name, bytes, [store](const LuxelSample &luxel, const Vec3f &n) {
                constexpr float kLeastCosine = 0.25f; // the decoder divides by no less
                float rgb[3];
                const Vec3f direction = store(luxel.direction * 0.5f + Vec3f{0.5f, 0.5f, 0.5f});
                const C3 d(Normalize(direction * 2 - Vec3f{1, 1, 1}));
                directional_deluxe_received(C3(store(luxel.flat)).value, d.value, C3(luxel.normal).value, kLeastCosine,
                                            C3(n).value, rgb);
                return FromC(rgb);
            }};
}

enum class Rnm { Raw, Corrected, Squared, Rescaled, RescaledSquared };

Encoding RnmEncoding(const std::string &name, double bytes, Rnm kind, Store store) {
    return {name, bytes, [kind, store](const LuxelSample &luxel, const Vec3f &n) {
                const bool rescaled = kind == Rnm::Rescaled || kind == Rnm::RescaledSquared;
                RnmLight light = rescaled ? RescaleToFlat({luxel.onBasis}, luxel.flat) : RnmLight{luxel.onBasis};
                if (rescaled && store == AsBytes)
                    light = OverflowToOthers(light);
                light = {{store(light.map[0]), store(light.map[1]), store(light.map[2])}};
                if (kind == Rnm::Corrected)
                    light = RescaleToFlat(light, store(luxel.flat));
                const CMaps maps(light.map);
                const C3 local(luxel.InTangentSpace(n));
                float rgb[3];
                if (kind == Rnm::Raw)
                    directional_rnm_raw(&maps.value[0][0], local.value, rgb);
                else if (kind == Rnm::Rescaled || kind == Rnm::Corrected)
                    directional_rnm_rescaled(&maps.value[0][0], local.value, rgb);
                else
                    directional_rnm_squared(&maps.value[0][0], local.value, rgb);
                return FromC(rgb);
            }};
}

/// Texels without occlusion, so that only the light differs from RNM.
Encoding SsbumpEncoding(const std::string &name, double bytes, Rnm kind, Store store) {
    return {name, bytes, [rescaled = kind == Rnm::Rescaled, store](const LuxelSample &luxel, const Vec3f &n) {
                RnmLight light{luxel.onBasis};
                if (rescaled)
                    light = RescaleToFlat(light, luxel.flat);
                if (rescaled && store == AsBytes)
                    light = OverflowToOthers(light);
                const CMaps maps(Maps{store(light.map[0]), store(light.map[1]), store(light.map[2])});
                float weights[3], rgb[3];
                directional_rnm_weights(C3(luxel.InTangentSpace(n)).value, weights);
                const Vec3f texel = store(FromC(weights));
                directional_ssbump(C3(texel).value, &maps.value[0][0],
                                   rescaled ? DIRECTIONAL_RESCALED : DIRECTIONAL_RAW, rgb);
                return FromC(rgb);
            }};
}

/// Whether a decoded value is corrected so that it equals the flat light at the luxel's normal.
enum class FlatLight { Unused, Corrects };

Encoding L1Encoding(const std::string &name, double bytes, FlatLight flat, Store store) {
    return {name, bytes, [flat, store](const LuxelSample &luxel, const Vec3f &n) {
                float sh[4][3], rgb[3];
                for (std::size_t i = 0; i < 4; ++i) {
                    const C3 one(store(luxel.sh[i]));
                    std::copy_n(one.value, 3, sh[i]);
                }
                if (flat == FlatLight::Corrects)
                    directional_l1_with_flat(&sh[0][0], C3(store(luxel.flat)).value, C3(luxel.normal).value,
                                             C3(n).value, rgb);
                else
                    directional_l1(&sh[0][0], C3(n).value, rgb);
                return FromC(rgb);
            }};
}

/// Decoded from the float coefficients, before quantizing. 28 bytes: floats in place of the 7 bytes of low quality.
Encoding LightmassFloat(const std::string &name, std::size_t image) {
    return {name, 28, [image](const LuxelSample &luxel, const Vec3f &n) {
                const Vec3f &color = luxel.lightmass.coefficients[image], &d = luxel.lightmass.coefficients[image + 1];
                // The band 1 of SH has the order y, z, x.
                return color * std::max(0.0f, kL1Flat + d.x * n.y + d.y * n.z + d.z * n.x);
            }};
}

Encoding LightmassStored(const std::string &name, double bytes, std::size_t image) {
    return {name, bytes, [image](const LuxelSample &luxel, const Vec3f &n) {
                float color[4], direction[4], rgb[3];
                directional_texel(luxel.lightmassBytes.coefficients[image].data(), color);
                directional_texel(luxel.lightmassBytes.coefficients[image + 1].data(), direction);
                directional_range range;
                for (std::size_t i = 0; i < 2; ++i)
                    for (std::size_t k = 0; k < 4; ++k) {
                        range.multiply[i][k] = luxel.range->multiply[image + i][k];
                        range.add[i][k] = luxel.range->add[image + i][k];
                    }
                if (image == lightmass::kHigh)
                    directional_lightmass_high(color, direction, &range, C3(n).value, rgb);
                else
                    directional_lightmass_low(color, direction, &range, C3(n).value, rgb);
                return FromC(rgb);
            }};
}

lightmass::Lightmap EncodeLightmap(const RawLightmap &raw, std::vector<lightmass::LuxelLight> &luxels) {
    for (std::size_t i = 0; i < raw.result[0].size(); ++i) {
        lightmass::GatheredLuxel luxel;
        luxel.mapped = raw.result[0][i].x >= 0;
        luxel.normal = raw.Mapped(i) ? raw.normals[i] : raw.planeNormal;
        L1Light l1;
        for (std::size_t c = 0; c < 4; ++c)
            l1.c[c] = raw.resultChannels[0][c][i] / 255;
        luxel.high.AddL1(l1, Max(raw.result[0][i], Vec3f{}) / 255, luxel.normal);
        luxel.low = luxel.high;
        luxels.push_back(lightmass::ToCoefficients(luxel));
    }
    return lightmass::Quantize(raw.width, raw.height, luxels);
}

} // namespace

float LuxelSample::TangentComponent(std::size_t axis, const Vec3f &n) const {
    float sum = 0;
    for (std::size_t i = 0; i < 3; ++i)
        sum += Dot(n, basis[i]) * kRnmBasis[i][axis];
    return sum;
}

std::vector<Encoding> AllEncodings() {
    return {FlatEncoding("flat, float", 12, AsFloat),
            FlatEncoding("flat, bytes", 3, AsBytes),
            FlatEncoding("flat, E5BGR9", 4, AsE5bgr9),
            DeluxeEncoding("deluxe, float", 24, AsFloat),
            DeluxeEncoding("deluxe, bytes", 6, AsBytes),
            RnmEncoding("RNM raw, linear, float", 36, Rnm::Raw, AsFloat),
            RnmEncoding("RNM raw, squared, float", 36, Rnm::Squared, AsFloat),
            RnmEncoding("RNM raw, corrected by flat, float", 48, Rnm::Corrected, AsFloat),
            RnmEncoding("RNM raw, corrected by flat, bytes", 12, Rnm::Corrected, AsBytes),
            RnmEncoding("RNM raw, corrected by flat, E5BGR9", 16, Rnm::Corrected, AsE5bgr9),
            RnmEncoding("RNM rescaled, linear, float", 36, Rnm::Rescaled, AsFloat),
            RnmEncoding("RNM rescaled, squared, float", 36, Rnm::RescaledSquared, AsFloat),
            RnmEncoding("RNM rescaled, squared, bytes", 9, Rnm::RescaledSquared, AsBytes),
            RnmEncoding("RNM rescaled, squared, E5BGR9", 12, Rnm::RescaledSquared, AsE5bgr9),
            SsbumpEncoding("SSBump on raw, float", 36, Rnm::Raw, AsFloat),
            SsbumpEncoding("SSBump on rescaled, float", 36, Rnm::Rescaled, AsFloat),
            SsbumpEncoding("SSBump on rescaled, bytes", 9, Rnm::Rescaled, AsBytes),
            L1Encoding("L1 SH, float", 48, FlatLight::Unused, AsFloat),
            L1Encoding("L1 SH, corrected by flat, float", 60, FlatLight::Corrects, AsFloat),
            L1Encoding("L1 SH, corrected by flat, half", 30, FlatLight::Corrects, AsHalf),
            LightmassFloat("Lightmass high, float", lightmass::kHigh),
            LightmassStored("Lightmass high, bytes", 8, lightmass::kHigh),
            LightmassStored("Lightmass low, bytes", 7, lightmass::kLow)};
}

std::vector<LuxelSample> MakeSamples(const LuxelBake &bake, std::span<const LuxelPlace> places,
                                     std::map<std::size_t, lightmass::Lightmap> &encoded) {
    std::vector<LuxelSample> samples;
    std::map<std::size_t, std::vector<lightmass::LuxelLight>> coefficients;
    for (const LuxelPlace &at : places) {
        const RawLightmap &raw = bake.Lightmap(at);
        if (!encoded.contains(at.lightmap))
            encoded[at.lightmap] = EncodeLightmap(raw, coefficients[at.lightmap]);
        LuxelSample &sample = samples.emplace_back();
        sample.flat = raw.result[0][at.luxel] / 255, sample.normal = raw.normals[at.luxel];
        sample.direction = Normalize(raw.resultDirections[at.luxel]);
        sample.basis = raw.BasisOf(at.luxel);
        for (std::size_t i = 0; i < 4; ++i)
            sample.sh[i] = raw.resultChannels[0][i][at.luxel] / 255;
        for (std::size_t i = 0; i < 3; ++i)
            sample.onBasis[i] = raw.resultChannels[0][raw.channels.FirstBasis() + i][at.luxel] / 255;
        sample.lightmass = coefficients[at.lightmap][at.luxel];
        sample.lightmassBytes = encoded[at.lightmap].luxels[at.luxel];
        sample.range = &encoded[at.lightmap].range;
    }
    return samples;
}

} // namespace q3::directional
