// GPL-2.0-or-later. The SH light grid: where its points are lit from, and their light.
#pragma once

#include "q3map2/light/grid/grid_pass.h"
#include "q3map2/light/grid/lit_points.h"
#include "q3map2/light/grid/smooth_light.h"

#include <vector>

namespace q3 {

/// Layout of an SH grid of that cell size, which is enlarged by kMinCell until the lump has less than 2^31 bytes.
GridLayout LayoutGridSH(const Bsp &bsp, Float3 size);
/// The same for the options of a bake: the cell is that of -gridsh, or the legacy one divided by -gridscalesh, and at
/// least kMinCell. Warns if it is enlarged.
GridLayout SetupGridSH(const Bsp &bsp, const Float3 &legacySize, const LightOptions &options, Log &log);

/// Bakes the uniform SH grid, and keeps what is needed to light positions between its points. Keeps references.
class GridSHTracer {
  public:
    GridSHTracer(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights);
    GridSHTracer(const GridSHTracer &) = delete; // its parts refer to each other
    GridSHTracer &operator=(const GridSHTracer &) = delete;

    /// The SH light grid: points in the open are lit, points in solids next to the open filled and fitted, others zero.
    /// Call it once.
    LightGridSH TraceGridSH(GridStats &stats);
    /// After TraceGridSH: weak light for SmoothLight; null if it is not smooth enough, if tracing all of it takes
    /// little, or with -noskipsmooth.
    const WeakField *Weak() const { return usesWeak_ ? &weak_ : nullptr; }

  private:
    bool HasMuchToTrace() const;
    void TracePoints(std::span<const BrickPoint> points, std::int64_t brick, LightGridSH &grid, GridStats &work) const;

    const GridInputs &in_;
    const GridLayout &layout_;
    const std::size_t lightCount_;
    GridBricks bricks_;
    LitGridPoints lit_;
    ProbeIntegrator integrator_;
    WeakField weak_;
    bool usesWeak_ = false;
};

} // namespace q3
