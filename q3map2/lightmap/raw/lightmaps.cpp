// GPL-2.0-or-later. Records of light on surfaces that the passes from luxel mapping to storing share, and the choice of
// their light styles.
#include "q3map2/lightmap/raw/lightmaps.h"

#include "libs/math/rnm_basis.h"
#include "q3map2/light/sources/light_styles.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace q3 {

// ---- The light styles of a surface: slots, and the choice if more reach it than it can hold ----

bool StyleChoice::IsNeeded(std::span<const Light *const> lights) {
    std::set<int> styles{0};
    for (const Light *light : lights)
        styles.insert(light->style);
    return styles.size() > kStyles;
}

void StyleChoice::Add(const Light &light, double energy) {
    if (!(std::abs(energy) > 0))
        return;
    energies_[light.style] += std::abs(energy);
    lights_.push_back(&light);
}

void StyleChoice::Choose() {
    std::vector<std::pair<double, int>> order; // most light first
    for (const auto &[style, energy] : energies_)
        if (style != 0)
            order.emplace_back(-energy, style);
    std::sort(order.begin(), order.end());
    for (std::size_t i = kStyles - 1; i < order.size(); ++i)
        dropped_.insert(order[i].second);
}

std::vector<std::string> StyleChoice::DroppedLightNames() const {
    std::vector<std::string> names;
    for (const Light *light : lights_) {
        if (!Drops(light->style))
            continue;
        std::string name = StyledLightName(*light);
        if (std::find(names.begin(), names.end(), name) == names.end())
            names.push_back(std::move(name));
    }
    return names;
}

void WarnOfDroppedLights(const DroppedLights &dropped, std::string_view light, std::string_view what, Log &log) {
    DroppedLightCounts counts;
    for (const std::vector<std::string> &names : dropped)
        for (const std::string &name : names)
            counts.Add(name);
    counts.Warn(light, what, log);
}

// ---- Directional channels of luxels: L1 SH, and light on the RNM basis normals ----

BasisNormals BasisNormalsOf(const Vec3f &normal, const LuxelTangent &tangent) {
    constexpr float kLeastLength = 1e-4f; // sine of the angle from the normal; below, the tangent gives no axis
    Vec3f across = Cross(normal, tangent.s);
    if (Length(across) < kLeastLength)
        across = Cross(normal, std::abs(normal.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1}); // far from parallel
    across = Normalize(across);
    const Vec3f s = Cross(across, normal), t = across * tangent.side;
    BasisNormals normals;
    for (std::size_t i = 0; i < normals.size(); ++i)
        normals[i] = s * kRnmBasis[i].x + t * kRnmBasis[i].y + normal * kRnmBasis[i].z;
    return normals;
}

ChannelWeights WeightsOf(const Vec3f &w, const DirectionalChannels &channels, const BasisNormals *basis) {
    ChannelWeights weights{};
    if (channels.sh)
        weights = {kDirectedSH0, kDirectedSH1 * w.y, kDirectedSH1 * w.z, kDirectedSH1 * w.x};
    for (std::size_t i = 0; basis && i < DirectionalChannels::kBasis; ++i)
        weights[channels.FirstBasis() + i] = std::max(0.0f, Dot((*basis)[i], w));
    return weights;
}

ChannelWeights UniformWeights(const DirectionalChannels &channels) {
    ChannelWeights weights{};
    if (channels.sh)
        weights[0] = kUniformSH0;
    for (std::size_t i = 0; channels.basis && i < DirectionalChannels::kBasis; ++i)
        weights[channels.FirstBasis() + i] = 1;
    return weights;
}

// ---- Masks of luxels ----

LuxelMask Dilate(const LuxelMask &mask, int width, int height) {
    const auto w = std::size_t(std::max(width, 0));
    LuxelMask spread(mask.size()), row(w + 2); // with a zero column on either side
    for (int y = 0; y < height; ++y) {
        const std::uint8_t *center = mask.data() + std::size_t(y) * w;
        const std::uint8_t *above = y > 0 ? center - w : center, *below = y + 1 < height ? center + w : center;
        for (std::size_t x = 0; x < w; ++x)
            row[x + 1] = std::uint8_t(above[x] | center[x] | below[x]);
        std::uint8_t *to = spread.data() + std::size_t(y) * w;
        for (std::size_t x = 0; x < w; ++x)
            to[x] = std::uint8_t(row[x] | row[x + 1] | row[x + 2]);
    }
    return spread;
}

} // namespace q3
