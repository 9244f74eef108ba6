// GPL-2.0-or-later. Soft shadows on a raw lightmap: which luxels see a light as their neighbors do.
#include "q3map2/lightmap/direct/luxel_soft.h"

#include <algorithm>

namespace q3 {

void SoftLuxels::Start(const RawLightmap &lightmap, LuxelBlocks &blocks) {
    lightmap_ = &lightmap, blocks_ = &blocks;
    viewOfBlock_.assign(blocks.Count(), 0);
    viewOfLuxel_.assign(lightmap.luxelClusters.size(), 0);
    adjacent_.assign(blocks.Count(), {});
    for (std::uint32_t block = 0; block < blocks.Count(); ++block) {
        std::vector<std::uint32_t> &adjacent = adjacent_[block];
        for (std::size_t i = 0; i < blocks.Receivers(block).count; ++i)
            ForLuxelsAround(lightmap, blocks.Luxels(block)[i], 1, [&](std::size_t luxel) {
                const std::int32_t lane = blocks.LaneIndexOf(luxel);
                if (lane >= 0 && std::uint32_t(lane) / kPacketSize != block)
                    adjacent.push_back(std::uint32_t(lane) / kPacketSize);
            });
        std::ranges::sort(adjacent);
        adjacent.erase(std::unique(adjacent.begin(), adjacent.end()), adjacent.end());
    }
}

/// The receivers of a block whose first rays may not tell what they see of the light.
LaneMask SoftLuxels::Doubtful(std::uint32_t block, const SoftBatch &batch) const {
    const LaneMask within = batch.Disagreeing();
    if (within.Any())
        return within;
    const std::uint8_t other = viewOfBlock_[block] ^ (kSees | kHidden); // what no receiver of the block has
    LaneMask doubtful{};
    if (std::ranges::none_of(adjacent_[block], [&](std::uint32_t next) { return (viewOfBlock_[next] & other) != 0; }))
        return doubtful;
    for (std::size_t i = 0; i < batch.receivers->count; ++i)
        if (batch.incident.live[i] != 0)
            ForLuxelsAround(*lightmap_, blocks_->Luxels(block)[i], 1, [&](std::size_t luxel) {
                if ((viewOfLuxel_[luxel] & other) != 0)
                    doubtful[i] = -1;
            });
    return doubtful;
}

void SoftLuxels::Add(const SoftLight &light, std::span<const std::uint32_t> reached, const Use &use) {
    if (batches_.size() < reached.size())
        batches_.resize(reached.size());
    lit_.clear();
    for (const std::uint32_t block : reached) {
        SoftBatch &batch = batches_[lit_.size()];
        if (!light.Start(blocks_->Receivers(block), SoftReceivers::Luxels, batch))
            continue;
        lit_.push_back({block, &batch});
        const LaneMask seeing = batch.Seeing(), hidden = batch.Hidden();
        for (std::size_t i = 0; i < batch.receivers->count; ++i) {
            const auto view = std::uint8_t((seeing[i] != 0 ? kSees : 0) | (hidden[i] != 0 ? kHidden : 0));
            viewOfLuxel_[blocks_->Luxels(block)[i]] = view;
            viewOfBlock_[block] |= view;
        }
    }
    for (const auto &[block, batch] : lit_) {
        light.Finish(*batch, Doubtful(block, *batch));
        if (batch->incident.live.Any() || batch->incident.filtered.Any())
            use(block, batch->incident);
    }
    for (const auto &[block, batch] : lit_) {
        viewOfBlock_[block] = 0;
        for (std::size_t i = 0; i < batch->receivers->count; ++i)
            viewOfLuxel_[blocks_->Luxels(block)[i]] = 0;
    }
}

} // namespace q3
