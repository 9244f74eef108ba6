// GPL-2.0-or-later. SH grid points fitted to the light between them.
#include "q3map2/light/grid/gridsh_fit.h"

#include "common/parallel.h"
#include "libs/math/elementary.h"
#include "libs/math/sampling.h"
#include "libs/sh/sh.h"
#include "q3map2/light/batch/receivers.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace q3 {

namespace {

/// Samples in each cell that has a point in a solid, without -shfit.
constexpr float kSamplesPerCell = 4;
/// With -shfit, cells in which the mean light of samples differs by more than kSteepDifference take kSteepFactor times
/// the samples: with few, the fit beside a light depends on where they happen to be. 1 = byte 255.
constexpr float kSteepDifference = 16.0f / 255;
constexpr int kSteepFactor = 6;
/// Candidates drawn at most for each sample wanted, with and without -shfit, so that cells that are mostly solid get as
/// many samples as others.
constexpr int kMaxTriesAll = 8, kMaxTries = 2;
/// Weight of a point's value before the fit, as a fraction of the weight of its samples; without and with -shfit.
constexpr float kPull = 0.1f, kPullAll = 0.03f;
/// Samples of mean light m have weight (kDarkLight / (kDarkLight + m))^(1/4): leaks show in the dark. 1 = byte 255.
constexpr float kDarkLight = 0.02f;
/// Samples of mean light m count less where kBeyondScreen * m > 1: their weight is divided by (kBeyondScreen *
/// m)^kFall. Surfaces there are white on at least one side, and the steep light beside a light, which no grid
/// fits, would distort points several cells away. The ...All values are for -shfit, where more points follow such
/// light.
constexpr float kBeyondScreen = 3, kBeyondScreenAll = 2.2f, kFall = 4, kFallAll = 2;
/// Upper limit of kBeyondScreen * m, which keeps weights of absurd light within floats.
constexpr float kMaxBeyondScreen = 1e4f;
/// Points whose samples have less weight keep their values.
constexpr float kMinWeight = 1e-30f;
/// Norm of bands 1 and 2 over coefficient 0 for light from a single direction, plain, sqrt(3 + 5), and convolved with
/// the cosine, sqrt(3 (2/3)^2 + 5 (1/4)^2): the most that light that is nowhere negative can have. Interpolation
/// between points lowers the ratio, so a point may exceed it by the factor kBandsSlack.
constexpr float kMaxBandsPlain = 2.8284271f, kMaxBands = 1.2829003f, kBandsSlack = 1.25f;
/// Relaxation ends when no coefficient moves by more than this, or by more than this fraction of the light there. 1 =
/// byte 255.
constexpr float kSmallMove = 0.1f / 255;
/// It ends after this many sweeps at the latest.
constexpr int kMaxSweeps = 40;
/// Points of equal parity on all axes share no cell, so that they can move at the same time.
constexpr int kParities = 8;

/// Index of the point at entry s of a stencil relative to the point in its center.
std::int64_t OffsetOf(std::size_t s, std::int64_t width, std::int64_t slice) {
    return std::int64_t(s % 3) - 1 + (std::int64_t(s / 3 % 3) - 1) * width + (std::int64_t(s / 9) - 1) * slice;
}

/// Whether the mean light of the samples differs by more than kSteepDifference.
bool IsSteep(std::span<const FitSample> samples) {
    float least = 1, most = 0;
    for (const FitSample &sample : samples) {
        const float shown = std::min(1.0f, MeanLight(std::bit_cast<SHFloats>(sample.value)));
        least = std::min(least, shown), most = std::max(most, shown);
    }
    return most - least > kSteepDifference;
}

Vec3f PositionOf(const GridLayout &layout, std::int64_t index) {
    const auto [x, y, z] = layout.Coordinates(index);
    return Vec3f(layout.Position(x, y, z));
}

/// Limits each channel to about what light that is nowhere negative can have: coefficient 0 at least 0, the norm of the
/// others at most maxBands times that. Coefficient k of a channel is at 3 k + channel.
void LimitToLight(SHFloats &point, float maxBands) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
        float bands = 0;
        for (std::size_t i = channel + 3; i < kSHFloats; i += 3)
            bands += point[i] * point[i];
        bands = std::sqrt(bands);
        point[channel] = std::max(0.0f, point[channel]);
        const float most = maxBands * point[channel];
        for (std::size_t i = channel + 3; i < kSHFloats && bands > most; i += 3)
            point[i] *= most / bands;
    }
}

} // namespace

float FitWeight(float weight, float mean, FittedPoints fitted) {
    const bool all = fitted == FittedPoints::All;
    const float beyond = std::clamp((all ? kBeyondScreenAll : kBeyondScreen) * mean, 1.0f, kMaxBeyondScreen);
    return weight * Pow(kDarkLight / (kDarkLight + mean), 0.25f) / Pow(beyond, all ? kFallAll : kFall);
}

GridFit::GridFit(const GridInputs &in, const GridLayout &layout, const std::vector<PointState> &states,
                 const std::vector<bool> &isSplit)
    : in_(in), layout_(layout),
      perCell_(
          int(std::ceil((in.options.shFit > 0 ? float(in.options.shFit) : kSamplesPerCell) * in.options.shSamples))),
      pull_(in.options.shFit > 0 ? kPullAll : kPull),
      maxBandRatio_(kBandsSlack * (in.options.shRadiance ? kMaxBandsPlain : kMaxBands)), states_(states),
      rowOf_(states.size(), -1) {
    if (!in.options.shFill)
        return;
    const auto isFitted = [&](std::size_t i) {
        return states[i] != PointState::Exterior && !isSplit[i] &&
               (in.options.shFit > 0 || states[i] != PointState::Open);
    };
    std::int32_t rows = 0;
    for (std::size_t i = 0; i < states.size(); ++i)
        if (isFitted(i))
            rowOf_[i] = rows++;
    ReserveInParallel(std::size_t(rows), in.jobs, rows_);
    for (std::size_t i = 0; i < states.size(); ++i)
        if (rowOf_[i] >= 0)
            rows_.push_back({std::uint32_t(i)});
}

std::array<GridFit::Corner, 8> GridFit::CornersAt(const Vec3f &p) const {
    std::array<std::int64_t, 3> low{};
    std::array<float, 3> part{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float at =
            std::clamp((p[axis] - layout_.mins[axis]) / layout_.size[axis], 0.0f, float(layout_.bounds[axis] - 1));
        low[axis] = std::min(std::int64_t(at), std::max<std::int64_t>(0, layout_.bounds[axis] - 2));
        part[axis] = at - float(low[axis]);
    }
    const std::int64_t step[3] = {layout_.bounds[0] > 1 ? 1 : 0, layout_.bounds[1] > 1 ? layout_.bounds[0] : 0,
                                  layout_.bounds[2] > 1 ? std::int64_t(layout_.bounds[0]) * layout_.bounds[1] : 0};
    const std::int64_t base = layout_.Index(low[0], low[1], low[2]);
    std::array<Corner, 8> corners;
    for (std::size_t c = 0; c < 8; ++c) {
        const bool x = c & 1, y = c & 2, z = c & 4;
        corners[c] = {base + (x ? step[0] : 0) + (y ? step[1] : 0) + (z ? step[2] : 0),
                      (x ? part[0] : 1 - part[0]) * (y ? part[1] : 1 - part[1]) * (z ? part[2] : 1 - part[2])};
    }
    return corners;
}

bool GridFit::HasFittedCorner(const BrickPoint &point) const {
    for (const Corner &corner : CornersAt(point.position + Vec3f(layout_.size) * 0.5f))
        if (rowOf_[std::size_t(corner.index)] >= 0)
            return true;
    return false;
}

std::vector<FitSample> GridFit::SampleCells(std::span<const BrickPoint> points, const LightAtPositions &light,
                                            GridStats &work) const {
    std::vector<FitSample> samples;
    if (rows_.empty())
        return samples;
    const Vec3f cell(layout_.size);
    std::vector<CellSamples> cells;
    for (const BrickPoint &point : points)
        if (HasFittedCorner(point) && in_.space.AnyOpen(point.position, point.position + cell, kClearance))
            cells.push_back({&point, perCell_});
    DrawSamples(cells, 0, light, samples, work);
    if (in_.options.shFit > 0) {
        for (CellSamples &inCell : cells) {
            const auto [first, count] = inCell.rounds[0];
            inCell.wanted = IsSteep(std::span(samples.data() + first, count)) ? (kSteepFactor - 1) * perCell_ : 0;
        }
        DrawSamples(cells, 1, light, samples, work);
    }
    for (const CellSamples &inCell : cells)
        for (const auto &[first, count] : inCell.rounds)
            for (FitSample &sample : std::span(samples.data() + first, count))
                sample.weight = float(perCell_) / float(inCell.tried);
    if (in_.options.shFit > 0)
        FindSeen(samples, work);
    return samples;
}

/// Draws positions in cells where a player fits, and lights them: x and y from a low-discrepancy sequence, z stratified
/// into perCell_ layers.
void GridFit::DrawSamples(std::span<CellSamples> cells, std::size_t round, const LightAtPositions &light,
                          std::vector<FitSample> &samples, GridStats &work) const {
    std::vector<ProbeReceiver> receivers;
    const Vec3f cell(layout_.size);
    const int tries = in_.options.shFit > 0 ? kMaxTriesAll : kMaxTries;
    const std::size_t before = samples.size();
    for (CellSamples &inCell : cells) {
        CellSamples::Range &drawn = inCell.rounds[round];
        drawn.first = samples.size();
        for (const int end = inCell.tried + inCell.wanted * tries;
             inCell.tried < end && samples.size() - drawn.first < std::size_t(inCell.wanted); ++inCell.tried) {
            const Sample2 s = PlasticSample(std::uint32_t(inCell.tried), inCell.point->index);
            const std::uint64_t hash =
                HashIndex((std::uint64_t(inCell.point->index) << 16) + std::uint64_t(inCell.tried));
            const double layer = (inCell.tried % perCell_ + UnitFromHash(hash)) / perCell_;
            const Vec3f p = inCell.point->position + cell * Vec3f{float(s.u), float(s.v), float(layer)};
            const int cluster = in_.space.ClusterAt(p, kClearance);
            if (cluster < 0 || !in_.space.PlayerFits(p))
                continue;
            receivers.push_back({p, cluster, std::uint32_t(hash)});
            samples.push_back({p, {}});
        }
        drawn.count = samples.size() - drawn.first;
    }
    if (receivers.empty())
        return;
    std::uint64_t seed = HashIndex(cells.front().point->index);
    for (std::size_t i = 0; i < round; ++i)
        seed = HashIndex(seed);
    const std::span added = std::span(samples).subspan(before);
    if (light.Weak())
        return LightCells({cells, round, before, receivers, seed}, light, added, work);
    const std::vector<bspGridPointSH_t> values = light.At(receivers, seed, work);
    for (std::size_t i = 0; i < added.size(); ++i)
        added[i].value = values[i];
}

/// Sets the light of the samples. The first sample of each cell is traced; where interpolation nearly gives its weak
/// light, the weak light of the others is interpolated too, with the difference at the first one added.
void GridFit::LightCells(const Round &round, const LightAtPositions &light, std::span<FitSample> samples,
                         GridStats &work) const {
    const WeakField &field = *light.Weak();
    std::vector<std::optional<WeakLight>> weak(round.receivers.size());
    if (round.number == 0) {
        std::vector<ProbeReceiver> first;
        for (const CellSamples &inCell : round.cells)
            if (inCell.rounds[0].count > 0)
                first.push_back(round.receivers[inCell.rounds[0].first - round.firstSample]);
        std::vector<std::optional<WeakLight>> traced(first.size());
        light.TraceMissingWeak(first, round.seed, traced, work);
        std::size_t next = 0;
        for (CellSamples &inCell : round.cells)
            if (inCell.rounds[0].count > 0) {
                inCell.offset = field.OffsetAt(first[next].position, *traced[next]);
                weak[inCell.rounds[0].first - round.firstSample] = traced[next++];
            }
    }
    for (const CellSamples &inCell : round.cells) {
        const auto [first, count] = inCell.rounds[round.number];
        for (std::size_t i = first - round.firstSample; inCell.offset && i < first - round.firstSample + count; ++i)
            if (!weak[i]) {
                weak[i] = field.Interpolate(round.receivers[i].position, *inCell.offset);
                work.skippedSmooth += weak[i] ? 1 : 0;
            }
    }
    light.TraceMissingWeak(round.receivers, HashIndex(round.seed), weak, work);
    const std::vector<bspGridPointSH_t> values = light.TraceStrongAndSum(round.receivers, round.seed, weak, work);
    for (std::size_t i = 0; i < samples.size(); ++i)
        samples[i].value = values[i];
}

/// Clears the bits in seenCorners of the corners in the open that a sample does not see.
void GridFit::FindSeen(std::span<FitSample> samples, GridStats &work) const {
    struct Sight {
        FitSample *sample;
        std::uint8_t bit;
    };
    auto rays = MakeRayBatcher<Sight>([&](RayPacket &packet, std::span<const Sight> sights) {
        in_.scene.TraceToLight(packet, ShadowRules::Exact, work.counts);
        for (std::size_t i = 0; i < sights.size(); ++i)
            if (packet.live[i] == 0)
                sights[i].sample->seenCorners &= std::uint8_t(~sights[i].bit);
    });
    for (FitSample &sample : samples) {
        const auto corners = CornersAt(sample.position);
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto point = std::size_t(corners[i].index);
            if (states_[point] == PointState::Open && rowOf_[point] >= 0)
                rays.Aim({&sample, std::uint8_t(1u << i)}, sample.position, PositionOf(layout_, corners[i].index));
        }
    }
    rays.Flush();
}

void GridFit::AddSamples(std::int64_t brick, std::vector<FitSample> samples) {
    std::unique_lock lock(mutex_);
    waiting_.emplace(brick, std::move(samples));
    if (isAdding_) // by a worker that will find these samples too
        return;
    isAdding_ = true;
    for (; !waiting_.empty() && waiting_.begin()->first == next_; ++next_) {
        const auto first = waiting_.extract(waiting_.begin());
        lock.unlock(); // no worker waits while samples are added
        for (const FitSample &sample : first.mapped())
            Accumulate(sample);
        lock.lock();
    }
    isAdding_ = false;
}

void GridFit::Accumulate(const FitSample &sample) {
    const float weight = FitWeight(sample.weight, MeanLight(std::bit_cast<SHFloats>(sample.value)),
                                   in_.options.shFit > 0 ? FittedPoints::All : FittedPoints::InSolids);
    const auto corners = CornersAt(sample.position);
    const auto coefficients = std::bit_cast<SHFloats>(sample.value);
    for (std::size_t a = 0; a < 8; ++a) {
        const std::int32_t number = rowOf_[std::size_t(corners[a].index)];
        if (number < 0 || (sample.seenCorners >> a & 1) == 0)
            continue;
        Row &row = rows_[std::size_t(number)];
        const float fraction = weight * corners[a].weight;
        for (std::size_t i = 0; i < kSHFloats; ++i)
            row.rhs[i] += fraction * coefficients[i];
        for (std::size_t b = 0; b < 8; ++b) {
            // Offset of corner b from corner a on an axis, plus 1: coordinate 0 to 2 in the 3 x 3 x 3 stencil.
            const auto axis = [&](std::size_t bit) { return 1 + int((b >> bit) & 1) - int((a >> bit) & 1); };
            row.stencil[std::size_t(axis(0) + 3 * (axis(1) + 3 * axis(2)))] += fraction * corners[b].weight;
        }
    }
}

/// One Gauss-Seidel step: value = (rhs - sum of stencil * neighbors) / stencil in the center. Then
/// LimitToLight. Returns the largest change of a coefficient, divided by the largest coefficient 0 if that is above 1.
float GridFit::Relax(const Row &row, LightGridSH &grid) const {
    return Vectorize([&]() Q3_INLINE {
        SHFloats value = row.rhs;
        const std::int64_t width = layout_.bounds[0], slice = width * layout_.bounds[1];
        for (std::size_t s = 0; s < kStencil; ++s) {
            const float factor = row.stencil[s];
            if (s == kCenter || factor == 0)
                continue;
            const float *neighbor = grid.points[std::size_t(row.index + OffsetOf(s, width, slice))].coeffs[0].data();
            for (std::size_t i = 0; i < kSHFloats; ++i)
                value[i] -= factor * neighbor[i];
        }
        const float inverse = 1 / row.stencil[kCenter];
        for (float &coefficient : value)
            coefficient *= inverse;
        LimitToLight(value, maxBandRatio_);
        bspGridPointSH_t &stored = grid.points[row.index];
        const auto old = std::bit_cast<SHFloats>(stored);
        float most = 0;
        for (std::size_t i = 0; i < kSHFloats; ++i)
            most = std::max(most, std::abs(value[i] - old[i]));
        stored = std::bit_cast<bspGridPointSH_t>(value);
        return most / std::max({1.0f, value[0], value[1], value[2]});
    });
}

/// Adds the pull towards the present value to a row. False: too little weight to move the point.
bool GridFit::AddPull(const bspGridPointSH_t &present, Row &row) const {
    const float total = std::accumulate(row.stencil.begin(), row.stencil.end(), 0.0f);
    if (!(total > kMinWeight))
        return false;
    const float pull = pull_ * total;
    const auto before = std::bit_cast<SHFloats>(present);
    for (std::size_t i = 0; i < kSHFloats; ++i)
        row.rhs[i] += pull * before[i];
    row.stencil[kCenter] += pull;
    return true;
}

void GridFit::Solve(LightGridSH &grid, const JobPool &jobs) {
    std::array<std::vector<std::size_t>, kParities> parities;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const auto [x, y, z] = layout_.Coordinates(rows_[i].index);
        if (AddPull(grid.points[rows_[i].index], rows_[i]))
            parities[std::size_t((x & 1) + 2 * (y & 1) + 4 * (z & 1))].push_back(i);
    }
    constexpr std::int64_t kChunk = 256; // rows of one job
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
        float largest = 0;
        for (const auto &rows : parities) {
            const std::int64_t chunks = (std::int64_t(rows.size()) + kChunk - 1) / kChunk;
            std::vector<float> moves(static_cast<std::size_t>(chunks));
            jobs.For(chunks, [&](std::int64_t chunk, int) {
                const std::size_t end = std::min(rows.size(), std::size_t((chunk + 1) * kChunk));
                for (auto i = std::size_t(chunk * kChunk); i < end; ++i)
                    moves[std::size_t(chunk)] = std::max(moves[std::size_t(chunk)], Relax(rows_[rows[i]], grid));
            });
            for (const float move : moves)
                largest = std::max(largest, move);
        }
        if (largest < kSmallMove)
            break;
    }
}

} // namespace q3
