// GPL-2.0-or-later. The lattice of the sparse SH grid: positions of its points, and the light that is known there.
#include "q3map2/light/sparse/lattice.h"

#include "common/parallel.h"
#include "libs/math/sampling.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/sparse/display_error.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {

// ---- The lattice ----

namespace {

/// Cells of the uniform grid are halved at most kMaxFineLevels times; for Cubic at most kMaxCubicLevels times, and
/// along longer edges up to kMaxStretch times more.
constexpr int kMaxFineLevels = 2, kMaxCubicLevels = 4, kMaxStretch = 2;
/// The largest cells have edges of 2^kCoarseLevels cells of the uniform grid.
constexpr int kCoarseLevels = 3;

/// How often all edges of a cell can be halved without one below `least`.
int HalvingsDownTo(float least, const Vec3f &size, int most) {
    const float shortest = std::min({size.x, size.y, size.z});
    int halvings = 0;
    while (halvings < most && shortest / float(2 << halvings) >= least)
        ++halvings;
    return halvings;
}

/// The same number of halvings along all axes.
Int3 EqualHalvings(const bspGridSHHeader_t &uniform) {
    const int halvings = HalvingsDownTo(kMinCell, Vec3f(uniform.gridSize), kMaxFineLevels);
    return {halvings, halvings, halvings};
}

} // namespace

SparseLattice::SparseLattice(const bspGridSHHeader_t &uniform) : SparseLattice(uniform, EqualHalvings(uniform)) {}

SparseLattice SparseLattice::Cubic(const bspGridSHHeader_t &uniform) {
    const Vec3f size(uniform.gridSize);
    const float shortest = std::min({size.x, size.y, size.z});
    const int halvings = HalvingsDownTo(kMinCubicCell, size, kMaxCubicLevels);
    Int3 levels{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        levels[axis] = halvings + std::min(kMaxStretch, int(std::lround(std::log2(size[axis] / shortest))));
    return {uniform, levels};
}

SparseLattice::SparseLattice(const bspGridSHHeader_t &uniform, const Int3 &uniformLevel)
    : uniform_(uniform), uniformLevel_(uniformLevel),
      baseLevel_(std::max({uniformLevel[0], uniformLevel[1], uniformLevel[2]})),
      levels_(baseLevel_ + kCoarseLevels + 1) {
    const Vec3f size(uniform.gridSize);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        cell_[axis] = size[axis] / float(1 << uniformLevel_[axis]);
        // One base cell to spare on each side: the world may reach beyond the points of the uniform grid.
        const float root = cell_[axis] * float(1 << levels_), spare = cell_[axis] * float(1 << baseLevel_);
        const float origin = uniform.gridMins[axis], cell = size[axis];
        const auto rootsBefore = std::int32_t(std::floor((origin - spare) / root));
        // The first point of a grid need not be at a multiple of its cell: -shift moves grids.
        first_[axis] = (std::int32_t(std::lround(origin / cell)) << uniformLevel_[axis]) - (rootsBefore << levels_);
        mins_[axis] = origin - cell_[axis] * float(first_[axis]);
        const float end = origin + cell * float(uniform.gridBounds[axis] - 1) + spare;
        roots_[axis] = std::int32_t(std::floor((end - mins_[axis]) / root)) + 1;
    }
}

std::size_t SparseLattice::UniformIndex(const LatticePoint &p) const {
    std::size_t index = 0, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t at = (p[axis] - first_[axis]) >> uniformLevel_[axis];
        index += stride * std::size_t(std::clamp(at, 0, uniform_.gridBounds[axis] - 1));
        stride *= std::size_t(uniform_.gridBounds[axis]);
    }
    return index;
}

// ---- Points of the lattice at which light is known ----

LatticePoints::LatticePoints(const SparseLattice &lattice) {
    std::size_t count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        uniformLevel_[axis] = lattice.UniformLevel(axis);
        uniformSize_[axis] = (lattice.Roots()[axis] << (lattice.Levels() - uniformLevel_[axis])) + 1;
        count *= std::size_t(uniformSize_[axis]);
    }
    uniform_.assign(count, kUnknown);
}

std::size_t LatticePoints::UniformPlace(const LatticePoint &at) const {
    std::size_t place = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
        const std::int32_t i = at[axis] >> uniformLevel_[axis];
        if (i << uniformLevel_[axis] != at[axis] || i < 0 || i >= uniformSize_[axis])
            return kNoPlace;
        place = place * std::size_t(uniformSize_[axis]) + std::size_t(i);
    }
    return place;
}

void LatticePoints::MakeUniform(std::size_t count, const JobPool &jobs) {
    points_.Grow(count, jobs);
    const std::int32_t width = uniformSize_[0], height = uniformSize_[1];
    jobs.For(std::int64_t(height) * uniformSize_[2], [&](std::int64_t row, int) {
        const auto y = std::int32_t(row % height), z = std::int32_t(row / height);
        for (std::int32_t x = 0; x < width; ++x)
            if (const std::uint32_t number = uniform_[std::size_t(row) * std::size_t(width) + std::size_t(x)];
                number != kUnknown)
                points_[number].at = {x << uniformLevel_[0], y << uniformLevel_[1], z << uniformLevel_[2]};
    });
}

std::uint32_t LatticePoints::HashOf(const LatticePoint &at) {
    return std::uint32_t(HashIndex(KeyOf(at)));
}

void LatticePoints::Insert(const Slot &inserted) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = inserted.hash & mask;
    while (slots_[slot].number != kUnknown)
        slot = (slot + 1) & mask;
    slots_[slot] = inserted;
}

void LatticePoints::GrowIfFull() {
    constexpr std::size_t kMinSlots = 1024;
    if (hashed_ * 2 < slots_.size())
        return;
    const std::vector<Slot> old = std::exchange(slots_, {});
    slots_.assign(std::max(kMinSlots, old.size() * 2), Slot{});
    for (const Slot &slot : old)
        if (slot.number != kUnknown)
            Insert(slot);
}

std::uint32_t LatticePoints::Find(const LatticePoint &at) const {
    if (const std::size_t place = UniformPlace(at); place != kNoPlace)
        return uniform_[place];
    if (slots_.empty())
        return kUnknown;
    const std::uint32_t hash = HashOf(at);
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash & mask;
    while (slots_[slot].number != kUnknown && (slots_[slot].hash != hash || points_[slots_[slot].number].at != at))
        slot = (slot + 1) & mask;
    return slots_[slot].number;
}

std::uint32_t LatticePoints::Add(const LatticePoint &at) {
    const std::uint32_t known = Find(at);
    if (known != kUnknown)
        return known;
    const auto number = std::uint32_t(points_.Size());
    points_.Add({.at = at});
    if (const std::size_t place = UniformPlace(at); place != kNoPlace) {
        uniform_[place] = number;
        return number;
    }
    GrowIfFull();
    Insert({HashOf(at), number});
    ++hashed_;
    return number;
}

// ---- Traces light at points of the lattice ----

namespace {

/// Points of a brick, which share a list of lights.
constexpr std::size_t kBrickPoints = 256;

} // namespace

void LatticeTracer::Trace(LatticePoints &points, std::size_t first, GridStats &stats) const {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    ReserveInParallel(points.Size() - first, in_.jobs, order);
    for (std::size_t i = first; i < points.Size(); ++i)
        order.push_back({MortonOf(points[i].at), std::uint32_t(i)});
    SortInParallel(order, in_.jobs);
    const auto bricks = std::int64_t((order.size() + kBrickPoints - 1) / kBrickPoints);
    std::vector<GridStats> work(std::size_t(in_.jobs.Threads()));
    in_.jobs.For(bricks, [&](std::int64_t brick, int worker) { // without progress: one of many short passes
        const std::size_t from = std::size_t(brick) * kBrickPoints, end = std::min(order.size(), from + kBrickPoints);
        std::vector<std::uint32_t> numbers;
        for (std::size_t i = from; i < end; ++i)
            numbers.push_back(order[i].second);
        TraceBrick(points, numbers, work[std::size_t(worker)]);
    });
    for (const GridStats &part : work)
        stats.Add(part);
}

void LatticeTracer::TraceBrick(LatticePoints &points, std::span<const std::uint32_t> numbers, GridStats &work) const {
    std::vector<ProbeReceiver> receivers;
    std::vector<std::uint32_t> traced;
    for (const std::uint32_t number : numbers) {
        LatticeSample &point = points[number];
        PlacedPoint placed = PlaceInOpen(in_.space, lattice_.PositionOf(point.at));
        if (placed.state != PointState::Open)
            placed = PlaceBeside(in_.space, placed.position);
        point.traced = placed.state != PointState::Exterior;
        if (!point.traced)
            continue;
        traced.push_back(number);
        receivers.push_back({placed.position, placed.cluster, std::uint32_t(HashIndex(KeyOf(point.at)))});
    }
    if (receivers.empty())
        return;
    const auto values = light_.At(receivers, KeyOf(points[numbers.front()].at), work);
    for (std::size_t i = 0; i < values.size(); ++i)
        points[traced[i]].value = ToDisplayed(values[i], in_.options.shRadiance);
}

} // namespace q3
