// GPL-2.0-or-later. Where a pixel of a minimap is sampled.
#include "q3map2/minimap/minimap_samples.h"

#include "libs/math/low_discrepancy.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace q3 {

namespace {

constexpr int kMaxFailures = 1000;

/// Numbers in 0..1 by index.
double RandomUnit(std::uint64_t index) {
    return UnitFromHash(HashIndex(index));
}

/// Squared distance where the unit square repeats.
double WrappedDistance2(const PixelOffset &a, const PixelOffset &b) {
    double sum = 0;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double d = std::abs(a[axis] - b[axis]), wrapped = std::min(d, 1 - d);
        sum += wrapped * wrapped;
    }
    return sum;
}

struct ClosestPair {
    std::size_t a = 0, b = 0;
    double distance2 = std::numeric_limits<double>::max();
};

ClosestPair FindClosestPair(const std::vector<PixelOffset> &points) {
    ClosestPair closest;
    for (std::size_t a = 0; a < points.size(); ++a)
        for (std::size_t b = a + 1; b < points.size(); ++b)
            if (const double d = WrappedDistance2(points[a], points[b]); d < closest.distance2)
                closest = {a, b, d};
    return closest;
}

/// Squared distance of `place` from the nearest point other than `but`.
double Clearance2(const std::vector<PixelOffset> &points, std::size_t but, const PixelOffset &place) {
    double least = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < points.size(); ++i)
        if (i != but)
            least = std::min(least, WrappedDistance2(points[i], place));
    return least;
}

} // namespace

std::vector<PixelOffset> SpreadOffsets(std::size_t count) {
    std::uint64_t index = 0;
    std::vector<PixelOffset> points(count);
    const auto randomPlace = [&index]() -> PixelOffset {
        const double x = RandomUnit(index++);
        return {x, RandomUnit(index++)};
    };
    for (PixelOffset &point : points)
        point = randomPlace();
    if (count < 2)
        return points;
    ClosestPair closest = FindClosestPair(points);
    for (int failures = 0; failures < kMaxFailures;) {
        const std::size_t moved = RandomUnit(index++) < 0.5 ? closest.a : closest.b;
        const PixelOffset place = randomPlace();
        if (Clearance2(points, moved, place) <= closest.distance2) {
            ++failures;
            continue;
        }
        points[moved] = place;
        closest = FindClosestPair(points);
        failures = 0;
    }
    return points;
}

MinimapSampler::MinimapSampler(const MinimapOptions &options)
    : count_(std::size_t(options.randomSamples > 0 ? options.randomSamples : options.samples)) {
    if (options.randomSamples == 0)
        fixed_ = count_ == 1 ? std::vector<PixelOffset>{{0.5, 0.5}} : SpreadOffsets(count_);
}

PixelOffset MinimapSampler::Offset(std::uint64_t pixel, std::size_t sample) const {
    if (!fixed_.empty())
        return fixed_[sample];
    // Uniform in the unit disc.
    const std::uint64_t index = 2 * (pixel * count_ + sample);
    const double radius = std::sqrt(RandomUnit(index)), angle = 2 * std::numbers::pi * RandomUnit(index + 1);
    return {0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle)};
}

} // namespace q3
