// GPL-2.0-or-later. The directions that the light of one source comes from, at receivers on surfaces.
#include "q3map2/light/transfer/light_directions.h"

#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/transfer/light_kernel.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Lower bound of cosines and form factors that are divided by.
constexpr float kLeastCosine = 1e-6f;

/// towardLight: light on a receiver that faces the light, divided by the light on the receiver itself.
Q3_VECTOR void FromPoint(const Lanes &towardLight, const Lanes &cosine, SurfaceIncidentLight &incident) {
    LightDirections &to = incident.directions;
    for (const std::size_t i : kEachLane) {
        const float c = std::max(cosine[i], kLeastCosine);
        const float length = cosine[i] < 0 ? 0 : std::min(towardLight[i], 1 / c);
        to.vector.x[i] = incident.direction.x[i] * length;
        to.vector.y[i] = incident.direction.y[i] * length;
        to.vector.z[i] = incident.direction.z[i] * length;
        to.uniform[i] = std::max(0.0f, 1 - length * c);
        to.spread[i] = 1;
    }
}

/// vectors: as set by FormFactorVectors.
Q3_VECTOR void FromArea(const Lanes3 &vectors, const Lanes3 &normal, const LaneMask &undirected, LightDirections &to) {
    for (const std::size_t i : kEachLane) {
        const float x = vectors.x[i], y = vectors.y[i], z = vectors.z[i];
        const float formFactor = x * normal.x[i] + y * normal.y[i] + z * normal.z[i];
        const bool back = (formFactor < 0) | (undirected[i] != 0);
        const float scale = back ? 0 : 1 / std::max(formFactor, kLeastCosine);
        to.vector.x[i] = x * scale, to.vector.y[i] = y * scale, to.vector.z[i] = z * scale;
        to.uniform[i] = back ? 1.0f : 0.0f;
        // A cone of half angle a: irradiance vector pi sin^2 a, fluence (solid angle) 2 pi (1 - cos a).
        const float sine2 = std::min(1.0f, std::sqrt(x * x + y * y + z * z));
        to.spread[i] = 2 / (1 + std::sqrt(1 - sine2));
    }
}

/// factor = light on a receiver that faces the point light, divided by the light on the receiver itself.
void TowardLight(const Light &light, const Lanes &angle, const Lanes &distance, Lanes &factor) {
    const Falloff falloff(light);
    for (const std::size_t i : kEachLane)
        factor[i] = falloff.At(distance[i]) / std::max(falloff.At(distance[i], angle[i]), kLeastCosine);
}

} // namespace

void SetLightDirections(const Light &light, bool pointAreas, const SurfaceReceiverBatch &receivers, const Lanes &cosine,
                        const Lanes &angle, SurfaceIncidentLight &incident) {
    Lanes factor;
    if (light.type == LightType::Area && !pointAreas) {
        Lanes heights;
        Lanes3 pushed, vectors;
        AreaHeights(light, receivers.position, heights, pushed);
        FormFactorVectors(pushed, light.w, vectors);
        return FromArea(vectors, receivers.normal, incident.undirected, incident.directions);
    }
    if (light.type == LightType::Area)
        factor.fill(1 / kLeastCosine);
    else if (light.type == LightType::Sun)
        for (const std::size_t i : kEachLane)
            factor[i] = 1 / std::max(angle[i], kLeastCosine);
    else
        TowardLight(light, angle, incident.distance, factor);
    FromPoint(factor, cosine, incident);
}

} // namespace q3
