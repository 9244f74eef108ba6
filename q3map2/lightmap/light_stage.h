// GPL-2.0-or-later. The light stage: a compiled map in, a lit one out.
#pragma once

#include "q3map2/light/grid_bakes.h"
#include "q3map2/light/light_setup.h"
#include "q3map2/lightmap/bounce/light_bounce.h"
#include "q3map2/lightmap/store/lightmap_store.h"
#include "q3map2/lightmap/vertex/prop_lighting.h"

#include <memory>
#include <optional>

namespace q3 {

/// For measurements; the defaults are for storing.
struct SurfacePassesOptions {
    bool floodlight = true;  ///< false: none, even if the map asks for it
    bool keepLuxels = false; ///< positions, tangents and the like of luxels stay after the last pass
};

/// Direct and bounced light of lightmaps and vertices, from setup to storing. Neither copied nor moved, since its
/// members refer to each other.
class SurfacePasses {
  public:
    /// Places the luxels. Keeps references. Errors: as LightWorld.
    SurfacePasses(const LightSetup &setup, const LightmapOptions &lightmap, const JobPool &jobs, Log &log,
                  const SurfacePassesOptions &options = {});
    SurfacePasses(const SurfacePasses &) = delete;
    SurfacePasses &operator=(const SurfacePasses &) = delete;

    /// Direct light and all bounces. Call once.
    void Run();
    /// -bouncegrid: bounced light for the light grids; else none.
    BouncedLight ForGrids() const;
    /// The light of all bounces; null without -bounce. It refers to this.
    const Bounces *Bounced() const { return bounces_ ? &*bounces_ : nullptr; }
    /// Call last: it moves the results out.
    StoredLightmaps Store(std::string_view mapName, Bsp &bsp);

    const SurfaceInputs &Inputs() const { return in_; }
    const SurfaceLight &Surfaces() const { return surfaces_; }
    const ContributionCounts &Counts() const { return counts_; }

  private:
    SurfaceLight Prepare();
    void FindMasks();
    void Bounce();
    void Pass(const std::vector<Light> &created, const SurfacePass &pass, const Bounces *bounces);

    const LightSetup &setup_;
    const SurfaceInputs in_;
    const SurfacePassesOptions options_;
    SurfaceLight surfaces_;
    std::optional<Bounces> bounces_;
    ContributionCounts counts_;
};

/// What the light stage computes besides the Bsp.
struct LightResult {
    GridStats grid, gridSH;
    GridStats cubes;                    ///< ambient cubes; points: places sampled, open: leafs with samples
    ContributionCounts surfaces;        ///< work for lightmaps and vertices, all passes
    std::vector<PropVertexLight> props; ///< -staticproplighting
    StoredLightmaps lightmaps;          ///< pages and shaders; images of pages become files beside the map
};

/// Whether parts of a run (-part) need a second round, after the results of the first were joined.
bool HasSecondRound(const LightOptions &options, const LightmapOptions &lightmap);

/// Lights `bsp`: lightmaps, vertex colors and both grids, from one set of lights in one scene. With
/// lightmap.onlyGrid, lightmaps and vertex colors stay as they are, bit for bit. Without options.sh an SH grid of
/// an earlier run is removed, since it no longer fits; ambient cubes likewise. With inputs.units, results that are
/// known are not computed; in a part of a run `bsp` stays as it is, and results are in the store alone. Errors: Error,
/// for invalid keys and files.
LightResult LightWorld(Bsp &bsp, const LightInputs &inputs, const LightOptions &options,
                       const LightmapOptions &lightmap, ShaderLibrary &library, const JobPool &jobs, Log &log);

} // namespace q3
