// GPL-2.0-or-later. Noise filter for gathered light.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <span>
#include <vector>

namespace q3 {

/// Light by luxel of the super grid, byte scale; zero where a luxel is not mapped.
struct BounceEstimate {
    std::vector<Vec3f> irradiance;
    ChannelImages channels;
    std::vector<Vec3f> directions; ///< for deluxe pages, see RawLightmap::directions; else empty

    /// All zero.
    BounceEstimate(const RawLightmap &raw, bool deluxe)
        : irradiance(raw.luxelClusters.size()),
          channels(raw.channels.Count(), std::vector<Vec3f>(raw.luxelClusters.size())),
          directions(deluxe ? raw.luxelClusters.size() : 0) {}
};

/// Moves each luxel toward the weighted mean over its neighbors, as far as their difference is noise. The window gives
/// every set of GatherDirections equal weight, since sets repeat every 4 luxels. Neighbors that are not mapped, on
/// another plane, not facing the same way, or without such a neighbor on the opposite side are left out, so that linear
/// gradients stay. The fraction t of the way to the mean that minimizes the squared error (Stein's estimate) is
///
///     t = min(1, (1 - k) sum s^2 / sum D^2)
///
/// with D the mean minus the luxel, k the weight of the luxel in its mean, s^2 the variance of the luxel, and sums over
/// the neighborhood: 1 where light is even, near 0 where it varies more than its noise, such as in a corner. Two luxels
/// exchange light by the smaller of their fractions, which keeps the sum of light except at edges.
class NoiseFilter {
  public:
    /// By luxel: luminance of the irradiance, and a sample of its error, whose square estimates the variance. Keeps a
    /// reference.
    NoiseFilter(const RawLightmap &raw, std::span<const float> luminance, std::span<const float> deviation);

    /// Filters all values of the estimate with weights that do not depend on them, so results of styles add up.
    void Apply(BounceEstimate &estimate) const;

  private:
    void FindNeighbors();
    bool AreNeighbors(std::size_t a, std::size_t b) const;
    template <typename Use> void ForWindow(std::size_t luxel, const Use &use) const;
    template <typename T> T Mean(std::size_t luxel, std::span<const T> values) const;

    const RawLightmap &raw_;
    std::vector<std::uint32_t> neighbors_; // by luxel: bit set of places in the window that hold a neighbor
    std::vector<float> weights_;           // by luxel: sum of the weights of its neighbors
    std::vector<float> fractions_;         // by luxel: fraction t of the mean
};

} // namespace q3
