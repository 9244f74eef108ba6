// GPL-2.0-or-later. The passes of the light stage over the luxels of a map, kept for measuring.
#pragma once

#include "q3map2/light/light.h"
#include "q3map2/lightmap/bounce/light_bounce.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <memory>
#include <vector>

namespace q3::directional {

/// A luxel of the lightmaps of a map.
struct LuxelPlace {
    std::size_t lightmap = 0, luxel = 0;
};

/// Direct and bounced light of a map with what `options` keep of its directions, without supersampling. Const after
/// construction, so are the parts, which refer to each other: neither copied nor moved.
class LuxelBake {
  public:
    /// Keeps references. Errors: as LightWorld.
    LuxelBake(const LightSetup &setup, const LightmapOptions &options, const JobPool &jobs, Log &log);
    LuxelBake(const LuxelBake &) = delete;
    LuxelBake &operator=(const LuxelBake &) = delete;

    /// Light on the luxel if it had the normals `normals`, in one style, byte scale: each light as the light stage
    /// evaluates it, with its own shadow rays, and bounced light by `rays` rays; none from below the luxel's surface,
    /// which does not shadow itself if it is a curve.
    std::vector<Vec3f> LightOn(const LuxelPlace &at, std::span<const Vec3f> normals, int rays) const;
    /// Those that are lit in style 0, at most `count`, evenly over the map.
    std::vector<LuxelPlace> Sample(std::size_t count) const;

    const SurfaceLight &Surfaces() const { return surfaces_; }
    const RawLightmap &Lightmap(const LuxelPlace &at) const { return surfaces_.lightmaps[at.lightmap]; }
    double CpuSeconds() const { return cpuSeconds_; }

  private:
    void AddDirect(const LuxelPlace &at, std::span<const Vec3f> normals, std::span<Vec3f> light) const;
    void AddBounced(const LuxelPlace &at, std::span<const Vec3f> normals, int rays, std::span<Vec3f> light) const;

    const SurfaceTable table_; // all surfaces are normal mapped, or none
    const SurfaceInputs in_;
    std::vector<Light> lights_;
    SurfaceLight surfaces_;
    std::unique_ptr<Bounces> bounces_;
    std::unique_ptr<BouncedLight> bounced_;
    double cpuSeconds_ = 0;
};

} // namespace q3::directional
