// GPL-2.0-or-later. Divides light grids into bricks: neighboring points share a list of lights and packets of rays.
#pragma once

#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/grid/grid_pass.h"
#include "q3map2/light/sources/lights_by_cluster.h"

#include <functional>
#include <span>
#include <vector>

namespace q3 {

struct BrickPoint {
    Vec3f position;
    std::uint32_t index = 0; ///< of the grid point
};

/// Divides a grid into bricks of 8 x 8 x 4 points, or of another multiple of a block, 4 x 2 x 2 points.
class GridBricks {
  public:
    explicit GridBricks(const GridLayout &layout, const Int3 &brick = {8, 8, 4});
    std::int64_t Count() const { return count_; }
    /// Points of a brick, in blocks of 4 x 2 x 2, so that consecutive points are neighbors.
    std::vector<BrickPoint> Points(std::int64_t brick) const;

  private:
    const GridLayout &layout_;
    Int3 brick_, bricks_{};
    std::int64_t count_ = 0;
};

/// Bounds and clusters of the receivers of a brick.
struct BrickView {
    explicit BrickView(std::span<const ReceiverBatch> blocks);
    Boundsf box;
    std::vector<int> clusters; ///< each once
};

/// The lights of a pass. The data that decide whether a light can reach a brick (Reach) are contiguous, for the CPU
/// cache.
class BrickCandidates {
  public:
    explicit BrickCandidates(const std::vector<Light> &lights);
    const LightsByCluster &ByCluster() const { return byCluster_; }
    const std::vector<Light> &Lights() const { return byCluster_.Lights(); }
    struct Reach {
        Boundsf bounds;
        Vec3f origin, normal;
        float envelope = 0, dist = 0;
        bool sun = false, oneSided = false;
    };
    const Reach &ReachOf(std::size_t light) const { return reach_[light]; }

  private:
    LightsByCluster byCluster_;
    std::vector<Reach> reach_;
};

/// A light that may reach a brick, and the factor by which its light is multiplied.
struct BrickLight {
    const Light *light = nullptr;
    float weight = 1;
    float bound = 0; ///< see LightBound
};

/// Lights that can reach some point of a brick, in the order of the pass.
///
/// If many lights have a bound in the brick below `faint` (byte scale; 0: none), a few represent them, see
/// SelectFaintLight. Lights of one surface are consecutive, so a chosen one stands for its neighbors.
class BrickLights {
  public:
    struct Choice {
        std::uint64_t seed = 0; ///< of the random choice among faint lights
        float faint = 0;        ///< byte scale; 0: none
        float minBound = -1;    ///< lights whose bound is not above this are left out. Byte scale
    };
    BrickLights(const BrickCandidates &lights, const BrickView &brick, const Choice &choice, const SkipOptions &skip,
                GridStats &work);
    const std::vector<BrickLight> &List() const { return list_; }
    /// Whether there were many faint lights.
    bool Many() const { return many_; }

  private:
    std::vector<BrickLight> list_;
    bool many_ = false;
};

/// Sets ReceiverBatch::faintResidual of each block to a random start value, so that blocks do not all choose the same
/// lights.
void StartFaintResiduals(std::vector<ReceiverBatch> &blocks, float faint);

enum class ShowProgress { No, Yes };

/// Runs `trace(brick, work)` for bricks 0 to count - 1 on all workers, with progress in the log if asked; adds the sum
/// of `work` to `stats`. Here a brick is any set of receivers that share a list of lights.
void RunBricks(const GridInputs &in, std::int64_t count, GridStats &stats,
               const std::function<void(std::int64_t, GridStats &)> &trace, ShowProgress show = ShowProgress::Yes);

} // namespace q3
