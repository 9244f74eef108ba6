// GPL-2.0-or-later. Radiosity: bounced light on surfaces.
#pragma once

#include "q3map2/lightmap/bounce/bounce_gather.h"

#include <map>

namespace q3 {

/// Radiosity by gathering: in bounce k, B_k = rho E_k and E_(k+1) is the irradiance due to B_k. rho of a white texture
/// is 187.5 * 3 / 255 * 0.25 = 0.55 at -bouncescale 1, the default, as in the established program.
class Bounces {
  public:
    /// After the direct pass. Keeps references.
    Bounces(const SurfaceInputs &in, const SurfaceLight &surfaces);

    /// Computes the emission from the light of the latest pass. False: it is zero everywhere.
    bool CollectRadiosity(const SurfaceLight &surfaces);
    /// Gathers the emission at all luxels, into the light of this pass.
    void AddToLuxels(SurfaceLight &surfaces) const;
    /// The same for vertices of surfaces without lightmaps, into sum and radiosity.
    void AddToVertices(SurfaceLight &surfaces) const;
    /// Emission of style 0 summed over all bounces so far, for the light grids.
    BouncedLight Total() const { return {scene_, total_}; }

    /// Gather rays of all luxels.
    std::uint64_t Rays() const { return gather_.Rays(); }

  private:
    static std::vector<std::uint8_t> UsedStyles(const SurfaceLight &surfaces);
    std::unique_ptr<const RadiosityPatches> MakePatches(const SurfaceLight &surfaces) const;
    void CollectStyle(const SurfaceLight &surfaces, std::uint8_t style, Emission &emission) const;

    const SurfaceInputs &in_;
    EmitterIndex emitters_;
    BounceScene scene_;
    std::unique_ptr<const RadiosityPatches> patches_; // under -fast; else null
    BounceGather gather_;
    std::map<std::uint8_t, Emission> byStyle_; // of the latest pass
    Emission total_;
};

} // namespace q3
