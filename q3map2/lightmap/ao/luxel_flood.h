// GPL-2.0-or-later. Floodlight: light from the open part of the hemisphere over a receiver.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Floodlight of the world, or of a shader.
struct FloodSource {
    Vec3f light;           ///< under an open hemisphere, byte scale; zero: no floodlight
    float distance = 1024; ///< how far rays look for blockers, game units
};
/// Floodlight of the world; none if neither -floodlight nor the worldspawn key asks for it.
FloodSource WorldFlood(const SurfaceInputs &in);

/// Sets the floodlight of all raw lightmaps that get any, from the world and from the shader of their first surface.
void FloodLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
