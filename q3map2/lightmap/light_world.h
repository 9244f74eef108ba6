// GPL-2.0-or-later. The light stage: a compiled map in, a lit one out.
#pragma once

#include "q3map2/light/light.h"
#include "q3map2/lightmap/store/lightmap_store.h"

namespace q3 {

struct LightResult {
    GridStats grid, gridSH;
    ContributionCounts surfaces; ///< work for lightmaps and vertices, all passes
    StoredLightmaps lightmaps;   ///< what goes beside the map
};

/// Lights `bsp`: lightmaps, vertex colours and both grids, from one set of lights in one scene. With
/// lightmap.onlyGrid, lightmaps and vertex colours stay as they are, bit for bit. Without options.sh an older SH grid
/// is dropped, since it no longer fits. Errors: Error, for keys and files that make no sense.
LightResult LightWorld(Bsp &bsp, const LightInputs &inputs, const LightOptions &options,
                       const LightmapOptions &lightmap, ShaderLibrary &library, const JobPool &jobs, Log &log);

} // namespace q3
