// GPL-2.0-or-later. Lamps, and the light that one of them gives to the observed places.
#include "q3map2/recover/lamp_light.h"

#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/transfer/light_contribution.h"
#include "q3map2/light/transfer/light_sample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

float MeanTint(const IncidentLight &incident, std::size_t lane) {
    if (!incident.tinted)
        return 1;
    return MeanOfChannels(incident.tint[lane]);
}

/// Appends the light of the live receivers of a batch, times `scale`. Their numbers follow `first`.
void Append(const IncidentLight &incident, std::size_t count, std::size_t first, float scale, const float *factors,
            LampColumn &column) {
    for (std::size_t i = 0; i < count; ++i)
        if (incident.live[i] != 0) {
            const float light = incident.strength[i] * MeanTint(incident, i) * scale * (factors ? factors[i] : 1);
            column.push_back({std::uint32_t(first + i), light});
        }
}

} // namespace

std::vector<Entity> LampEntities(std::span<const Lamp> lamps, std::size_t first) {
    constexpr float kToTarget = 256, kLeastRadius = 1; // game units
    std::vector<Entity> entities;
    const auto vector = [](const Vec3f &v) { return fmt::format("{:.1f} {:.1f} {:.1f}", v.x, v.y, v.z); };
    for (const Lamp &lamp : lamps) {
        const Vec3f color = lamp.Color();
        Entity &entity = entities.emplace_back();
        entity.Set("classname", "light");
        entity.Set("origin", vector(lamp.origin));
        entity.Set("light", fmt::format("{:.2f}", lamp.Intensity()));
        if (!(color == Vec3f{1, 1, 1}))
            entity.Set("_color", fmt::format("{:.4f} {:.4f} {:.4f}", color.x, color.y, color.z));
        if (!lamp.cone)
            continue;
        const std::string name = fmt::format("recovered_spot_{}", first++);
        const float distance = std::max(kToTarget, (kConeMargin + kLeastRadius) / lamp.cone->radiusByDist);
        entity.Set("target", name);
        entity.Set("radius", fmt::format("{:.2f}", lamp.cone->radiusByDist * distance - kConeMargin));
        Entity &target = entities.emplace_back();
        target.Set("classname", "info_null");
        target.Set("targetname", name);
        target.Set("origin", vector(lamp.origin + lamp.cone->axis * distance));
    }
    return entities;
}

float LampTracer::ReachOf(float strength, float least) const {
    const float scale = std::max(setup_.options.pointScale, setup_.options.spotScale);
    return std::sqrt(std::max(0.0f, scale * strength / least));
}

Light LampTracer::LightOf(const Lamp &lamp, float reach, int cluster) const {
    Light light;
    light.photons = setup_.options.pointScale * lamp.Intensity();
    if (lamp.cone) {
        light.type = LightType::Spot;
        light.photons = setup_.options.spotScale * lamp.Intensity();
        light.normal = lamp.cone->axis, light.radiusByDist = lamp.cone->radiusByDist;
    }
    light.tolerance = setup_.options.tolerance;
    light.origin = lamp.origin;
    light.extraDist = setup_.options.extraDist;
    light.clusters = {cluster};
    const int clusters = setup_.space.ClusterCount();
    light.seenFrom.resize(std::size_t(clusters));
    for (int other = 0; other < clusters; ++other)
        light.seenFrom[std::size_t(other)] = setup_.space.Visible(cluster, other);
    light.envelope = reach;
    const Vec3f half{reach, reach, reach};
    light.bounds = {lamp.origin - half, lamp.origin + half};
    return light;
}

LampColumn LampTracer::Trace(const Lamp &lamp, std::size_t every) const {
    constexpr float kFaint = 0.25f; // where lamps do not end at the tolerance. Byte scale
    LampColumn column;
    const int cluster = setup_.space.ClusterAt(lamp.origin, 0);
    if (cluster == kSolidCluster)
        return column;
    const float reach = ReachOf(lamp.Intensity(), surfacesEnd_ ? setup_.options.tolerance : kFaint);
    const float scale = 1 / lamp.Intensity();
    Light light = LightOf(lamp, reach, cluster);
    light.endsAtTolerance = surfacesEnd_;
    ContributionCounts counts;
    for (const ObservedSurface &surface : map_.surfaces) {
        const std::size_t step = std::clamp<std::size_t>(surface.batches.size() / 2, 1, every);
        for (std::size_t b = 0; b < surface.batches.size(); b += step) {
            if (surface.boxes[b].Distance(lamp.origin) > reach)
                continue;
            SurfaceReceiverBatch batch = surface.batches[b];
            SurfaceIncidentLight incident;
            LightContributionToSample(light, surface.settings, setup_.scene, batch, incident, counts);
            Append(incident, batch.count, surface.first + b * kPacketSize, scale,
                   surface.dirt.empty() ? nullptr : &surface.dirt[b * kPacketSize], column);
        }
    }
    light.endsAtTolerance = true;
    LightSettings settings;
    settings.shadows = !setup_.options.noTrace;
    for (std::size_t b = 0; b < map_.grid.size(); b += every) {
        if (map_.gridBoxes[b].Distance(lamp.origin) > reach)
            continue;
        ReceiverBatch batch = map_.grid[b];
        ProbeIncidentLight incident;
        LightContributionToPoint(light, 1, settings, setup_.scene, {&batch, 1}, {&incident, 1}, counts);
        Append(incident, batch.count, map_.firstGrid + b * kPacketSize, scale, nullptr, column);
    }
    return column;
}

} // namespace q3
