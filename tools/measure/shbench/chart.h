// GPL-2.0-or-later. Charts as SVG and PNG.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace q3::bench {

/// One dot.
struct ChartPoint {
    double x = 0, y = 0;
    std::string label; ///< beside the dot; may be empty
};

/// Dots of one color, joined in their order if `joined`.
struct ChartSeries {
    std::string name; ///< for the key; empty: not in it
    std::vector<ChartPoint> points;
    bool joined = false;
    int color = -1; ///< number in the list of colors, so that a kind looks alike in all charts; -1: its own number
};

enum class AxisScale {
    Linear,
    Logarithmic, ///< values at or under 0 are left out
};

struct ChartAxis {
    std::string title;
    AxisScale scale = AxisScale::Linear;
};

struct Chart {
    std::string title, subtitle;
    ChartAxis x, y;
    std::vector<ChartSeries> series;
    std::optional<double> level; ///< a dashed horizontal line
    std::string levelLabel;
    std::optional<ChartPoint> slopeOne; ///< log-log: a dashed line y ~ x through it, with its label
};

/// Writes base.svg and base.png, the same drawing. Errors: a file that cannot be written.
void WriteChart(const Chart &chart, const std::filesystem::path &base);

} // namespace q3::bench
