// GPL-2.0-or-later. The directions that the light of one source comes from, at receivers on surfaces.
#pragma once

#include "q3map2/light/batch/incident_light.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/sources/light_sources.h"

namespace q3 {

/// Sets incident.directions of live receivers.
///
/// Point lights and suns: with C the cosine at the receiver, A its factor for the angle of incidence and L(A) the light,
/// the irradiance vector has the length min(L(1), L(A) / C) over L(A) towards the light; what is missing to L(A) for the
/// receiver's normal (half-Lambert light, lights without attenuation by angle) is uniform. Area lights: Lambert's vector
/// of the polygon; its fluence is taken from a cone with that irradiance vector, which is exact for disks seen from
/// their axis. Light from behind a two-sided receiver, and from the back of a two-sided light, is uniform.
///
/// pointAreas: area lights count as points (-faster). cosine, angle: C and A, not used for area lights.
void SetLightDirections(const Light &light, bool pointAreas, const SurfaceReceiverBatch &receivers, const Lanes &cosine,
                        const Lanes &angle, SurfaceIncidentLight &incident);

} // namespace q3
