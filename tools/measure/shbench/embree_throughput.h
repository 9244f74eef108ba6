// GPL-2.0-or-later. Ray throughput of bare Embree on a map: the most that a bake can reach.
#pragma once

#include "tools/measure/shbench/bench_map.h"

#include <memory>

namespace q3::bench {

/// Bare Embree on the triangles that a bake traces: packets of 16 rays, each from neighboring points of a grid toward
/// one light that they may see. The results are not used.
class EmbreeThroughput {
  public:
    /// The points are those of `layout` that are in the open. Errors: no memory.
    EmbreeThroughput(const BenchMap &map, const bspGridSHHeader_t &layout, std::uint64_t seed);
    ~EmbreeThroughput();
    EmbreeThroughput(const EmbreeThroughput &) = delete;
    EmbreeThroughput &operator=(const EmbreeThroughput &) = delete;

    /// Occlusion rays per second of one thread's CPU time, measured for that long. 0: there is nothing to trace.
    double PerSecond(double cpuSeconds) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3::bench
