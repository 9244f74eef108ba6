// GPL-2.0-or-later. What a position and the grid points around it see of each light. Internal to the causes.
#pragma once

#include "libs/sh/sh.h"
#include "tools/measure/shbench/bench_map.h"

#include <array>

namespace q3::bench {

/// Light of a source of color 1 1 1 without shadows at p: its L2 projection, convolved with the cosine, byte scale.
SHVector UnshadowedLight(const Light &light, const Vec3d &p);

/// Whether p is lit if nothing shadows it: on an emitting side, in the cone, in range.
bool Reaches(const Light &light, const Vec3f &p);

/// Distance from p to the light counted in cells; infinite for suns.
double CellsToLight(const Light &light, const Vec3f &p, const Vec3f &cell);

/// A position and the eight corners of its cell.
class CellSight {
  public:
    static constexpr std::size_t kCorners = 8, kSelf = kCorners; ///< indexes of Receivers()

    /// Keeps a reference to the map.
    CellSight(const BenchMap &map, const GridLayout &layout, const Vec3f &position);

    const std::array<Vec3f, kCorners + 1> &Receivers() const { return receivers_; }
    /// Trilinear weights of the open corners with a clear line to the position, of sum 1; all zero if there are
    /// none.
    const std::array<double, kCorners> &Weights() const { return weights_; }
    /// Whether a corner that counts in the blend is in solid or hidden.
    bool AnyHidden() const { return anyHidden_; }

    /// Share of the light that arrives at each receiver, from up to `samples` rays, by channel. Zero at corners without
    /// weight; a corner that the light does not reach even without shadows has the share of the position.
    using Shares = std::array<Vec3d, kCorners + 1>;
    Shares Seen(const Light &light, int samples) const;

  private:
    void SetWeights();
    void AddRay(const Light &light, const Vec3f &target, Shares &sums) const;

    const BenchMap &map_;
    std::array<Vec3f, kCorners + 1> receivers_;
    std::array<double, kCorners> weights_{};
    bool anyHidden_ = false;
};

} // namespace q3::bench
