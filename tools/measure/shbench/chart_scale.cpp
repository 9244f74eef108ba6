// GPL-2.0-or-later. Axis of a chart.
#include "tools/measure/shbench/chart_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace q3::bench {

namespace {

constexpr double kLogMargin = 1.35;    ///< factor beyond the least and the greatest value
constexpr double kLinearMargin = 0.15; ///< of the range of the values, on each side
constexpr double kWantedTicks = 6;     ///< of linear scales, about
/// Logarithmic scales of fewer decades have labels at 2 and 5 too, or at all digits.
constexpr double kDecadesOfThreeLabels = 2.5, kDecadesOfAllLabels = 0.7;

} // namespace

ChartScale::ChartScale(const std::vector<double> &values, AxisScale scale, double start, double end)
    : log_(scale == AxisScale::Logarithmic), start_(start), end_(end) {
    bool any = false;
    for (const double value : values) {
        if (!Shows(value) || !std::isfinite(value))
            continue;
        low_ = any ? std::min(low_, value) : value;
        high_ = any ? std::max(high_, value) : value;
        any = true;
    }
    if (!any)
        low_ = log_ ? 0.1 : 0, high_ = 1;
    if (log_) {
        low_ /= kLogMargin, high_ *= kLogMargin;
        return;
    }
    const double margin = high_ > low_ ? kLinearMargin * (high_ - low_) : 0.5;
    low_ = low_ >= 0 ? std::max(0.0, low_ - margin) : low_ - margin;
    high_ += margin;
}

double ChartScale::At(double value) const {
    const double share = log_ ? std::log(value / low_) / std::log(high_ / low_) : (value - low_) / (high_ - low_);
    return start_ + (end_ - start_) * share;
}

std::vector<ChartScale::Tick> ChartScale::Ticks() const {
    std::vector<Tick> ticks;
    if (log_) {
        const double decades = std::log10(high_ / low_);
        for (int power = int(std::floor(std::log10(low_))); std::pow(10, power) <= high_; ++power)
            for (int digit = 1; digit < 10; ++digit) {
                const double value = digit * std::pow(10, power);
                if (value < low_ || value > high_)
                    continue;
                const bool labeled = digit == 1 || (decades < kDecadesOfThreeLabels && (digit == 2 || digit == 5)) ||
                                     decades < kDecadesOfAllLabels;
                ticks.push_back({value, labeled ? fmt::format("{:.6g}", value) : ""});
            }
        return ticks;
    }
    const double rough = (high_ - low_) / kWantedTicks, base = std::pow(10, std::floor(std::log10(rough)));
    const double step = base * (rough / base > 5 ? 10 : rough / base > 2 ? 5 : rough / base > 1 ? 2 : 1);
    for (double value = std::ceil(low_ / step) * step; value <= high_; value += step)
        ticks.push_back({value, fmt::format("{:.6g}", std::abs(value) < step / 2 ? 0 : value)});
    return ticks;
}

} // namespace q3::bench
