// GPL-2.0-or-later. The light of luxels in every encoding.
#include "tools/measure/bump_wall/encodings.h"

#include "libs/directional/directional.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3::bump_wall {

namespace {

/// directional_deluxe_received divides by the cosine at the flat normal, or by this if that is less.
constexpr float kLeastCosine = 0.25f;
constexpr Vec3f kFlatNormal{0, 0, 1};
constexpr float kFlat[3] = {0, 0, 1};

constexpr EncodingInfo kEncodings[] = {
    {Encoding::Flat, "flat lightmap", "1 color", 4},
    {Encoding::Deluxe, "deluxe, light * n.d", "1 color, direction", 7},
    {Encoding::DeluxeReceived, "deluxe, / flat.d", "1 color, direction", 7},
    {Encoding::RnmRaw, "RNM raw, linear weights", "3 colors", 12},
    {Encoding::RnmRescaled, "RNM rescaled, linear", "3 colors", 12},
    {Encoding::RnmSquared, "RNM rescaled, squared", "3 colors", 12},
    {Encoding::L1, "L1 SH, RGB", "12 floats", 24},
    {Encoding::L1Curved, "L1 SH, curved", "12 floats", 24},
    {Encoding::L1WithFlat, "L1 SH, curved, to flat light", "12 floats, 1 color", 28},
    {Encoding::LightmassHigh, "Lightmass, high quality", "8 bytes", 8},
    {Encoding::LightmassLow, "Lightmass, low quality", "8 bytes", 8},
    {Encoding::Ssbump, "SSBump, RNM raw", "3 colors", 12},
    {Encoding::SsbumpRescaled, "SSBump, RNM rescaled", "3 colors", 12},
};

Vec3f ToVec(const float v[3]) {
    return {v[0], v[1], v[2]};
}

/// Light from a uniform hemisphere on `normal`, relative to the flat normal.
float SkyShare(const Vec3f &normal) {
    return (1 + normal.z) / 2;
}

/// A uniform sky. The integrals of the basis over the hemisphere are 2 pi k0 for the constant function, pi k1 for z.
L1Light SkyL1(const Vec3f &color) {
    L1Light light;
    light.c[0] = color * float(2 * std::numbers::pi * kSHC0);
    light.c[2] = color * float(std::numbers::pi * kSHC1);
    return light;
}

} // namespace

std::span<const EncodingInfo> Encodings() {
    return kEncodings;
}

Vec3f Received(const LocalLight &light, const Vec3f &normal) {
    Vec3f sum = light.sky * SkyShare(normal);
    for (const Ray &ray : light.rays)
        sum += ray.color * std::max(0.0f, Dot(normal, ray.direction));
    return sum;
}

EncodedLuxels::EncodedLuxels(std::span<const LocalLight> luxels) {
    std::vector<lightmass::LuxelLight> coefficients;
    for (const LocalLight &light : luxels) {
        Luxel luxel;
        luxel.flat = Received(light, kFlatNormal);
        luxel.direction = kFlatNormal * DirectionalLuminance(light.sky);
        luxel.l1 = SkyL1(light.sky);
        for (std::size_t i = 0; i < 3; i++)
            luxel.raw.map[i] = Received(light, kRnmBasis[i]);
        for (const Ray &ray : light.rays) {
            luxel.direction += ray.direction * (DirectionalLuminance(ray.color) * std::max(0.0f, ray.direction.z));
            luxel.l1.AddLight(ray.color, ray.direction);
        }
        luxel.direction = Normalize(luxel.direction);
        luxel.rescaled = RescaleToFlat(luxel.raw, luxel.flat);
        luxels_.push_back(luxel);

        lightmass::GatheredLuxel gathered;
        gathered.high.AddL1(luxel.l1, luxel.flat, kFlatNormal);
        gathered.low = gathered.high;
        gathered.normal = kFlatNormal;
        gathered.mapped = true;
        coefficients.push_back(lightmass::ToCoefficients(gathered));
    }
    lightmass_ = lightmass::Quantize(int(luxels.size()), 1, coefficients);
}

template <typename Value, typename Member> Value EncodedLuxels::Filtered(const Corners &corners, Member member) const {
    Value sum{};
    for (std::size_t i = 0; i < 4; i++)
        sum += member(luxels_[corners.index[i]]) * corners.share[i];
    return sum;
}

Vec3f EncodedLuxels::DecodedDeluxe(Encoding encoding, const Corners &corners, const float normal[3]) const {
    const auto flat = Filtered<Vec3f>(corners, [](const Luxel &l) { return l.flat; }).Array();
    const auto direction = Normalize(Filtered<Vec3f>(corners, [](const Luxel &l) { return l.direction; })).Array();
    float rgb[3] = {flat[0], flat[1], flat[2]};
    if (encoding == Encoding::Deluxe)
        directional_deluxe(flat.data(), direction.data(), normal, rgb);
    else if (encoding == Encoding::DeluxeReceived)
        directional_deluxe_received(flat.data(), direction.data(), kFlat, kLeastCosine, normal, rgb);
    return ToVec(rgb);
}

Vec3f EncodedLuxels::DecodedRnm(Encoding encoding, const Corners &corners, const float normal[3],
                                const std::array<float, 3> &texel) const {
    const bool raw = encoding == Encoding::RnmRaw || encoding == Encoding::Ssbump;
    float maps[3][3], rgb[3];
    for (std::size_t i = 0; i < 3; i++) {
        const auto map = Filtered<Vec3f>(corners, [&](const Luxel &l) { return (raw ? l.raw : l.rescaled).map[i]; });
        for (std::size_t c = 0; c < 3; c++)
            maps[i][c] = map[c];
    }
    if (encoding == Encoding::Ssbump)
        directional_ssbump(texel.data(), &maps[0][0], DIRECTIONAL_RAW, rgb);
    else if (encoding == Encoding::SsbumpRescaled)
        directional_ssbump(texel.data(), &maps[0][0], DIRECTIONAL_RESCALED, rgb);
    else if (encoding == Encoding::RnmRaw)
        directional_rnm_raw(&maps[0][0], normal, rgb);
    else if (encoding == Encoding::RnmRescaled)
        directional_rnm_rescaled(&maps[0][0], normal, rgb);
    else
        directional_rnm_squared(&maps[0][0], normal, rgb);
    return ToVec(rgb);
}

Vec3f EncodedLuxels::DecodedL1(Encoding encoding, const Corners &corners, const float normal[3]) const {
    const auto l1 = Filtered<L1Light>(corners, [](const Luxel &l) { return l.l1; });
    const auto flat = Filtered<Vec3f>(corners, [](const Luxel &l) { return l.flat; }).Array();
    float sh[4][3], rgb[3];
    for (std::size_t k = 0; k < 4; k++)
        for (std::size_t c = 0; c < 3; c++)
            sh[k][c] = l1.c[k][c];
    if (encoding == Encoding::L1)
        directional_l1(&sh[0][0], normal, rgb);
    else if (encoding == Encoding::L1Curved)
        directional_l1_curved(&sh[0][0], normal, rgb);
    else
        directional_l1_with_flat(&sh[0][0], flat.data(), kFlat, normal, rgb);
    return ToVec(rgb);
}

Vec3f EncodedLuxels::DecodedLightmass(std::size_t image, const Corners &corners, const float normal[3]) const {
    float color[4] = {}, direction[4] = {}, rgb[3];
    directional_range range;
    for (std::size_t k = 0; k < 4; k++) {
        for (std::size_t i = 0; i < 4; i++) {
            const auto &bytes = lightmass_.luxels[corners.index[i]].coefficients;
            color[k] += corners.share[i] * float(bytes[image][k]) / 255;
            direction[k] += corners.share[i] * float(bytes[image + 1][k]) / 255;
        }
        for (std::size_t which = 0; which < 2; which++) {
            range.multiply[which][k] = lightmass_.range.multiply[image + which][k];
            range.add[which][k] = lightmass_.range.add[image + which][k];
        }
    }
    if (image == lightmass::kHigh)
        directional_lightmass_high(color, direction, &range, normal, rgb);
    else
        directional_lightmass_low(color, direction, &range, normal, rgb);
    return ToVec(rgb);
}

Vec3f EncodedLuxels::Decoded(Encoding encoding, const Corners &corners, const Vec3f &normal,
                             const std::array<float, 3> &texel) const {
    const float n[3] = {normal.x, normal.y, normal.z};
    switch (encoding) {
    case Encoding::Flat:
    case Encoding::Deluxe:
    case Encoding::DeluxeReceived:
        return DecodedDeluxe(encoding, corners, n);
    case Encoding::L1:
    case Encoding::L1WithFlat:
    case Encoding::L1Curved:
        return DecodedL1(encoding, corners, n);
    case Encoding::LightmassHigh:
        return DecodedLightmass(lightmass::kHigh, corners, n);
    case Encoding::LightmassLow:
        return DecodedLightmass(lightmass::kLow, corners, n);
    default:
        return DecodedRnm(encoding, corners, n, texel);
    }
}

} // namespace q3::bump_wall
