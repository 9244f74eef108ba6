// GPL-2.0-or-later. A map ready to be lit: its surfaces, lights, scene and grids, set up from a .bsp and files beside
// it.
#pragma once

#include "common/jobs.h"
#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/light/grid/light_grid.h"
#include "q3map2/light/grid/light_gridsh.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/props/static_props.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sources/light_styles.h"
#include "q3map2/light/sources/light_surfaces.h"
#include "q3map2/shader/shader_library.h"

#include <optional>
#include <string>
#include <vector>

namespace q3 {

/// Files beside the .bsp.
struct LightInputs {
    std::string name;                               ///< of the map, for messages
    std::optional<std::vector<Entity>> mapEntities; ///< of the .map source, which still has the light entities
    std::string surfaceFile;                        ///< text of the .srf, empty without one
    const VirtualFileSystem *vfs = nullptr;         ///< for models of static props; null: none are found
    TexLights texLights{};                          ///< of .rad files
    UnitStore *units = nullptr;                     ///< results that need not be computed; null: none
    bool seeksLamps = false;                        ///< no light entities are expected: no warning
};

/// A map ready to be lit: everything that grids and surfaces share. Const while workers run. Keeps references to
/// the Bsp and to the library's shaders.
struct LightSetup {
    /// Errors: Error, for invalid keys and files. Changes worldspawn's gridsize, in `bspEntities`, if it allows too
    /// many points.
    LightSetup(const Bsp &bsp, const LightInputs &inputs, const LightOptions &options, const SurfaceDefaults &defaults,
               ShaderLibrary &library, Log &log);

    // Each member is made of those above it.
    const Bsp &bsp;
    std::vector<Entity> bspEntities; ///< of the .bsp, the world first
    GridLayout layout;               ///< of the legacy grid
    WorldLight world;
    LightOptions options; ///< with worldspawn's _maxlight
    SurfaceTable table;
    LightStyles styles; ///< of patterns and switches
    BspSpace space;
    std::vector<Light> lights; ///< in the order of tracing
    StaticProps props;         ///< without `shadows`, which the scene has
    LightScene scene;
    std::vector<bool> skySeenFrom; ///< by cluster, see the function of that name
    UnitStore *units;              ///< as in LightInputs
};

/// All lights of a map in the order of tracing, before SetupEnvelopes; fills the sky numbers of `table`.
std::vector<Light> CreateLights(const BspSpace &space, const std::vector<Entity> &entities, SurfaceTable &table,
                                const LightOptions &options, const WorldLight &world, ShaderLibrary &library, Log &log);

/// For each brush whether it blocks light as a volume: a brush of the world none of whose sides is translucent.
std::vector<bool> OpaqueBrushes(const Bsp &bsp, ShaderLibrary &library);

} // namespace q3
