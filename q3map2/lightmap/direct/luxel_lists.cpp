// GPL-2.0-or-later. Culling of lights for a raw lightmap.
#include "q3map2/lightmap/direct/luxel_lists.h"

#include "q3map2/light/sources/falloff.h"

namespace q3 {

namespace {

/// A one-sided light does not light a surface if the cosine between their normals is above this.
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

void LuxelLightList::Build(const LightsByCluster &all, const RawLightmap &lightmap, bool sunOnly) {
    list_.clear();
    const Vec3f center = lightmap.bounds.Center();
    const float radius = 0.5f * Length(lightmap.bounds.maxs - lightmap.bounds.mins);
    const auto use = [&](std::size_t number) {
        const Light &light = all.Lights()[number];
        const bool sun = light.type == LightType::Sun;
        if (!light.surfaces || light.envelope <= 0 || (sunOnly && !sun))
            return;
        if (!sun && (Length(light.origin - center) - light.envelope - radius > 0 || ConeMisses(light, center, radius)))
            return;
        if (lightmap.planar && !lightmap.twoSided && !OnLitSide(light, center, lightmap.planeNormal))
            return;
        list_.push_back(&light);
    };
    if (!lightmap.clusters.empty())
        all.ForEach(lightmap.clusters, use);
    else
        for (std::size_t i = 0; i < all.Lights().size(); ++i)
            use(i);
}

} // namespace q3
