// GPL-2.0-or-later. Bounced light at luxels, vertices and receivers, gathered by rays.
#pragma once

#include "q3map2/light/grid/indirect_light.h"
#include "q3map2/lightmap/bounce/lightmap_seams.h"
#include "q3map2/lightmap/bounce/radiosity_patches.h"

namespace q3 {

/// Light that each emitter sends on, byte scale: what it got times its reflectance.
using Emission = std::vector<Vec3f>;

/// Which emitters luxels see. Each mapped luxel asks a few directions, spread by the cosine; sixteen neighbours ask
/// different ones. What they find is the same for every bounce, so it is kept when it fits into memory. Const after
/// construction; safe from several threads, each lightmap by one.
class BounceGather {
  public:
    /// pieces: where the light of emitters ends; null: nowhere. Keeps references.
    BounceGather(const SurfaceInputs &in, const SurfaceLight &surfaces, const BounceScene &scene,
                 const RadiosityPatches *pieces);

    /// What rays of the luxels of a lightmap found, by luxel of the super grid; directions of slot 0 are added to raw.
    std::vector<Vec3f> GatheredIrradiance(const Emission &emission, std::size_t lightmap, std::size_t slot,
                                          RawLightmap &raw) const;
    /// Adds what was found, by lightmap, to slot `slot` of a raw lightmap: smoothed over neighbours that see each
    /// other, also in lightmaps that touch. A plane is fitted to what they found, so that gradients stay.
    void AddToLuxels(const std::vector<std::vector<Vec3f>> &found, std::size_t lightmap, std::size_t slot,
                     RawLightmap &raw) const;
    /// Light at a place with a normal: a vertex. twoSided: of a surface that is seen from both sides.
    Vec3f At(const Vec3f &place, const Vec3f &normal, bool twoSided, const Emission &emission) const;

    std::uint64_t Rays() const { return rays_; }

  private:
    /// Luxels of a lightmap that ask the same directions, and where the links of each begin.
    struct GatherBatch;
    std::vector<EmitterId> TransportLinks(const RawLightmap &raw) const;
    void Ask(const RawLightmap &raw, const GatherBatch &askers, std::vector<EmitterId> &links) const;
    float LiftAt(const Vec3f &place, const Vec3f &normal) const;
    int RaysALuxel(const RawLightmap &raw) const;

    const BspSpace &space_;
    const BounceScene &scene_;
    const RadiosityPatches *pieces_;
    LightmapSeams joints_;
    std::vector<Vec3f> directions_; // of a cosine-weighted hemisphere around +z
    bool keep_ = false;
    std::vector<std::vector<EmitterId>> links_; // by lightmap, then mapped luxel, then ray; empty: asked anew
    std::uint64_t rays_ = 0;
};

/// Bounced light for the grids.
class BouncedLight : public IndirectLight {
  public:
    BouncedLight(const BounceScene &scene, Emission emission) : scene_(scene), emission_(std::move(emission)) {}
    void Gather(const Vec3f &place, std::uint64_t seed, std::vector<IndirectRay> &rays) const override;

  private:
    const BounceScene &scene_;
    Emission emission_;
};

} // namespace q3
