// GPL-2.0-or-later. The light grid of RBSP and FBSP files: distinct points, and the number of one for each point.
#include "q3map2/bspfile/grid_table.h"

#include "common/error.h"
#include "libs/math/elementary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <numeric>
#include <queue>
#include <string_view>
#include <unordered_map>

namespace q3 {

namespace {

// ---- Equal points ----

struct HashPoint {
    std::size_t operator()(const bspGridPoint_t &point) const {
        return std::hash<std::string_view>()({reinterpret_cast<const char *>(&point), sizeof point});
    }
};

/// Different points in order of first use, and the number of one for each point.
struct DistinctPoints {
    std::vector<bspGridPoint_t> records;
    std::vector<std::uint32_t> numbers, counts; ///< by point; by record
};

DistinctPoints FindDistinct(std::span<const bspGridPoint_t> points) {
    DistinctPoints distinct;
    std::unordered_map<bspGridPoint_t, std::uint32_t, HashPoint> numberOf;
    distinct.numbers.reserve(points.size());
    for (const bspGridPoint_t &point : points) {
        const auto [found, isNew] = numberOf.try_emplace(point, std::uint32_t(distinct.records.size()));
        if (isNew) {
            distinct.records.push_back(point);
            distinct.counts.push_back(0);
        }
        ++distinct.counts[found->second];
        distinct.numbers.push_back(found->second);
    }
    return distinct;
}

// ---- Near points ----

/// Coordinates of a point in the space in which distances are errors in bytes: ambient and directed colors of all
/// styles, and the direction times the greatest byte of directed light.
constexpr std::size_t kColors = 2 * kStyles * 3, kCoordinates = kColors + 3;
using Coordinates = std::array<float, kCoordinates>;

Coordinates CoordinatesOf(const bspGridPoint_t &point) {
    Coordinates at{};
    std::size_t next = 0;
    std::uint8_t brightest = 0;
    for (std::size_t slot = 0; slot < kStyles; ++slot)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            at[next++] = float(point.ambient[slot][channel]);
            at[next++] = float(point.directed[slot][channel]);
            brightest = std::max(brightest, point.directed[slot][channel]);
        }
    constexpr float kStep = 2 * std::numbers::pi_v<float> / 255; // radians
    const float polar = float(point.latLong[0]) * kStep, around = float(point.latLong[1]) * kStep;
    at[next++] = float(brightest) * Cos(around) * Sin(polar);
    at[next++] = float(brightest) * Sin(around) * Sin(polar);
    at[next++] = float(brightest) * Cos(polar);
    return at;
}

/// A set of points that share a record: a range of Joiner's order_.
struct PointSet {
    std::size_t first = 0, end = 0;
    std::size_t widest = 0; ///< coordinate with the largest error
    double middle = 0;      ///< its mean
    double error = 0;       ///< sum of squared differences from the mean, over points and coordinates
    bool operator<(const PointSet &other) const { return error < other.error; }
};

class Joiner {
  public:
    explicit Joiner(const DistinctPoints &points) : points_(points), order_(points.records.size()) {
        coordinates_.reserve(points.records.size());
        std::ranges::transform(points.records, std::back_inserter(coordinates_), CoordinatesOf);
        std::iota(order_.begin(), order_.end(), std::uint32_t(0));
    }

    /// At most `most` sets, each with points of the same styles.
    std::vector<PointSet> Split(std::size_t most) {
        std::priority_queue<PointSet> sets;
        for (const PointSet &set : SetsByStyles())
            sets.push(set);
        if (sets.size() > most)
            throw Error("the light grid has {} different sets of light styles, expected at most {}", sets.size(), most);
        while (sets.size() < most && sets.top().error > 0) {
            const PointSet set = sets.top();
            sets.pop();
            const auto below = std::stable_partition(
                order_.begin() + std::ptrdiff_t(set.first), order_.begin() + std::ptrdiff_t(set.end),
                [&](std::uint32_t i) { return double(coordinates_[i][set.widest]) <= set.middle; });
            const auto cut = std::size_t(below - order_.begin());
            sets.push(Measured(set.first, cut));
            sets.push(Measured(cut, set.end));
        }
        std::vector<PointSet> all;
        for (; !sets.empty(); sets.pop())
            all.push_back(sets.top());
        return all;
    }

    /// Mean colors, and the direction of the point nearest to the mean.
    bspGridPoint_t RecordOf(const PointSet &set) const {
        const Coordinates mean = MeanOf(set.first, set.end);
        std::uint32_t nearest = order_[set.first];
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = set.first; i < set.end; ++i)
            if (const double d = SquaredDistance(coordinates_[order_[i]], mean); d < least)
                least = d, nearest = order_[i];
        bspGridPoint_t record = points_.records[nearest];
        std::size_t next = 0;
        for (std::size_t slot = 0; slot < kStyles; ++slot)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                record.ambient[slot][channel] = std::uint8_t(std::lround(mean[next++]));
                record.directed[slot][channel] = std::uint8_t(std::lround(mean[next++]));
            }
        return record;
    }

    std::span<const std::uint32_t> PointsOf(const PointSet &set) const {
        return std::span(order_).subspan(set.first, set.end - set.first);
    }

  private:
    std::vector<PointSet> SetsByStyles() {
        const auto stylesOf = [this](std::uint32_t i) { return points_.records[i].styles; };
        std::ranges::stable_sort(order_, {}, stylesOf);
        std::vector<PointSet> sets;
        for (std::size_t first = 0, end = 0; first < order_.size(); first = end) {
            while (end < order_.size() && stylesOf(order_[end]) == stylesOf(order_[first]))
                ++end;
            sets.push_back(Measured(first, end));
        }
        return sets;
    }

    Coordinates MeanOf(std::size_t first, std::size_t end) const {
        std::array<double, kCoordinates> sum{};
        double count = 0;
        for (std::size_t i = first; i < end; ++i) {
            const double weight = points_.counts[order_[i]];
            for (std::size_t c = 0; c < kCoordinates; ++c)
                sum[c] += weight * double(coordinates_[order_[i]][c]);
            count += weight;
        }
        Coordinates mean{};
        std::ranges::transform(sum, mean.begin(), [count](double s) { return float(s / count); });
        return mean;
    }

    PointSet Measured(std::size_t first, std::size_t end) const {
        const Coordinates mean = MeanOf(first, end);
        std::array<double, kCoordinates> errors{};
        for (std::size_t i = first; i < end; ++i) {
            const Coordinates &at = coordinates_[order_[i]];
            for (std::size_t c = 0; c < kCoordinates; ++c) {
                const double d = double(at[c]) - double(mean[c]);
                errors[c] += double(points_.counts[order_[i]]) * d * d;
            }
        }
        PointSet set{.first = first, .end = end};
        set.widest = std::size_t(std::ranges::max_element(errors) - errors.begin());
        set.middle = double(mean[set.widest]);
        // One point has no error; what its mean differs by is rounding.
        set.error = end - first > 1 ? std::accumulate(errors.begin(), errors.end(), 0.0) : 0;
        return set;
    }

    static double SquaredDistance(const Coordinates &a, const Coordinates &b) {
        double sum = 0;
        for (std::size_t c = 0; c < kCoordinates; ++c)
            sum += (double(a[c]) - double(b[c])) * (double(a[c]) - double(b[c]));
        return sum;
    }

    const DistinctPoints &points_;
    std::vector<Coordinates> coordinates_; ///< by record
    std::vector<std::uint32_t> order_;     ///< numbers of records, those of a set together
};

/// Slots that engines show; slot 0 of a point in a wall.
std::size_t ShownSlots(const bspGridPoint_t &point) {
    const auto used = std::size_t(std::ranges::find(point.styles, kNoStyle) - point.styles.begin());
    return std::max<std::size_t>(used, 1);
}

/// Adds the change from `before` to `after` at `count` points. `sum`: of the changes of color bytes.
void AddLoss(const bspGridPoint_t &before, const bspGridPoint_t &after, std::size_t count, GridTableLoss &loss,
             double &sum) {
    if (before == after)
        return;
    loss.changed += count;
    for (std::size_t slot = 0; slot < ShownSlots(before); ++slot)
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (const int change : {int(before.ambient[slot][channel]) - after.ambient[slot][channel],
                                     int(before.directed[slot][channel]) - after.directed[slot][channel]}) {
                loss.worst = std::max(loss.worst, std::abs(change));
                sum += double(count) * std::abs(change);
            }
}

/// Joins points until there are `most` different ones.
DistinctPoints Joined(const DistinctPoints &points, std::size_t most, GridTableLoss &loss) {
    Joiner joiner(points);
    constexpr auto kNone = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> setOf(points.records.size());
    const std::vector<PointSet> sets = joiner.Split(most);
    for (std::size_t s = 0; s < sets.size(); ++s)
        for (const std::uint32_t i : joiner.PointsOf(sets[s]))
            setOf[i] = std::uint32_t(s);
    DistinctPoints joined;
    std::vector<std::uint32_t> numberOf(sets.size(), kNone); // in order of first use
    for (const std::uint32_t set : setOf)
        if (numberOf[set] == kNone) {
            numberOf[set] = std::uint32_t(joined.records.size());
            joined.records.push_back(joiner.RecordOf(sets[set]));
        }
    for (const std::uint32_t number : points.numbers)
        joined.numbers.push_back(numberOf[setOf[number]]);
    double sum = 0, values = 0;
    for (std::size_t i = 0; i < points.records.size(); ++i) {
        const bspGridPoint_t &before = points.records[i];
        AddLoss(before, joined.records[numberOf[setOf[i]]], points.counts[i], loss, sum);
        values += double(points.counts[i]) * double(ShownSlots(before)) * 6; // channels of both colors
    }
    loss.mean = sum / values;
    return joined;
}

} // namespace

GridTable MakeGridTable(std::span<const bspGridPoint_t> points, GridTableLoss &loss, std::size_t most) {
    DistinctPoints distinct = FindDistinct(points);
    loss = {.distinct = distinct.records.size()};
    if (distinct.records.size() > most)
        distinct = Joined(distinct, most, loss);
    return {std::move(distinct.records), {distinct.numbers.begin(), distinct.numbers.end()}};
}

} // namespace q3
