// GPL-2.0-or-later. Which share of each named light arrives at receivers.
#pragma once

#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/named/light_table.h"

#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// Visible share of a light of the table at a receiver.
struct LightShare {
    std::uint32_t light = 0;
    float share = 0; ///< 0 to 1
};

/// Sums what is seen of the lights of the table at receivers. A light of several polygons counts by what each gives.
class ShareSums {
  public:
    ShareSums(const LightTable &table, std::size_t receivers) : table_(table), sums_(receivers) {}
    /// Adds a light at a receiver.
    void Add(const WeightedLight &light, std::size_t receiver, float unshadowed, float visible);
    /// The shares at a receiver; lights that do not reach it, or are too weak there to be traced, are left out.
    std::vector<LightShare> Of(std::size_t receiver) const;

  private:
    struct Sum {
        std::uint32_t light;
        float unshadowed, arrived;
    };
    const LightTable &table_;
    std::vector<std::vector<Sum>> sums_; ///< by receiver
};

/// Observes receivers by their number among those of all blocks.
class BrickShares : public LightObserver {
  public:
    BrickShares(const LightTable &table, std::size_t receivers) : sums_(table, receivers) {}
    void See(const WeightedLight &light, std::span<const ReceiverBatch> blocks,
             std::span<const ProbeIncidentLight> incident) override;
    const ShareSums &Sums() const { return sums_; }

  private:
    ShareSums sums_;
};

/// Observes the points of a grid by their index. From any thread: a point is in one brick.
class GridShares : public LightObserver {
  public:
    GridShares(const LightTable &table, std::size_t points) : sums_(table, points) {}
    void See(const WeightedLight &light, std::span<const ReceiverBatch> blocks,
             std::span<const ProbeIncidentLight> incident) override;
    const ShareSums &Sums() const { return sums_; }

  private:
    ShareSums sums_;
};

} // namespace q3
