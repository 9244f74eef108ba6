// GPL-2.0-or-later. The passes of the light stage over the surfaces of a map.
#pragma once

#include "q3map2/light/light.h"
#include "q3map2/lightmap/bounce/light_bounce.h"
#include "q3map2/lightmap/store/lightmap_store.h"

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
    /// -bouncegrid: bounced light for the light grids; else null.
    std::unique_ptr<IndirectLight> ForGrids() const;
    /// The light of all bounces; null without -bounce. It refers to this.
    const Bounces *Bounced() const { return bounces_ ? &*bounces_ : nullptr; }
    /// Call last: it moves the results out.
    StoredLightmaps Store(std::string_view mapName, Bsp &bsp);

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

} // namespace q3
