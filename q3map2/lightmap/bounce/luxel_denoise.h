// GPL-2.0-or-later. Denoises estimates of bounced light over neighboring luxels.
#pragma once

#include "q3map2/lightmap/bounce/lightmap_seams.h"

namespace q3 {

/// Estimates for the luxels of a lightmap, by luxel of the super grid; zero for unmapped ones.
struct BounceEstimate {
    std::vector<Vec3f> irradiance;
    ChannelImages channels;
    std::vector<Vec3f> directions; ///< for deluxe pages, see RawLightmap::directions; else empty

    bool Empty() const { return irradiance.empty(); }
};

/// The denoised estimate at a luxel is the value there of a plane fitted by least squares to the window of 5 x 5 luxels
/// around it, which keeps gradients. At the rim the window includes luxels of other lightmaps, except for basis
/// channels. Const after construction; safe from several threads.
class LuxelDenoiser {
  public:
    LuxelDenoiser(const SurfaceInputs &in, const SurfaceLight &surfaces);

    /// Adds denoised estimates to style slot `slot` of raw lightmap `lightmap`. all: by lightmap.
    void AddTo(const std::vector<BounceEstimate> &all, std::size_t lightmap, std::size_t slot, RawLightmap &raw) const;

  private:
    LightmapSeams seams_;
};

} // namespace q3
