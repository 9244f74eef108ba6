// GPL-2.0-or-later. Soft shadows on a raw lightmap: which luxels see a light as their neighbors do.
#pragma once

#include "q3map2/light/transfer/soft_light.h"
#include "q3map2/lightmap/direct/luxel_contribution.h"

#include <functional>
#include <span>
#include <vector>

namespace q3 {

/// Lights the blocks of a raw lightmap by lights with soft shadows. Reused from lightmap to lightmap.
class SoftLuxels {
  public:
    /// To be called before the first light of a lightmap. Keeps references until the next Start.
    void Start(const RawLightmap &lightmap, LuxelBlocks &blocks);
    /// Calls use(block, light) for the blocks of `reached` that get light. Luxels cast more than the first rays where a
    /// luxel of their block, or one of the eight around them, sees less or more of the light than they do.
    using Use = std::function<void(std::uint32_t block, const SurfaceIncidentLight &light)>;
    void Add(const SoftLight &light, std::span<const std::uint32_t> reached, const Use &use);

  private:
    static constexpr std::uint8_t kSees = 1, kHidden = 2;
    LaneMask Doubtful(std::uint32_t block, const SoftBatch &batch) const;

    const RawLightmap *lightmap_ = nullptr;
    LuxelBlocks *blocks_ = nullptr;
    std::vector<std::vector<std::uint32_t>> adjacent_; ///< by block: blocks with luxels next to its own
    /// What the luxels see of the light at hand, kSees and kHidden: of each block, and of each luxel of the super grid.
    std::vector<std::uint8_t> viewOfBlock_, viewOfLuxel_;
    std::vector<SoftBatch> batches_;
    std::vector<std::pair<std::uint32_t, SoftBatch *>> lit_; ///< blocks that the light at hand may light
};

} // namespace q3
