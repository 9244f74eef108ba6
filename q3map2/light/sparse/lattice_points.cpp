// GPL-2.0-or-later. The points of the lattice of the sparse SH grid at which light is known.
#include "q3map2/light/sparse/lattice_points.h"

#include "libs/math/low_discrepancy.h"

#include <algorithm>
#include <utility>

namespace q3 {

LatticePoints::LatticePoints(const SparseLattice &lattice) {
    std::size_t count = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        uniformLevel_[axis] = lattice.UniformLevel(axis);
        uniformSize_[axis] = (lattice.Roots()[axis] << (lattice.Levels() - uniformLevel_[axis])) + 1;
        count *= std::size_t(uniformSize_[axis]);
    }
    uniform_.assign(count, kUnknown);
}

const std::uint32_t *LatticePoints::UniformNumber(const LatticePoint &at) const {
    std::size_t place = 0;
    for (std::size_t axis = 3; axis-- > 0;) {
        const std::int32_t i = at[axis] >> uniformLevel_[axis];
        if (i << uniformLevel_[axis] != at[axis] || i < 0 || i >= uniformSize_[axis])
            return nullptr;
        place = place * std::size_t(uniformSize_[axis]) + std::size_t(i);
    }
    return &uniform_[place];
}

std::size_t LatticePoints::SlotOf(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = std::size_t(HashIndex(key)) & mask;
    while (slots_[slot].number != kUnknown && slots_[slot].key != key)
        slot = (slot + 1) & mask;
    return slot;
}

void LatticePoints::GrowIfFull() {
    constexpr std::size_t kMinSlots = 1024;
    if (hashed_ * 2 < slots_.size())
        return;
    const std::vector<Slot> old = std::exchange(slots_, {});
    slots_.assign(std::max(kMinSlots, old.size() * 4), Slot{});
    for (const Slot &slot : old)
        if (slot.number != kUnknown)
            slots_[SlotOf(slot.key)] = slot;
}

std::uint32_t LatticePoints::Find(const LatticePoint &at) const {
    if (const std::uint32_t *number = UniformNumber(at))
        return *number;
    return slots_.empty() ? kUnknown : slots_[SlotOf(KeyOf(at))].number;
}

std::uint32_t LatticePoints::Add(const LatticePoint &at) {
    const std::uint32_t known = Find(at);
    if (known != kUnknown)
        return known;
    const auto number = std::uint32_t(points_.size());
    points_.push_back({.at = at});
    if (const std::uint32_t *place = UniformNumber(at)) {
        uniform_[std::size_t(place - uniform_.data())] = number;
        return number;
    }
    GrowIfFull();
    const std::uint64_t key = KeyOf(at);
    slots_[SlotOf(key)] = {key, number};
    ++hashed_;
    return number;
}

} // namespace q3
