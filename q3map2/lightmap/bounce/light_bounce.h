// GPL-2.0-or-later. Bounced light on surfaces.
#pragma once

#include "q3map2/lightmap/bounce/bounce_gather.h"

#include <map>

namespace q3 {

/// Light that goes from surface to surface, gathered by rays.
///
/// A wall of luxel value v whose texture is white sends 187.5 * 3 * -bouncescale / 255 of v on, as the established
/// program does: 0.55 by default.
class Bounces {
  public:
    /// After the direct pass. Keeps references.
    Bounces(const SurfaceInputs &in, const SurfaceLight &surfaces);

    /// Takes up the radiosity of the latest pass. False: nothing sends light on.
    bool CollectRadiosity(const SurfaceLight &surfaces);
    /// Adds what was taken up to the luxels' light of this pass.
    void AddToLuxels(SurfaceLight &surfaces) const;
    /// The same for vertices of surfaces without lightmaps, into sum and radiosity.
    void AddToVertices(SurfaceLight &surfaces) const;
    /// All light of style 0 that was taken up so far, for the grids.
    BouncedLight Total() const { return {scene_, total_}; }

    std::uint64_t Rays() const { return gather_.Rays(); }

  private:
    static std::vector<std::uint8_t> UsedStyles(const SurfaceLight &surfaces);
    std::unique_ptr<const RadiosityPatches> Pieces(const SurfaceLight &surfaces) const;
    void CollectStyle(const SurfaceLight &surfaces, std::uint8_t style, Emission &emission) const;

    const SurfaceInputs &in_;
    EmitterNumbers numbers_;
    BounceScene scene_;
    std::unique_ptr<const RadiosityPatches> pieces_; // under -fast; else null
    BounceGather gather_;
    std::map<std::uint8_t, Emission> byStyle_; // of the latest pass
    Emission total_;
};

} // namespace q3
