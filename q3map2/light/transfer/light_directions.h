// GPL-2.0-or-later. The directions that the light of one source comes from, at receivers on surfaces.
#pragma once

#include "q3map2/light/batch/incident_light.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/sources/light_sources.h"

namespace q3 {

/// Sets incident.directions of live receivers.
///
/// Point lights and suns: let C be the cosine at the receiver, A the factor for the angle of incidence, and L(A) the
/// light. `vector` points to the light; its length is min(L(1), L(A) / C) / L(A). `uniform` is the rest of the light on
/// the receiver's normal: half-Lambert light, lights without angle attenuation. Area lights: FormFactorVectors, with
/// the fluence of a cone that has the same irradiance vector, exact for disks seen from their axis. Light from behind a
/// two-sided receiver, and from the back of a two-sided area light unless `pointAreas`, is uniform.
///
/// pointAreas: area lights count as points (-faster). cosine, angle: C and A, not used for area lights.
void SetLightDirections(const Light &light, bool pointAreas, const SurfaceReceiverBatch &receivers, const Lanes &cosine,
                        const Lanes &angle, SurfaceIncidentLight &incident);

} // namespace q3
