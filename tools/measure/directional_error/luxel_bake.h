// GPL-2.0-or-later. The passes of the light stage over the luxels of a map, kept for measuring.
#pragma once

#include "common/platform/platform.h"
#include "q3map2/lightmap/light_stage.h"

#include <memory>
#include <vector>

namespace q3::directional {

/// A luxel of the lightmaps of a map.
struct LuxelPlace {
    std::size_t lightmap = 0, luxel = 0;
};

/// Direct and bounced light of a map, with the directional channels that `options` ask for, without supersampling and
/// floodlight. Const after construction. Neither copied nor moved, since its members refer to each other.
class LuxelBake {
  public:
    /// Bounces need options.bounceGrid. Keeps references. Errors: as LightWorld.
    LuxelBake(const LightSetup &setup, const LightmapOptions &options, const JobPool &jobs, Log &log);
    LuxelBake(const LuxelBake &) = delete;
    LuxelBake &operator=(const LuxelBake &) = delete;

    /// Light of style 0 on the luxel for each of `normals`, byte scale: direct light as the light stage evaluates it,
    /// with shadow rays for each normal, and bounced light by `rays` rays. Light from below the horizon of the luxel's
    /// own normal does not count, even if it reaches a curved surface.
    std::vector<Vec3f> LightOn(const LuxelPlace &at, std::span<const Vec3f> normals, int rays) const;
    /// Luxels that are lit in style 0, at most `count`, evenly over the map.
    std::vector<LuxelPlace> Sample(std::size_t count) const;

    const SurfaceLight &Surfaces() const { return passes_.Surfaces(); }
    const RawLightmap &Lightmap(const LuxelPlace &at) const { return Surfaces().lightmaps[at.lightmap]; }
    double CpuSeconds() const { return cpuSeconds_; }

  private:
    void AddDirect(const LuxelPlace &at, std::span<const Vec3f> normals, std::span<Vec3f> light) const;
    void AddBounced(const LuxelPlace &at, std::span<const Vec3f> normals, int rays, std::span<Vec3f> light) const;

    const CpuTimer timer_; // started before passes_
    const LightScene &scene_;
    SurfacePasses passes_;
    std::vector<Light> lights_;
    std::unique_ptr<IndirectLight> bounced_;
    double cpuSeconds_ = 0;
};

} // namespace q3::directional
