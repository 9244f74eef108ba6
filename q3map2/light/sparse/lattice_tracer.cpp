// GPL-2.0-or-later. Traces light at points of the lattice of the sparse SH grid.
#include "q3map2/light/sparse/lattice_tracer.h"

#include "libs/math/low_discrepancy.h"
#include "q3map2/light/sparse/display_error.h"

#include <algorithm>

namespace q3 {

namespace {

/// Points of a brick, which share a list of lights.
constexpr std::size_t kBrickPoints = 256;

/// Inserts two zero bits before each of the lowest 21 bits.
std::uint64_t SpreadBits(std::int32_t coordinate) {
    auto x = std::uint64_t(std::uint32_t(coordinate));
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

} // namespace

std::uint64_t MortonOf(const LatticePoint &p) {
    return SpreadBits(p[0]) | SpreadBits(p[1]) << 1 | SpreadBits(p[2]) << 2;
}

void LatticeTracer::Trace(LatticePoints &points, std::size_t first, GridStats &stats) const {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::size_t i = first; i < points.Size(); ++i)
        order.push_back({MortonOf(points[i].at), std::uint32_t(i)});
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> numbers;
    for (const auto &[code, number] : order)
        numbers.push_back(number);
    const auto bricks = std::int64_t((numbers.size() + kBrickPoints - 1) / kBrickPoints);
    std::vector<GridStats> work(std::size_t(in_.jobs.Threads()));
    in_.jobs.For(bricks, [&](std::int64_t brick, int worker) { // without progress: one of many short passes
        const std::size_t from = std::size_t(brick) * kBrickPoints;
        TraceBrick(points, std::span(numbers).subspan(from, std::min(kBrickPoints, numbers.size() - from)),
                   work[std::size_t(worker)]);
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
        point.open = placed.state != PointState::Exterior;
        if (!point.open)
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
