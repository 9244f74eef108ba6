// GPL-2.0-or-later. Final gathering of bounced light at luxels, vertices and light grid points.
#pragma once

#include "q3map2/light/grid/indirect_light.h"
#include "q3map2/lightmap/bounce/lightmap_seams.h"
#include "q3map2/lightmap/bounce/radiosity_patches.h"

namespace q3 {

/// Radiosity of each emitter, byte scale: light it received times its reflectance.
using Emission = std::vector<Vec3f>;

/// Estimates for the luxels of a lightmap, by luxel of the super grid; zero for unmapped ones.
struct BounceEstimate {
    std::vector<Vec3f> irradiance;
    ChannelImages channels;

    bool Empty() const { return irradiance.empty(); }
};

/// Monte Carlo estimate of irradiance over cosine-weighted directions: E = 1/N sum of the radiosity that ray i hits, on
/// a scale where E equals the radiosity of surroundings of uniform radiosity. Each mapped luxel traces N = 24 rays
/// (under -super S, max(4, 24 / S^2)); the 16 luxels of a 4 x 4 block trace different directions. Rays hit the same
/// emitters in every bounce, so hits are kept if memory allows. Const after construction; safe from several threads,
/// each lightmap by one.
class BounceGather {
  public:
    /// patches: null unless faint emitters are left out (-fast). Keeps references.
    BounceGather(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                 const RadiosityPatches *patches);

    /// The estimate for the luxels of a lightmap. Slot 0 also adds to raw.directions.
    BounceEstimate Gather(const Emission &emission, std::size_t lightmap, std::size_t slot, RawLightmap &raw) const;
    /// Adds estimates to style slot `slot` of a raw lightmap, denoised: the value at the luxel of a plane fitted by
    /// least squares to the window around it, which keeps gradients. At the rim the window includes luxels of other
    /// lightmaps, except for basis channels. gathered: by lightmap.
    void AddToLuxels(const std::vector<BounceEstimate> &gathered, std::size_t lightmap, std::size_t slot,
                     RawLightmap &raw) const;
    /// Estimate at a vertex, by 256 rays. twoSided: its surface is seen from both sides.
    Vec3f IrradianceAt(const Vec3f &position, const Vec3f &normal, bool twoSided, const Emission &emission) const;

    /// Number of rays of all luxels together.
    std::uint64_t Rays() const { return rays_; }

  private:
    /// Up to 16 luxels that trace the same directions, and the index of each luxel's first hit.
    struct GatherBatch;
    class ChannelSum;
    std::vector<EmitterId> TraceEmitterHits(const RawLightmap &raw) const;
    void TraceBatch(const RawLightmap &raw, const GatherBatch &batch, std::vector<EmitterId> &hits) const;
    float RayLiftAt(const Vec3f &position, const Vec3f &normal) const;
    int RaysPerLuxel(const RawLightmap &raw) const;
    std::vector<float> FluenceScales(int count) const;

    const BspSpace &space_;
    const BounceScene &scene_;
    const RadiosityPatches *patches_;
    LightmapSeams seams_;

    std::vector<Vec3f> directions_; // cosine-weighted over the hemisphere around +z
    bool keepHits_ = false;
    std::vector<std::vector<EmitterId>> emitterHits_; // by lightmap, mapped luxel and ray; empty unless keepHits_
    std::uint64_t rays_ = 0;
};

/// Bounced light at points of the light grids.
class BouncedLight : public IndirectLight {
  public:
    BouncedLight(const BounceScene &scene, Emission emission) : scene_(scene), emission_(std::move(emission)) {}
    void Gather(const Vec3f &position, std::uint64_t seed, std::vector<IndirectRay> &rays) const override;

  private:
    const BounceScene &scene_;
    Emission emission_;
};

} // namespace q3
