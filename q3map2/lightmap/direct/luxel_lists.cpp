// GPL-2.0-or-later. Culling of lights for a raw lightmap.
#include "q3map2/lightmap/direct/luxel_lists.h"

#include <algorithm>
#include <bit>

namespace q3 {

namespace {

/// A light does not light a surface whose normal has at least this cosine with its own.
constexpr float kSameFacing = 0.999f;
/// Lights up to this far behind the plane of a surface count. Game units.
constexpr float kBehindPlane = 1;

/// Whether the light can reach the front side of a plane.
bool OnLitSide(const Light &light, const Vec3f &center, const Vec3f &normal) {
    if (!light.twoSided && Dot(light.normal, normal) > kSameFacing)
        return false;
    const Vec3f origin = light.type == LightType::Sun ? light.normal * -kSunDistance : light.origin;
    return Dot(origin - center, normal) >= -kBehindPlane;
}

} // namespace

LuxelLights::LuxelLights(const std::vector<Light> &lights, const BspSpace &space)
    : lights_(lights), words_((lights.size() + 63) / 64), suns_(words_),
      rows_(words_ * std::size_t(space.ClusterCount())) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::uint64_t bit = std::uint64_t(1) << (i % 64);
        if (lights[i].type == LightType::Sun) {
            suns_[i / 64] |= bit;
            continue;
        }
        for (int cluster = 0; cluster < space.ClusterCount(); ++cluster)
            if (lights[i].SeenFrom(cluster))
                rows_[std::size_t(cluster) * words_ + i / 64] |= bit;
    }
}

void LuxelLightList::Build(const LuxelLights &all, const RawLightmap &lightmap, bool sunOnly) {
    list_.clear();
    seen_ = all.suns_;
    if (lightmap.clusters.empty())
        seen_.assign(all.words_, ~std::uint64_t(0));
    clusters_ = lightmap.clusters;
    std::sort(clusters_.begin(), clusters_.end());
    clusters_.erase(std::unique(clusters_.begin(), clusters_.end()), clusters_.end());
    for (const int cluster : clusters_)
        if (cluster >= 0 && (std::size_t(cluster) + 1) * all.words_ <= all.rows_.size())
            for (std::size_t word = 0; word < all.words_; ++word)
                seen_[word] |= all.rows_[std::size_t(cluster) * all.words_ + word];
    const Vec3f center = lightmap.bounds.Center();
    const float radius = 0.5f * Length(lightmap.bounds.maxs - lightmap.bounds.mins);
    for (std::size_t word = 0; word < all.words_; ++word)
        for (std::uint64_t bits = seen_[word]; bits != 0; bits &= bits - 1) {
            const std::size_t number = word * 64 + std::size_t(std::countr_zero(bits));
            if (number >= all.lights_.size())
                break;
            const Light &light = all.lights_[number];
            const bool sun = light.type == LightType::Sun;
            if (!light.surfaces || light.envelope <= 0 || (sunOnly && !sun))
                continue;
            if (!sun && Length(light.origin - center) - light.envelope - radius > 0)
                continue;
            if (lightmap.planar && !lightmap.twoSided && !OnLitSide(light, center, lightmap.planeNormal))
                continue;
            list_.push_back(&light);
        }
}

} // namespace q3
