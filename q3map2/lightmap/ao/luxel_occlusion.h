// GPL-2.0-or-later. Occlusion of luxels: -dirty, floodlight, and the outputs of -lightmass.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Sets the dirt of all raw lightmaps: the factor, 0 to 1, that their light is multiplied by. Does nothing without
/// -dirty.
void DirtLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);

/// Floodlight of the world, or of a shader.
struct FloodSource {
    Vec3f light;           ///< under an open hemisphere, byte scale; zero: no floodlight
    float distance = 1024; ///< how far rays look for blockers, game units
};
/// Floodlight of the world; none if neither -floodlight nor the worldspawn key asks for it.
FloodSource WorldFlood(const SurfaceInputs &in);

/// Sets the floodlight of all raw lightmaps that get any, from the world and from the shader of their first surface.
void FloodLuxels(const SurfaceInputs &in, SurfaceLight &surfaces);

/// Sets RawLightmap::unoccluded from dirt, if there is any, and under -skyocclusion RawLightmap::skyOcclusion by rays
/// over the hemisphere. Call before the last AverageLuxels, after DirtLuxels.
void FindOcclusion(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
