// GPL-2.0-or-later. Positions near lights, where light changes faster than the points of the uniform grid show.
#pragma once

#include "q3map2/light/grid/weak_field.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/sparse/display_error.h"
#include "q3map2/light/sparse/octree_refine.h"

#include <span>
#include <vector>

namespace q3 {

/// Positions in the open in front of surface lights and spotlights and around point lights, with their light. A light
/// may light the space between the points of a grid so that none of them shows how the light changes: the error of
/// cells there is measured at these positions. Const after construction; keeps references.
class NearLightSet {
  public:
    /// lights: those of the SH grid. maxSamples: of more, random ones are left out, about this many stay. Adds the work
    /// to `stats`.
    NearLightSet(const GridInputs &in, const std::vector<Light> &lights, const LightAtPositions &light,
                 const SparseLattice &lattice, std::size_t maxSamples, GridStats &stats);
    std::span<const NearLightSample> All() const { return samples_; }
    /// Mean squared displayed error of interpolation between the corners of a cell at samples inside it, bytes^2. It is
    /// the lesser of two: the error of traced light without what noise adds, and the error of the light of the samples'
    /// own lights as if nothing cast shadows. So shadow edges do not split cells near a light: there all cells would
    /// become as small as possible. Infinite where the light at a corner is not known.
    float ErrorIn(const OctreeCell &cell, std::span<const std::uint32_t> samples, const LatticePoints &points,
                  const BounceNoise &noise) const;

  private:
    SHFloats NearLightsAt(std::uint32_t sample, const Vec3f &position) const;

    const std::vector<Light> &lights_;
    const SparseLattice &lattice_;
    ScreenError screen_;
    std::vector<NearLightSample> samples_;
    std::vector<std::uint32_t> lightNumbers_;             ///< indexes of lights
    std::vector<std::uint32_t> firstLight_, lightCounts_; ///< by sample: its lights in lightNumbers_
};

/// Sets OctreeCell::nearLightError, and splits leafs in which it is above `maxError` (mean squared, bytes^2) down to
/// the smallest cells.
void SplitNearLights(const NearLightSet &samples, float maxError, const BounceNoise &noise, const JobPool &jobs,
                     Octree &tree, const LatticePoints &points, OctreeRefiner &refiner, const LatticeTracer &tracer,
                     GridStats &stats);

} // namespace q3
