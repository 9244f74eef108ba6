// GPL-2.0-or-later. Light at points of the lattice of the sparse SH grid.
#include "q3map2/light/sparse/lattice_points.h"

#include "libs/math/low_discrepancy.h"

#include <algorithm>

namespace q3 {

std::size_t LatticePoints::SlotOf(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = std::size_t(HashIndex(key)) & mask;
    while (slots_[slot].number != kUnknown && slots_[slot].key != key)
        slot = (slot + 1) & mask;
    return slot;
}

void LatticePoints::Grow() {
    constexpr std::size_t kLeastSlots = 1024;
    if (points_.size() * 2 < slots_.size())
        return;
    slots_.assign(std::max(kLeastSlots, slots_.size() * 4), Slot{});
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const std::uint64_t key = KeyOf(points_[i].at);
        slots_[SlotOf(key)] = {key, std::uint32_t(i)};
    }
}

std::uint32_t LatticePoints::Find(const LatticePoint &at) const {
    return slots_.empty() ? kUnknown : slots_[SlotOf(KeyOf(at))].number;
}

std::uint32_t LatticePoints::Add(const LatticePoint &at) {
    Grow();
    const std::uint64_t key = KeyOf(at);
    Slot &slot = slots_[SlotOf(key)];
    if (slot.number == kUnknown) {
        slot = {key, std::uint32_t(points_.size())};
        points_.push_back({.at = at});
    }
    return slot.number;
}

} // namespace q3
