// GPL-2.0-or-later. The light stage: a compiled map in, a lit one out.
#pragma once

#include "q3map2/light/light.h"
#include "q3map2/lightmap/props/prop_lighting.h"
#include "q3map2/lightmap/store/lightmap_store.h"

namespace q3 {

struct LightResult {
    GridStats grid, gridSH;
    GridStats cubes;                    ///< ambient cubes; points: places sampled, open: leafs with samples
    ContributionCounts surfaces;        ///< work for lightmaps and vertices, all passes
    std::vector<PropVertexLight> props; ///< -staticproplighting
    StoredLightmaps lightmaps;          ///< pages and shaders; images of pages become files beside the map
};

/// Lights `bsp`: lightmaps, vertex colors and both grids, from one set of lights in one scene. With
/// lightmap.onlyGrid, lightmaps and vertex colors stay as they are, bit for bit. Without options.sh an SH grid of
/// an earlier run is removed, since it no longer fits; ambient cubes likewise. Errors: Error, for invalid keys and
/// files.
LightResult LightWorld(Bsp &bsp, const LightInputs &inputs, const LightOptions &options,
                       const LightmapOptions &lightmap, ShaderLibrary &library, const JobPool &jobs, Log &log);

} // namespace q3
