// GPL-2.0-or-later. The light stage: a compiled map in, a lit one out.
#pragma once

#include "common/jobs.h"
#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/light/light_grid.h"
#include "q3map2/light/light_options.h"
#include "q3map2/shader/shader.h"

#include <optional>
#include <string>
#include <vector>

namespace q3 {

/// What lies beside the .bsp.
struct LightInputs {
    std::string name;                               ///< of the map, for messages
    std::optional<std::vector<Entity>> mapEntities; ///< of the .map source, which still has the light entities
    std::string surfaceFile;                        ///< text of the .srf, empty without one
};

struct LightResult {
    GridStats grid, gridSH;
};

/// Lights the grids of `bsp` and replaces them in it. Lightmaps and vertex colours stay as they are. Without options.sh
/// an older SH grid is dropped, since it no longer fits. Errors: Error, for keys and files that make no sense.
LightResult LightWorld(Bsp &bsp, const LightInputs &inputs, const LightOptions &options, ShaderLibrary &library,
                       const JobPool &jobs, Log &log);

/// All lights of a map in the order in which they count, before SetupEnvelopes; fills the sky numbers of `table`.
std::vector<Light> CreateLights(const Bsp &bsp, const std::vector<Entity> &entities, SurfaceTable &table,
                                const LightOptions &options, const WorldLight &world, ShaderLibrary &library, Log &log);

/// For each brush whether it blocks light as a volume: a brush of the world none of whose sides is translucent.
std::vector<bool> OpaqueBrushes(const Bsp &bsp, ShaderLibrary &library);

/// Worldspawn key that tells how the SH grid is to be read; value "radiance" after -shradiance, absent otherwise.
inline constexpr std::string_view kGridSHKey = "_q3map2_sh";

} // namespace q3
