// GPL-2.0-or-later. Results of units of work that need not be computed again.
#include "q3map2/units/unit_store.h"

#include "common/error.h"

#include <algorithm>
#include <atomic>
#include <numeric>

namespace q3 {

void UnitStore::Load(std::span<const UnitResult> results, MappedFile storage, const Hash128 &inputs) {
    storage_.push_back(std::move(storage));
    loadedInputs_ = inputs;
    inputs_ = inputs;
    loaded_.reserve(loaded_.size() + results.size());
    for (const UnitResult &one : results)
        loaded_.try_emplace(one.key, Loaded{one.bytes});
}

void UnitStore::Begin(const Hash128 &inputs) {
    inputs_ = inputs;
    if (loaded_.empty() || loadedInputs_ == inputs)
        return;
    if (!IsCache())
        throw Error("the files of -join are of another map, other options, other game files or another version of the "
                    "program: their inputs have the hash {}, but those here {}",
                    loadedInputs_.Text(), inputs.Text());
    loaded_.clear();
}

std::optional<std::span<const std::byte>> UnitStore::Find(const Hash128 &key) const {
    const auto found = loaded_.find(key);
    if (found == loaded_.end())
        return std::nullopt;
    std::atomic_ref(found->second.isUsed).store(1, std::memory_order_relaxed);
    return found->second.bytes;
}

std::optional<std::span<const std::byte>> UnitStore::TakeLoaded(const Hash128 &key) {
    const auto found = loaded_.find(key);
    if (found == loaded_.end())
        return std::nullopt;
    const std::span<const std::byte> bytes = found->second.bytes;
    loaded_.erase(found);
    return bytes;
}

void UnitStore::Keep(const Hash128 &key, std::vector<std::byte> bytes) {
    Shard &shard = shards_[std::size_t(key.high) % kShards];
    const std::lock_guard lock(shard.mutex);
    shard.kept.emplace_back(key, std::move(bytes));
}

std::vector<UnitResult> UnitStore::Kept() const {
    std::vector<UnitResult> results;
    for (Shard &shard : shards_) {
        const std::lock_guard lock(shard.mutex);
        for (const auto &[key, bytes] : shard.kept)
            results.push_back({key, bytes});
    }
    std::ranges::sort(results, {}, &UnitResult::key);
    return results;
}

std::vector<UnitResult> UnitStore::Used() const {
    std::vector<UnitResult> results = Kept();
    for (const auto &[key, one] : loaded_)
        if (!IsCache() || one.isUsed != 0)
            results.push_back({key, one.bytes});
    std::ranges::sort(results, {}, &UnitResult::key);
    const auto hasSameKey = [](const UnitResult &a, const UnitResult &b) { return a.key == b.key; };
    results.erase(std::unique(results.begin(), results.end(), hasSameKey), results.end());
    return results;
}

bool UnitStore::HasChanged() const {
    return KeptCount() > 0 || FoundCount() < loaded_.size();
}

void UnitStore::Clear() {
    loaded_.clear();
    for (Shard &shard : shards_) {
        const std::lock_guard lock(shard.mutex);
        shard.kept.clear();
    }
}

std::size_t UnitStore::FoundCount() const {
    return std::size_t(std::ranges::count_if(loaded_, [](const auto &one) { return one.second.isUsed != 0; }));
}

std::size_t UnitStore::KeptCount() const {
    std::size_t count = 0;
    for (Shard &shard : shards_) {
        const std::lock_guard lock(shard.mutex);
        count += shard.kept.size();
    }
    return count;
}

// ---- The units of a part ----

namespace {

/// Unit i goes to the part in whose share of the total cost the middle of the unit is.
std::vector<int> DivideInRanges(std::span<const double> costs, int count) {
    const double total = std::accumulate(costs.begin(), costs.end(), 0.0);
    std::vector<int> parts(costs.size());
    double before = 0;
    for (std::size_t i = 0; i < costs.size(); ++i) {
        const double middle = before + costs[i] / 2;
        parts[i] = total > 0 ? std::min(count - 1, int(middle / total * count)) : 0;
        before += costs[i];
    }
    return parts;
}

/// The largest first, each to the part that has least.
std::vector<int> DivideBySize(std::span<const double> costs, int count) {
    std::vector<std::size_t> order(costs.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::ranges::stable_sort(order, std::greater(), [&](std::size_t i) { return costs[i]; });
    std::vector<int> parts(costs.size());
    std::vector<double> sums(std::size_t(count), 0.0);
    for (const std::size_t i : order) {
        const auto least = std::ranges::min_element(sums);
        parts[i] = int(least - sums.begin());
        *least += costs[i];
    }
    return parts;
}

} // namespace

std::vector<int> DivideUnits(std::span<const double> costs, int count, UnitStore::Division division) {
    return division == UnitStore::Division::Ranges ? DivideInRanges(costs, count) : DivideBySize(costs, count);
}

std::vector<std::uint8_t> UnitStore::Own(std::span<const double> costs, Division division) const {
    std::vector<std::uint8_t> own(costs.size(), 1);
    if (!part_)
        return own;
    const std::vector<int> parts = DivideUnits(costs, part_->count, division);
    for (std::size_t i = 0; i < own.size(); ++i)
        own[i] = parts[i] == part_->number - 1 ? 1 : 0;
    return own;
}

} // namespace q3
