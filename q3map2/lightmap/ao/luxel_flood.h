// GPL-2.0-or-later. Floodlight: light from wherever the hemisphere over a receiver is open.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Floodlight of the world, or of a shader.
struct FloodSource {
    Vec3f light;           ///< where the whole hemisphere is open, byte scale; zero: there is none
    float distance = 1024; ///< how far rays look for blockers, game units
};
/// That of the world.
FloodSource WorldFlood(const SurfaceInputs &in);

/// Sets the floodlight of all raw lightmaps that get any, from the world and from the shader of their first surface.
void FloodLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
