// GPL-2.0-or-later. Positions before lamps, where light changes faster than the points of the uniform grid show.
#pragma once

#include "q3map2/light/grid/smooth_light.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sparse/octree_refine.h"
#include "q3map2/light/sparse/screen_error.h"

#include <span>
#include <vector>

namespace q3 {

/// Positions in the open before surface lights, and around point lights and spotlights, with their light. A lamp may
/// shine between the points of a grid so that none of them shows how the light changes: cells there are measured at
/// these positions. Const after construction.
class LampSamples {
  public:
    /// lights: of the SH grid. mostSamples: when there are more, random ones are left out. Adds the work to `stats`.
    LampSamples(const GridInputs &in, const std::vector<Light> &lights, const SmoothLight &light,
                const SparseLattice &lattice, std::size_t mostSamples, GridStats &stats);
    std::span<const LampSample> All() const { return samples_; }

  private:
    std::vector<LampSample> samples_;
};

/// Sets OctreeCell::lamp, and splits leafs in which it is above `maxError` (mean squared, bytes^2) down to the smallest
/// cells.
void SplitAtLamps(std::span<const LampSample> samples, float maxError, const BounceNoise &noise, Octree &tree,
                  const LatticePoints &light, OctreeRefiner &refiner, const LatticeTracer &tracer, GridStats &stats);

} // namespace q3
