// GPL-2.0-or-later. The SH light grid: the light of its points, and its form without negative lobes.
#pragma once

#include "common/jobs.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/weak_field.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// Result of deringing.
struct DeringStats {
    std::int64_t points = 0;  ///< number of points changed
    double largestChange = 0; ///< of displayed light in 26 directions, in 255ths
    /// Sums the points and takes the larger change.
    void Add(const DeringStats &o);
};

/// Makes the smallest change to each channel that leaves no direction below zero; see RemoveNegativeLobes. Channels
/// without negative directions keep their bits. radiance: coefficients are not convolved with the cosine.
DeringStats DeringPoint(bspGridPointSH_t &point, bool radiance);

/// DeringPoint for all points. Since games blend points with weights that are not negative, nothing between them is
/// below zero either.
DeringStats DeringGridSH(LightGridSH &grid, bool radiance, const JobPool &jobs);

/// Layout of an SH grid of that cell size, which is enlarged by kMinCell until the lump has less than 2^31 bytes.
GridLayout LayoutGridSH(const Bsp &bsp, Float3 size);
/// The cell that the options of a bake ask for: that of -gridsh, or the legacy one divided by -gridscalesh, and at
/// least kMinCell.
Float3 CellOfGridSH(const Float3 &legacySize, const LightOptions &options);
/// LayoutGridSH of that cell. Warns if it is enlarged.
GridLayout SetupGridSH(const Bsp &bsp, const Float3 &legacySize, const LightOptions &options, Log &log);

/// What TraceGridSH finds on its way, for explanations.
struct GridSHSteps {
    std::vector<PointState> placed, states; ///< by point: before and after points in solids are filled
    std::vector<DisplacedPoint> displaced;
    VisibilityGroups groups;
    LightGridSH traced; ///< light of the points that are lit; others are zero
    LightGridSH filled; ///< before the fit
};

/// Bakes the uniform SH grid, and keeps what is needed to light positions between its points. Keeps references.
class GridSHTracer {
  public:
    GridSHTracer(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights);
    GridSHTracer(const GridSHTracer &) = delete; // its parts refer to each other
    GridSHTracer &operator=(const GridSHTracer &) = delete;

    /// The SH light grid: points in the open are lit, points in solids next to the open filled and fitted, others zero.
    /// Call it once. steps: set unless null.
    LightGridSH TraceGridSH(GridStats &stats, GridSHSteps *steps = nullptr);
    /// Only the light of the points that are lit; others are zero. observer: sees lights as they arrive, from any
    /// thread. Call it once, in place of TraceGridSH.
    LightGridSH TracePointsOnly(GridStats &stats, LightObserver &observer);
    const std::vector<PointState> &States() const { return lit_.States(); }
    /// After TraceGridSH: weak light for LightAtPositions; null if it is not smooth enough, if tracing all of it takes
    /// little, or with -noskipsmooth.
    const WeakField *Weak() const { return usesWeak_ ? &weak_ : nullptr; }

  private:
    bool HasMuchToTrace() const;
    void FindOwn();
    /// Whether this process lights the brick; in a part of several it lights some.
    bool IsOwn(std::int64_t brick) const { return own_.empty() || own_[std::size_t(brick)] != 0; }
    LightGridSH EmptyGrid(GridStats &stats) const;
    void FillWeak(GridStats &stats);
    void TracePoints(std::span<const BrickPoint> points, std::int64_t brick, LightGridSH &grid, GridStats &work,
                     LightObserver *observer = nullptr) const;

    const GridInputs &in_;
    const GridLayout &layout_;
    const std::size_t lightCount_;
    GridBricks bricks_;
    LitGridPoints lit_;
    std::vector<std::uint8_t> own_;     ///< by brick; empty: all
    std::vector<std::uint8_t> nearOwn_; ///< by brick: own, or at most kNearOwn bricks away; empty: all
    ProbeIntegrator integrator_;
    WeakField weak_;
    bool usesWeak_ = false;
};

} // namespace q3
