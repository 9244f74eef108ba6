// GPL-2.0-or-later. The light of the wall in every encoding.
#include "tools/bump_wall/encodings.h"

#include "libs/directional/directional.h"

#include <algorithm>
#include <cmath>

namespace q3::bump_wall {

namespace {

constexpr float kLeastCosine = 0.25f; // of directional_deluxe_received

Vec3f ToVec(const float v[3]) {
    return {v[0], v[1], v[2]};
}

} // namespace

LuxelGrid::LuxelGrid(float spacing)
    : spacing_(spacing), columns_(int(std::ceil(kWidth / spacing)) + 1), rows_(int(std::ceil(kHeight / spacing)) + 1) {
    std::vector<lightmass::LuxelLight> lights;
    for (int row = 0; row < rows_; row++)
        for (int column = 0; column < columns_; column++) {
            const float x = float(column) * spacing, y = float(row) * spacing;
            luxels_.push_back(Baked(x, y));
            lightmass::GatheredLuxel gathered;
            for (const Ray &ray : LampsAt({x, y, 0}))
                gathered.high.AddLight(ray.color, ray.direction, kFlatNormal);
            gathered.low = gathered.high;
            gathered.normal = kFlatNormal;
            gathered.mapped = true;
            lights.push_back(lightmass::ToCoefficients(gathered));
        }
    lightmass_ = lightmass::Quantize(columns_, rows_, lights);
}

LuxelGrid::Luxel LuxelGrid::Baked(float x, float y) const {
    Luxel luxel;
    for (const Ray &ray : LampsAt({x, y, 0})) {
        const float down = std::max(0.0f, Dot(ray.direction, kFlatNormal));
        luxel.flat += ray.color * down;
        luxel.direction += ray.direction * (DirectionalLuminance(ray.color) * down);
        luxel.raw.AddLight(ray.color, ray.direction);
        luxel.l1.AddLight(ray.color, ray.direction);
    }
    luxel.direction = Normalize(luxel.direction);
    luxel.rescaled = RescaleToFlat(luxel.raw, luxel.flat);
    return luxel;
}

LuxelGrid::Corners LuxelGrid::Around(float x, float y) const {
    const float column = std::clamp(x / spacing_, 0.0f, float(columns_ - 1) - 1e-3f),
                row = std::clamp(y / spacing_, 0.0f, float(rows_ - 1) - 1e-3f);
    const float fx = column - std::floor(column), fy = row - std::floor(row);
    const auto at = std::size_t(row) * std::size_t(columns_) + std::size_t(column), below = at + std::size_t(columns_);
    return {{at, at + 1, below, below + 1}, {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy}};
}

template <typename Value, typename Member> Value LuxelGrid::Filtered(const Corners &corners, Member member) const {
    Value sum{};
    for (std::size_t i = 0; i < 4; i++)
        sum += member(luxels_[corners.index[i]]) * corners.share[i];
    return sum;
}

Vec3f LuxelGrid::DecodedRnm(Encoding encoding, const Corners &corners, const float normal[3],
                            const std::array<float, 3> &texel) const {
    const bool raw = encoding == Encoding::RnmRaw || encoding == Encoding::Ssbump;
    float maps[3][3], rgb[3];
    for (std::size_t i = 0; i < 3; i++) {
        const auto map = Filtered<Vec3f>(corners, [&](const Luxel &l) { return (raw ? l.raw : l.rescaled).map[i]; });
        for (std::size_t c = 0; c < 3; c++)
            maps[i][c] = map[c];
    }
    if (encoding == Encoding::Ssbump)
        directional_ssbump(texel.data(), maps, DIRECTIONAL_RAW, rgb);
    else if (encoding == Encoding::SsbumpRescaled)
        directional_ssbump(texel.data(), maps, DIRECTIONAL_RESCALED, rgb);
    else if (encoding == Encoding::RnmRaw)
        directional_rnm_raw(maps, normal, rgb);
    else if (encoding == Encoding::RnmRescaled)
        directional_rnm_rescaled(maps, normal, rgb);
    else
        directional_rnm_squared(maps, normal, rgb);
    return ToVec(rgb);
}

Vec3f LuxelGrid::DecodedLightmass(std::size_t image, const Corners &corners, const float normal[3]) const {
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
    (image == lightmass::kHigh ? directional_lightmass_high : directional_lightmass_low)(color, direction, &range,
                                                                                         normal, rgb);
    return ToVec(rgb);
}

Vec3f LuxelGrid::Decoded(Encoding encoding, float x, float y, const Vec3f &normal,
                         const std::array<float, 3> &texel) const {
    const Corners corners = Around(x, y);
    const float n[3] = {normal.x, normal.y, normal.z}, up[3] = {0, 0, 1};
    const auto flat = Filtered<Vec3f>(corners, [](const Luxel &l) { return l.flat; }).Array();
    const auto direction = Normalize(Filtered<Vec3f>(corners, [](const Luxel &l) { return l.direction; })).Array();
    float rgb[3] = {flat[0], flat[1], flat[2]};
    switch (encoding) {
    case Encoding::Flat:
        break;
    case Encoding::Deluxe:
        directional_deluxe(flat.data(), direction.data(), n, rgb);
        break;
    case Encoding::DeluxeReceived:
        directional_deluxe_received(flat.data(), direction.data(), up, kLeastCosine, n, rgb);
        break;
    case Encoding::L1:
    case Encoding::L1WithFlat:
    case Encoding::L1Curved: {
        const auto l1 = Filtered<L1Light>(corners, [](const Luxel &l) { return l.l1; });
        float sh[4][3];
        for (std::size_t k = 0; k < 4; k++)
            for (std::size_t c = 0; c < 3; c++)
                sh[k][c] = l1.c[k][c];
        if (encoding == Encoding::L1)
            directional_l1(sh, n, rgb);
        else if (encoding == Encoding::L1Curved)
            directional_l1_curved(sh, n, rgb);
        else
            directional_l1_with_flat(sh, flat.data(), up, n, rgb);
        break;
    }
    case Encoding::High:
    case Encoding::Low:
        return DecodedLightmass(encoding == Encoding::High ? lightmass::kHigh : lightmass::kLow, corners, n);
    default:
        return DecodedRnm(encoding, corners, n, texel);
    }
    return ToVec(rgb);
}

} // namespace q3::bump_wall
