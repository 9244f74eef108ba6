// GPL-2.0-or-later. Axis of a chart: range, ticks, from values to picture units. Internal to the chart.
#pragma once

#include "tools/measure/shbench/chart.h"

#include <string>
#include <vector>

namespace q3::bench {

class ChartScale {
  public:
    /// Covers the values with a margin; a scale of positive values does not go under 0. start, end: picture coordinates
    /// of its ends.
    ChartScale(const std::vector<double> &values, AxisScale scale, double start, double end);
    /// Picture coordinate of a value.
    double At(double value) const;
    /// Whether the scale has a place for the value.
    bool Shows(double value) const { return !log_ || value > 0; }
    double Low() const { return low_; }
    double High() const { return high_; }

    struct Tick {
        double value = 0;
        std::string label; ///< empty: a minor tick
    };
    std::vector<Tick> Ticks() const;

  private:
    bool log_;
    double low_ = 0, high_ = 1, start_, end_;
};

} // namespace q3::bench
