// GPL-2.0-or-later. -filter and filter radii: blurs light over luxels, across the borders of raw lightmaps.
#pragma once

#include "q3map2/lightmap/direct/luxel_surroundings.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <vector>

namespace q3 {

/// Box filter over the cells around a luxel.
class LuxelFilter {
  public:
    /// Sets `blurred`, by cell, to the mean of `values`, interpolated linearly between cells, over a box that reaches
    /// `radius` (at least 1) to all sides; so the outermost cells count half if `radius` is whole. The variance of such
    /// a box is radius^2 / 3 + 1 / 6 on each axis. Empty cells do not count. Where a cell is blocked, the one opposite
    /// of it does not count either, so that linear gradients stay.
    void Apply(const LuxelSurroundings &around, float radius, const std::vector<Vec3f> &values,
               std::vector<Vec3f> &blurred);

  private:
    std::vector<float> rowWeight_;
    std::vector<Vec3f> rows_;
};

/// Light of the sources of one style and one filter radius on the luxels of a raw lightmap, before it is blurred.
struct UnblurredLight {
    int style = 0;
    float filterRadius = 0; ///< Light::filterRadius, game units
    std::vector<Vec3f> color, direction;
    ChannelImages channels;
};
/// By raw lightmap.
using UnblurredLights = std::vector<std::vector<UnblurredLight>>;

/// Whether light is blurred on some surface even if its source has no filter radius.
bool BlursAllLight(const SurfaceInputs &in, const SurfaceLight &surfaces);

/// Sets mapped luxels of a style slot to `value` and their directional channels to light like that from everywhere.
void ClearStyleSlot(RawLightmap &raw, std::size_t slot, const Vec3f &value);

/// Blurs the light and adds it to the raw lightmaps. At its border the box of a luxel reaches over surfaces of other
/// lightmaps that continue its own (LuxelSurroundings). Towards a neighbor with a wider blur the own one widens, so
/// that both sides of the border are equally bright.
void AddBlurredLight(const SurfaceInputs &in, const UnblurredLights &light, SurfaceLight &surfaces);

} // namespace q3
