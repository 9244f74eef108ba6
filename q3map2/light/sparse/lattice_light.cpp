// GPL-2.0-or-later. Light at points of the lattice of the sparse SH grid.
#include "q3map2/light/sparse/lattice_light.h"

#include "libs/math/low_discrepancy.h"

#include <algorithm>
#include <bit>

namespace q3 {

namespace {

/// Points traced together: they share a list of lights.
constexpr std::size_t kTraced = 256;

/// Unique for coordinates below 2^21.
std::uint64_t KeyOf(const LatticePoint &p) {
    return std::uint64_t(std::uint32_t(p[0])) | std::uint64_t(std::uint32_t(p[1])) << 21 |
           std::uint64_t(std::uint32_t(p[2])) << 42;
}

/// Puts two zero bits before each of 21 bits.
std::uint64_t Spread(std::int32_t coordinate) {
    std::uint64_t x = std::uint64_t(std::uint32_t(coordinate));
    x = (x | x << 32) & 0x1f00000000ffffull;
    x = (x | x << 16) & 0x1f0000ff0000ffull;
    x = (x | x << 8) & 0x100f00f00f00f00full;
    x = (x | x << 4) & 0x10c30c30c30c30c3ull;
    return (x | x << 2) & 0x1249249249249249ull;
}

/// Morton code: neighbors in this order are neighbors in space.
std::uint64_t MortonOf(const LatticePoint &p) {
    return Spread(p[0]) | Spread(p[1]) << 1 | Spread(p[2]) << 2;
}

} // namespace

std::size_t LatticeLight::SlotOf(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = std::size_t(HashIndex(key)) & mask;
    while (slots_[slot].number != kUnknown && slots_[slot].key != key)
        slot = (slot + 1) & mask;
    return slot;
}

void LatticeLight::Grow() {
    constexpr std::size_t kLeastSlots = 1024;
    if (points_.size() * 2 < slots_.size())
        return;
    slots_.assign(std::max(kLeastSlots, slots_.size() * 4), Slot{});
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const std::uint64_t key = KeyOf(points_[i].at);
        slots_[SlotOf(key)] = {key, std::uint32_t(i)};
    }
}

std::uint32_t LatticeLight::Find(const LatticePoint &at) const {
    return slots_.empty() ? kUnknown : slots_[SlotOf(KeyOf(at))].number;
}

void LatticeLight::Ask(const LatticePoint &at) {
    Grow();
    const std::uint64_t key = KeyOf(at);
    Slot &slot = slots_[SlotOf(key)];
    if (slot.number != kUnknown)
        return;
    slot = {key, std::uint32_t(points_.size())};
    points_.push_back({.at = at});
}

void LatticeLight::Add(const LitPoint &point) {
    Ask(point.at);
    points_.back() = point;
    lit_ = points_.size();
}

std::size_t LatticeLight::Light(GridStats &stats) {
    const std::size_t first = lit_;
    lit_ = points_.size();
    std::vector<std::pair<std::uint64_t, std::uint32_t>> order;
    for (std::size_t i = first; i < lit_; ++i)
        order.push_back({MortonOf(points_[i].at), std::uint32_t(i)});
    std::sort(order.begin(), order.end());
    std::vector<std::uint32_t> numbers;
    for (const auto &[code, number] : order)
        numbers.push_back(number);
    const auto bricks = std::int64_t((numbers.size() + kTraced - 1) / kTraced);
    RunBricks(in_, bricks, stats, [&](std::int64_t brick, GridStats &work) {
        const std::size_t from = std::size_t(brick) * kTraced;
        Trace(std::span(numbers).subspan(from, std::min(kTraced, numbers.size() - from)), work);
    });
    return first;
}

void LatticeLight::Trace(std::span<const std::uint32_t> numbers, GridStats &work) {
    std::vector<ReceiverBatch> blocks;
    std::vector<std::uint32_t> traced;
    for (const std::uint32_t number : numbers) {
        LitPoint &point = points_[number];
        PlacedPoint placed = PlaceInOpen(in_.space, lattice_.PositionOf(point.at));
        if (placed.state != PointState::Open)
            placed = PlaceBeside(in_.space, placed.position);
        point.open = placed.state != PointState::Exterior;
        if (!point.open)
            continue;
        traced.push_back(number);
        BatchWithRoom(blocks).Add(placed.position, placed.position, placed.cluster,
                                  std::uint32_t(HashIndex(KeyOf(point.at))));
    }
    if (blocks.empty())
        return;
    std::size_t next = 0;
    integrator_.Trace(blocks, KeyOf(points_[numbers.front()].at), work,
                      [&](std::uint32_t, const bspGridPointSH_t &value) {
                          points_[traced[next++]].value = std::bit_cast<ShFloats>(value);
                      });
}

} // namespace q3
