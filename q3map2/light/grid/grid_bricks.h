// GPL-2.0-or-later. Light grids in bricks: neighbouring points share their lights and their rays.
#pragma once

#include "q3map2/light/grid/light_grid.h"

#include <bit>
#include <functional>
#include <span>
#include <vector>

namespace q3 {

struct BrickPoint {
    Vec3f position;
    std::uint32_t index = 0; ///< of the grid point
};

/// Cuts a grid into bricks of 8 x 8 x 4 points.
class GridBricks {
  public:
    explicit GridBricks(const GridLayout &layout);
    std::int64_t Count() const { return count_; }
    /// Points of a brick, in blocks of 4 x 2 x 2, so that consecutive points are neighbours.
    std::vector<BrickPoint> Points(std::int64_t brick) const;

  private:
    const GridLayout &layout_;
    std::array<int, 3> bricks_{};
    std::int64_t count_ = 0;
};

/// The region around some points and what is within `margin` of them on each axis. Game units.
BspRegion RegionAround(const BspRegion &in, std::span<const BrickPoint> points, const Vec3f &margin);

/// Appends a place to the last block, or to a new one when that is full.
void AddReceiver(std::vector<ReceiverBatch> &blocks, const Vec3f &position, const Vec3f &rayOrigin, int cluster,
                 std::uint32_t index);

/// Where the receivers of a brick are.
struct BrickView {
    explicit BrickView(std::span<const ReceiverBatch> blocks);
    Boundsf box;
    std::vector<int> clusters; ///< each once
};

/// Which lights each cluster may see, as rows of bits.
class LightsByCluster {
  public:
    explicit LightsByCluster(const std::vector<Light> &lights);
    /// Calls use(number of the light, whether all of the clusters may see it) in order for every light that one of them
    /// may see, and returns how many it left out.
    template <typename Use> std::size_t ForEach(std::span<const int> clusters, const Use &use) const {
        std::vector<std::uint64_t> any = everywhere_, all(any.size(), ~std::uint64_t(0));
        for (const int cluster : clusters) {
            const bool known = cluster >= 0 && std::size_t(cluster) < rows_.size();
            for (std::size_t word = 0; word < any.size(); ++word) {
                const std::uint64_t row = known ? rows_[std::size_t(cluster)][word] : 0;
                any[word] |= row;
                all[word] &= row | everywhere_[word];
            }
        }
        std::size_t used = 0;
        for (std::size_t word = 0; word < any.size(); ++word)
            for (std::uint64_t bits = any[word]; bits != 0; bits &= bits - 1, ++used) {
                const int bit = std::countr_zero(bits);
                use(word * 64 + std::size_t(bit), (all[word] >> bit & 1) != 0);
            }
        return lights_.size() - used;
    }
    const std::vector<Light> &Lights() const { return lights_; }
    /// Where a light matters: what of it decides that, close together.
    struct Reach {
        Boundsf bounds;
        Vec3f origin, normal;
        float envelope = 0, dist = 0;
        bool sun = false, oneSided = false;
    };
    const Reach &ReachOf(std::size_t light) const { return reach_[light]; }

  private:
    const std::vector<Light> &lights_;
    std::vector<std::uint64_t> everywhere_;
    std::vector<std::vector<std::uint64_t>> rows_;
    std::vector<Reach> reach_;
};

/// A light of a brick, and what its contribution is multiplied by.
struct BrickLight {
    const Light *light = nullptr;
    float weight = 1;
    float bound = 0;        ///< see LightBound
    bool seenByAll = false; ///< by visibility data, from every place of the brick
};

/// Lights that can reach some point of a brick, in their order.
///
/// Lights whose bound in the brick is under `faint` (byte scale), if there are many, are represented by a few: going
/// through them in order, every time their bounds add up to `faint` one is taken, with the weight that makes up for the
/// others. Lights of one surface follow each other in the list, so that a taken light stands for its neighbours. 0
/// takes every light.
class BrickLights {
  public:
    BrickLights(const LightsByCluster &lights, const BrickView &brick, std::uint64_t seed, float faint,
                const SkipOptions &skip, GridStats &work);
    const std::vector<BrickLight> &List() const { return list_; }
    /// Whether there were many faint lights.
    bool Many() const { return many_; }

  private:
    std::vector<BrickLight> list_;
    bool many_ = false;
};

/// Sets where each block's count of faint light starts: spread evenly.
void StartFaintResiduals(std::vector<ReceiverBatch> &blocks, float faint);

/// Runs `trace(brick, work)` for every brick on all workers, with progress; adds the work up into `stats`.
void RunGridBricks(const GridInputs &in, const GridBricks &bricks, GridStats &stats,
                   const std::function<void(std::int64_t, GridStats &)> &trace);

} // namespace q3
