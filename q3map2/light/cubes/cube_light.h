// GPL-2.0-or-later. Light on the six sides of ambient cubes.
#pragma once

#include "q3map2/light/cubes/ambient_cubes.h"
#include "q3map2/light/grid/grid_bricks.h"

#include <vector>

namespace q3 {

/// Computes the light on surfaces that face the axes, at positions in the open: exact for point lights and suns; for
/// area lights as exact as their irradiance vector in the SH grid, except that a light on both sides of a surface's
/// plane is split there.
/// Const after construction; safe from several threads. Keeps references.
class CubeIntegrator {
  public:
    /// lights: from SetupEnvelopes for the SH grid.
    CubeIntegrator(const GridInputs &in, const std::vector<Light> &lights);

    /// The sides at all receivers of the blocks, in order: light of all lights, bounced light, floodlight, ambient and
    /// minimum light, times -gridscale. The blocks should be neighbors: they share a list of lights. seed: of the
    /// random choice among faint lights.
    std::vector<CubeSides> Sides(std::vector<ReceiverBatch> &blocks, std::uint64_t seed, GridStats &work) const;

  private:
    const GridInputs &in_;
    IncidentLightTracer lighting_;
};

/// Sides of ambient cubes read from a stored SH grid.
class CubesFromGridSH {
  public:
    /// radiance: the grid holds radiance, not yet convolved with the cosine lobe. Keeps a reference.
    CubesFromGridSH(const LightGridSH &grid, bool radiance) : grid_(grid), radiance_(radiance) {}
    /// The sides at a position, interpolated as engines do.
    CubeSides At(const Vec3f &position) const;

  private:
    const LightGridSH &grid_;
    bool radiance_;
};

} // namespace q3
