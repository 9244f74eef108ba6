// GPL-2.0-or-later. The weak part of the light at points of the SH grid: traced where it is not smooth, else
// interpolated; light between the points.
#include "q3map2/light/grid/weak_field.h"

#include "common/parallel.h"
#include "libs/math/elementary.h"
#include "libs/math/morton.h"
#include "libs/math/sampling.h"
#include "libs/sh/sh.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace q3 {

// ---- Weak light at points of the SH grid, predicted by interpolation where it is smooth ----

namespace {

/// Predictions with a larger expected error are not used. Byte scale.
constexpr float kMaxPredictionError = 1.5f;
/// Limit of errors for Interpolate and OffsetAt. What they give enters fits, where errors of samples average out: a
/// lower limit costs rays and hardly gains accuracy; without one, some lights are missed. Byte scale.
constexpr float kMaxInterpolationError = 8;
/// Errors of predictions fall by this factor from level to level: distances fall by sqrt(2), and the error of a mean of
/// two points is in proportion to the square of their distance.
constexpr float kErrorDecay = 0.5f;
/// The cubic through a pair of mean m and the pair of mean m' three times as far out is m + (m - m') / 8. Smaller
/// differences m - m' do not matter; larger ones are not those of a smooth curve. Byte scale.
constexpr float kMinFarDifference = 2, kMaxFarDifference = 24;
/// Error of points that nothing predicted.
constexpr float kUntested = -1;

/// By level: steps, in points, from a point to one end of each of its pairs; the other end is opposite.
constexpr std::array<std::array<Int3, 2>, WeakField::kLevels> kPairs = {{{},
                                                                         {{{0, 0, 1}}},
                                                                         {{{2, 2, 0}, {2, -2, 0}}},
                                                                         {{{2, 0, 0}, {0, 2, 0}}},
                                                                         {{{1, 1, 0}, {1, -1, 0}}},
                                                                         {{{1, 0, 0}, {0, 1, 0}}}}};
std::span<const Int3> PairsOf(int level) {
    const std::size_t count = level == 0 ? 0 : level == 1 ? 1 : 2;
    return std::span(kPairs[std::size_t(level)]).first(count);
}

/// Interpolate needs corners in sight with at least this total weight.
constexpr float kMinCornerWeight = 1.0f / 16;

/// Trilinear weight of a corner.
float CornerWeight(std::size_t corner, const std::array<float, 3> &part) {
    float weight = 1;
    for (std::size_t axis = 0; axis < 3; ++axis)
        weight *= (corner >> axis & 1) != 0 ? part[axis] : 1 - part[axis];
    return weight;
}

/// The largest absolute value of the functions with these coefficients, by channel, at the normals and their opposites:
/// there, even bands are the same and odd ones change sign.
float LargestOf(const std::array<Lanes, 9> &basis, const float *change) {
    return Vectorize([&]() Q3_INLINE {
        Lanes most{};
        for (std::size_t channel = 0; channel < 3; ++channel) {
            Lanes even, odd;
            for (const std::size_t i : kEachLane) {
                odd[i] = basis[1][i] * change[3 + channel] + basis[2][i] * change[6 + channel] +
                         basis[3][i] * change[9 + channel];
                even[i] = basis[0][i] * change[channel] + basis[4][i] * change[12 + channel] +
                          basis[5][i] * change[15 + channel] + basis[6][i] * change[18 + channel] +
                          basis[7][i] * change[21 + channel] + basis[8][i] * change[24 + channel];
            }
            for (const std::size_t i : kEachLane)
                most[i] = std::max(most[i], std::abs(even[i]) + std::abs(odd[i]));
        }
        float largest = 0;
        for (const std::size_t i : kEachLane)
            largest = std::max(largest, most[i]);
        return largest;
    });
}

} // namespace

DisplayedChange::DisplayedChange(bool radiance, float scale) : basis_{} {
    for (int i = 0; i < int(kAxes); ++i) {
        const Vec3d n = Normalize(Vec3d{double(i % 3 - 1), double(i / 3 % 3 - 1), double(i / 9 - 1)});
        const SHVector basis = SHBasis(n);
        for (std::size_t k = 0; k < 9; ++k)
            basis_[k][std::size_t(i)] = float(basis[k] * (radiance ? kCosineLobe[k] : 1) * double(scale));
    }
}

float DisplayedChange::Of(const WeakLight &change) const {
    return LargestOf(basis_, change.coeffs[0].data());
}

int WeakField::LevelOf(int x, int y, int z) {
    if (((x | y) & 1) != 0)
        return (x & y & 1) != 0 ? 4 : 5;
    if (((x | y) & 2) != 0)
        return (x & y & 2) != 0 ? 2 : 3;
    return z & 1;
}

WeakField::WeakField(const BspSpace &space, const GridLayout &layout, const std::vector<PointState> &states,
                     const DisplayedChange &change, const JobPool &jobs)
    : space_(space), layout_(layout), states_(states), change_(change),
      light_(VectorInParallel<WeakLight>(states.size(), jobs)), error_(states.size(), kUntested) {}

bool WeakField::Prediction::IsGood() const {
    return pairs > 0 && isTested && error <= kMaxPredictionError;
}

std::int64_t WeakField::OpenPoint(int x, int y, int z) const {
    if (x < 0 || y < 0 || z < 0 || x >= layout_.bounds[0] || y >= layout_.bounds[1] || z >= layout_.bounds[2])
        return -1;
    const std::int64_t index = layout_.Index(x, y, z);
    return states_[std::size_t(index)] == PointState::Open ? index : -1;
}

bool WeakField::IsClear(const Vec3f &a, const Vec3f &b) const {
    return !space_.AnySolid(Min(a, b), Max(a, b));
}

/// Error of the prediction of a point, or kUntested; on level 0, which nothing predicts, the larger of those above and
/// below.
float WeakField::ErrorNear(int x, int y, int z) const {
    if (LevelOf(x, y, z) > 0)
        return error_[std::size_t(layout_.Index(x, y, z))];
    float error = kUntested;
    for (const int dz : {-1, 1})
        if (const std::int64_t index = OpenPoint(x, y, z + dz); index >= 0)
            error = std::max(error, error_[std::size_t(index)]);
    return error;
}

/// m - m' (see kMinFarDifference), with `mean` that of the pair at the distance `step` from `at`; zero where it is out
/// of range or a point of the far pair is not in sight.
WeakLight WeakField::FarPairDifference(const Int3 &at, const Int3 &step, const WeakLight &mean) const {
    std::array<Int3, 2> ends;
    WeakLight difference = mean;
    for (std::size_t i = 0; i < 2; ++i) {
        const int times = i == 0 ? 3 : -3;
        ends[i] = {at[0] + times * step[0], at[1] + times * step[1], at[2] + times * step[2]};
        const std::int64_t end = OpenPoint(ends[i][0], ends[i][1], ends[i][2]);
        if (end < 0)
            return {};
        AddScaled(-0.5f, light_[std::size_t(end)], difference);
    }
    const float size = change_.Of(difference);
    if (size < kMinFarDifference || size > kMaxFarDifference)
        return {};
    const auto isSeen = [&](const Int3 &end) {
        return IsClear(Vec3f(layout_.Position(at[0], at[1], at[2])), Vec3f(layout_.Position(end[0], end[1], end[2])));
    };
    return isSeen(ends[0]) && isSeen(ends[1]) ? difference : WeakLight{};
}

WeakField::Prediction WeakField::Predict(int x, int y, int z) const {
    Prediction result;
    const int level = LevelOf(x, y, z);
    const std::span<const Int3> pairs = PairsOf(level);
    if (pairs.empty())
        return result;
    const Vec3f cell(layout_.size), p(layout_.Position(x, y, z));
    // Half the size of the box around all pairs: the first is diagonal or vertical, or along x if the second is along
    // y.
    const auto &[reachX, reachY, reachZ] = pairs.front();
    const Vec3f reach{cell.x * float(reachX), cell.y * float(std::max(reachX, reachY)), cell.z * float(reachZ)};
    const bool clear = IsClear(p - reach, p + reach);
    WeakLight means[2] = {};
    for (const auto &[dx, dy, dz] : pairs) {
        const Vec3f offset{cell.x * float(dx), cell.y * float(dy), cell.z * float(dz)};
        int seen = 0;
        WeakLight mean{};
        for (const int side : {1, -1}) {
            const int toX = x + side * dx, toY = y + side * dy, toZ = z + side * dz;
            const std::int64_t end = OpenPoint(toX, toY, toZ);
            if (end < 0 || (!clear && !IsClear(p, p + offset * float(side))))
                continue;
            AddScaled(0.5f, light_[std::size_t(end)], mean);
            ++seen;
            // The errors of level 1, which stand for those of level 0 in ErrorNear, are found only now.
            const float error = level > 1 ? ErrorNear(toX, toY, toZ) : kUntested;
            if (error == kUntested)
                continue;
            const int testedLevel = std::max(1, LevelOf(toX, toY, toZ));
            result.isTested = true;
            result.error = std::max(result.error, error * Pow(kErrorDecay, float(level - testedLevel)));
        }
        if (seen < 2)
            continue;
        AddScaled(1.0f / 8, FarPairDifference({x, y, z}, {dx, dy, dz}, mean), mean);
        means[result.pairs++] = mean;
    }
    if (result.pairs == 2) { // the mean of both, whose difference from each is an estimate of the error
        WeakLight halfDifference{};
        AddScaled(0.5f, means[0], halfDifference);
        AddScaled(-0.5f, means[1], halfDifference);
        result.error = std::max(result.error, change_.Of(halfDifference));
        AddScaled(-1, halfDifference, means[0]);
    }
    result.light = means[0];
    return result;
}

void WeakField::Accept(std::uint32_t index, const Prediction &prediction) {
    light_[index] = prediction.light;
    error_[index] = prediction.error;
}

void WeakField::SetTraced(std::uint32_t index, const WeakLight &light, const Prediction &prediction) {
    light_[index] = light;
    if (prediction.pairs == 0)
        return;
    WeakLight difference = light;
    AddScaled(-1, prediction.light, difference);
    error_[index] = change_.Of(difference);
}

/// False: the position is outside the grid.
bool WeakField::FindPlace(const Vec3f &position, Place &place) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float at = (position[axis] - layout_.mins[axis]) / layout_.size[axis];
        if (!(at >= 0 && at <= float(layout_.bounds[axis] - 1)))
            return false;
        place.low[axis] = std::min(int(at), std::max(0, layout_.bounds[axis] - 2));
        place.part[axis] = at - float(place.low[axis]);
    }
    return true;
}

std::optional<WeakLight> WeakField::Interpolate(const Vec3f &position, const WeakLight &offset) const {
    Place place;
    if (!FindPlace(position, place))
        return std::nullopt;
    const auto &[low, part] = place;
    WeakLight sum{};
    float total = 0;
    const Vec3f first(layout_.Position(low[0], low[1], low[2]));
    const bool clear = IsClear(first, first + Vec3f(layout_.size));
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const int x = low[0] + int(corner & 1), y = low[1] + int(corner >> 1 & 1), z = low[2] + int(corner >> 2);
        const float weight = CornerWeight(corner, part);
        const std::int64_t index = weight > 0 ? OpenPoint(x, y, z) : -1;
        if (index < 0 || (!clear && !IsClear(position, Vec3f(layout_.Position(x, y, z)))))
            continue;
        if (error_[std::size_t(index)] > kMaxInterpolationError)
            return std::nullopt;
        AddScaled(weight, light_[std::size_t(index)], sum);
        total += weight;
    }
    if (total < kMinCornerWeight)
        return std::nullopt;
    WeakLight light = offset;
    AddScaled(1 / total, sum, light);
    return light;
}

std::optional<WeakLight> WeakField::OffsetAt(const Vec3f &position, const WeakLight &traced) const {
    const std::optional<WeakLight> interpolated = Interpolate(position, {});
    if (!interpolated)
        return std::nullopt;
    WeakLight offset = traced;
    AddScaled(-1, *interpolated, offset);
    if (change_.Of(offset) > kMaxInterpolationError)
        return std::nullopt;
    return offset;
}

// ---- Fills the weak light of the SH grid: traced where it is not smooth, else interpolated ----

namespace {

/// Size of bricks in grid points: of levels below kFirstFine, which have few points, and of the others.
constexpr Int3 kCoarseBrick = {16, 16, 8}, kFineBrick = {16, 16, 4};
constexpr int kFirstFine = 4;
/// By level: about log2 of the distance between its columns, by which coordinates are divided for Morton codes.
constexpr int kShift[WeakField::kLevels] = {2, 2, 2, 2, 1, 0};

/// If less than a fraction kMinPredicted of the points of kTestedLevel is predicted well, light is not split: to trace
/// weak and strong light apart takes longer than both at once.
constexpr int kTestedLevel = 3;
constexpr double kMinPredicted = 0.3;

/// A point of the level that is being filled.
struct LevelPoint {
    BrickPoint point;
    WeakField::Prediction prediction;
    std::uint32_t mortonCode; ///< orders points so that neighbors are traced together
};

/// Morton code of the lowest 5 bits: bricks have less than 32 points along each axis.
std::uint32_t MortonInBrick(int x, int y, int z) {
    return std::uint32_t(MortonCode(unsigned(x) & 31, unsigned(y) & 31, unsigned(z) & 31));
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
                if (WeakField::LevelOf(x, y, int(z)) != kTestedLevel || !points_.IsLit(index) ||
                    !isWanted_({x, y, int(z)}))
                    continue;
                ++lit[std::size_t(z)];
                good[std::size_t(z)] += weak.IsOpen(index) && weak.Predict(x, y, int(z)).IsGood();
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
        if (WeakField::LevelOf(x, y, z) != level || !points_.IsLit(point.index) || !isWanted_({x, y, z}))
            continue;
        LevelPoint here{point, {}, MortonInBrick(x >> kShift[level], y >> kShift[level], z)};
        if (weak.IsOpen(point.index))
            here.prediction = weak.Predict(x, y, z);
        if (here.prediction.IsGood())
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

// ---- Light at any position in the open ----

namespace {

void AddProbe(const ProbeReceiver &receiver, std::vector<ReceiverBatch> &blocks) {
    BatchWithRoom(blocks).Add(receiver.position, receiver.position, receiver.cluster, receiver.seed);
}

/// The values of receivers in their order. trace(blocks, store): calls store(number, value) for each of them.
template <typename Trace>
std::vector<bspGridPointSH_t> TracedValues(std::span<const ProbeReceiver> receivers, const Trace &trace) {
    std::vector<ReceiverBatch> blocks;
    for (const ProbeReceiver &receiver : receivers)
        AddProbe(receiver, blocks);
    std::vector<bspGridPointSH_t> values(receivers.size());
    if (!blocks.empty())
        trace(blocks, [&](std::size_t i, const bspGridPointSH_t &value) { values[i] = value; });
    return values;
}

} // namespace

std::vector<bspGridPointSH_t> LightAtPositions::At(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                                   GridStats &work, LightObserver *observer) const {
    if (weak_) {
        std::vector<std::optional<WeakLight>> weak;
        for (const ProbeReceiver &one : receivers) {
            weak.push_back(weak_->Interpolate(one.position, {}));
            work.skippedSmooth += weak.back() ? 1 : 0;
        }
        TraceMissingWeak(receivers, seed, weak, work);
        return TraceStrongAndSum(receivers, seed, weak, work, observer);
    }
    return TracedValues(receivers, [&](std::vector<ReceiverBatch> &blocks, const auto &store) {
        integrator_.Trace(blocks, seed, work, store, observer);
    });
}

void LightAtPositions::TraceMissingWeak(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                        std::span<std::optional<WeakLight>> weak, GridStats &work) const {
    std::vector<ReceiverBatch> blocks;
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < receivers.size(); ++i)
        if (!weak[i])
            numbers.push_back(i), AddProbe(receivers[i], blocks);
    if (!blocks.empty())
        integrator_.TraceWeak(blocks, seed, work,
                              [&](std::size_t i, const WeakLight &light) { weak[numbers[i]] = light; });
}

std::vector<bspGridPointSH_t> LightAtPositions::TraceStrongAndSum(std::span<const ProbeReceiver> receivers,
                                                                  std::uint64_t seed,
                                                                  std::span<const std::optional<WeakLight>> weak,
                                                                  GridStats &work, LightObserver *observer) const {
    const auto weakOf = [&](std::size_t i) -> const WeakLight & { return *weak[i]; };
    return TracedValues(receivers, [&](std::vector<ReceiverBatch> &blocks, const auto &store) {
        integrator_.TraceStrong(blocks, seed, work, weakOf, store, observer);
    });
}

} // namespace q3
