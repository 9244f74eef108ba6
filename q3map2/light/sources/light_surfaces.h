// GPL-2.0-or-later. Lights that shaders make of surfaces.
#pragma once

#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/shader/shader.h"

#include <vector>

namespace q3 {

/// Whether a curve is there for collision only, beside the triangles that -patchmeta made from it: its shader record
/// has one of the flags `noDraw` of the game, and the shader itself has not. Engines draw no such curve; it emits no
/// light and has no lightmap.
bool IsCollisionOnly(const Bsp &bsp, const SurfaceTable &table, std::size_t surface, std::uint32_t noDraw);

/// How many lights of each kind SurfaceLights made.
struct SurfaceLightCounts {
    int areaLights = 0, skyLights = 0;
};
/// Makes the lights of shaders, in draw surface order: suns, sky lights, area lights. Gives each sky that emits light
/// its number in `table`. Area lights are cut where solids cover them; warns of those that are covered as a whole.
std::vector<Light> SurfaceLights(const BspSpace &space, SurfaceTable &table, const LightOptions &options,
                                 const WorldLight &world, ShaderLibrary &library, SurfaceLightCounts &counts, Log &log);

} // namespace q3
