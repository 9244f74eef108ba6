// GPL-2.0-or-later. Fills the weak light of the SH grid: traced where it is not smooth, else interpolated.
#pragma once

#include "q3map2/light/grid/lit_points.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/grid/weak_field.h"

#include <vector>

namespace q3 {

/// Fills a WeakField level by level: points that lower levels do not predict well are traced. Keeps references.
class WeakFieldTracer {
  public:
    WeakFieldTracer(const GridInputs &in, const GridLayout &layout, const LitGridPoints &points,
                    const ProbeIntegrator &integrator)
        : in_(in), layout_(layout), points_(points), integrator_(integrator) {}

    /// Sets `weak` at all lit points. The result does not depend on the number of threads. False: the first levels
    /// predict too few points, so that tracing all light at once is faster; `weak` is not complete.
    bool Fill(WeakField &weak, GridStats &stats) const;

  private:
    bool IsSmooth(const WeakField &weak) const;
    void TraceBrick(int level, std::int64_t brick, const std::vector<BrickPoint> &points, WeakField &weak,
                    GridStats &work) const;

    const GridInputs &in_;
    const GridLayout &layout_;
    const LitGridPoints &points_;
    const ProbeIntegrator &integrator_;
};

} // namespace q3
