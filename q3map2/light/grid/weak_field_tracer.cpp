// GPL-2.0-or-later. Fills the weak light of the SH grid: traced where it is not smooth, else interpolated.
#include "q3map2/light/grid/weak_field_tracer.h"

#include "libs/math/low_discrepancy.h"

#include <algorithm>
#include <numeric>

namespace q3 {

namespace {

/// Size of bricks in grid points: of levels below kFirstFine, which have few points, and of the others.
constexpr Int3 kCoarseBrick = {16, 16, 8}, kFineBrick = {16, 16, 4};
constexpr int kFirstFine = 4;
/// By level: log2 of the distance of its points in columns, about.
constexpr int kShift[WeakField::kLevels] = {2, 2, 2, 2, 1, 0};

/// If less than a share of kMinPredicted of the points of kTestedLevel is predicted well, light is not split: to trace
/// weak and strong light apart takes longer than both at once.
constexpr int kTestedLevel = 3;
constexpr double kMinPredicted = 0.3;

/// A point of the level that is being filled.
struct LevelPoint {
    BrickPoint point;
    WeakField::Prediction prediction;
    std::uint32_t mortonCode; ///< orders points so that neighbors are traced together
};

/// Morton code of the lowest 5 bits.
std::uint32_t MortonOf(int x, int y, int z) {
    std::uint32_t code = 0;
    for (unsigned bit = 0; bit < 5; ++bit)
        code |= (unsigned(x) >> bit & 1) << 3 * bit | (unsigned(y) >> bit & 1) << (3 * bit + 1) |
                (unsigned(z) >> bit & 1) << (3 * bit + 2);
    return code;
}

} // namespace

bool WeakFieldTracer::Fill(WeakField &weak, GridStats &stats) const {
    for (int level = 0; level < WeakField::kLevels; ++level) {
        if (level == kTestedLevel && !IsSmooth(weak))
            return false;
        const GridBricks bricks(layout_, level < kFirstFine ? kCoarseBrick : kFineBrick);
        const auto trace = [&](std::int64_t brick, GridStats &work) {
            TraceBrick(level, brick, bricks.Points(brick), weak, work);
        };
        RunBricks(in_, bricks.Count(), stats, trace, ShowProgress::No);
    }
    return true;
}

/// Whether enough points of kTestedLevel are predicted well.
bool WeakFieldTracer::IsSmooth(const WeakField &weak) const {
    std::vector<std::int64_t> lit(std::size_t(layout_.bounds[2])), good(lit.size());
    in_.jobs.For(layout_.bounds[2], [&](std::int64_t z, int) {
        for (int y = 0; y < layout_.bounds[1]; ++y)
            for (int x = 0; x < layout_.bounds[0]; ++x) {
                const auto index = std::uint32_t(layout_.Index(x, y, z));
                if (WeakField::LevelOf(x, y, int(z)) != kTestedLevel || !points_.IsLit(index))
                    continue;
                ++lit[std::size_t(z)];
                good[std::size_t(z)] += weak.IsOpen(index) && weak.Predict(x, y, int(z)).Good();
            }
    });
    const auto sum = [](const std::vector<std::int64_t> &counts) {
        return double(std::accumulate(counts.begin(), counts.end(), std::int64_t(0)));
    };
    return sum(good) >= kMinPredicted * sum(lit);
}

void WeakFieldTracer::TraceBrick(int level, std::int64_t brick, const std::vector<BrickPoint> &points, WeakField &weak,
                                 GridStats &work) const {
    std::vector<LevelPoint> traced;
    for (const BrickPoint &point : points) {
        const auto [x, y, z] = layout_.Coordinates(point.index);
        if (WeakField::LevelOf(x, y, z) != level || !points_.IsLit(point.index))
            continue;
        LevelPoint here{point, {}, MortonOf(x >> kShift[level], y >> kShift[level], z)};
        if (weak.IsOpen(point.index))
            here.prediction = weak.Predict(x, y, z);
        if (here.prediction.Good())
            weak.Accept(point.index, here.prediction), ++work.skippedSmooth;
        else
            traced.push_back(here);
    }
    if (traced.empty())
        return;
    std::stable_sort(traced.begin(), traced.end(),
                     [](const LevelPoint &a, const LevelPoint &b) { return a.mortonCode < b.mortonCode; });
    std::vector<ReceiverBatch> blocks;
    for (const LevelPoint &one : traced)
        points_.AddReceiver(one.point, blocks);
    integrator_.TraceWeak(blocks, HashIndex(std::uint64_t(brick * WeakField::kLevels + level)), work,
                          [&](std::size_t i, const WeakLight &light) {
                              weak.SetTraced(traced[i].point.index, light, traced[i].prediction);
                          });
}

} // namespace q3
