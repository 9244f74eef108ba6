// GPL-2.0-or-later. Loops over many small indices, memory of large vectors, and sorting, on all workers of a pool.
#pragma once

#include "common/jobs.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace q3 {

/// Calls use(i) for i from 0 to count - 1. `jobSize`: indices that a worker takes at once, in ascending order.
template <typename Use> void ForAll(const JobPool &jobs, std::size_t count, std::size_t jobSize, const Use &use) {
    jobs.For(std::int64_t((count + jobSize - 1) / jobSize), [&](std::int64_t job, int) {
        const std::size_t first = std::size_t(job) * jobSize, end = std::min(count, first + jobSize);
        for (std::size_t i = first; i < end; ++i)
            use(i);
    });
}

/// Reserves memory for `count` values in an empty vector. The system clears memory when it is first used, which takes
/// longer than to fill it, so each worker uses a part of it here.
template <typename T> void ReserveInParallel(std::size_t count, const JobPool &jobs, std::vector<T> &values) {
    constexpr std::size_t kPart = std::size_t(2) << 20, kPage = 4096; // bytes; of a large and of a small page
    values.reserve(count);
    auto *const memory = reinterpret_cast<volatile char *>(values.data());
    const std::size_t size = count * sizeof(T);
    jobs.For(std::int64_t((size + kPart - 1) / kPart), [&](std::int64_t part, int) {
        const std::size_t first = std::size_t(part) * kPart;
        for (std::size_t at = first; at < std::min(size, first + kPart); at += kPage)
            memory[at] = 0;
    });
}

/// A vector of `count` values T().
template <typename T> std::vector<T> VectorInParallel(std::size_t count, const JobPool &jobs) {
    std::vector<T> values;
    ReserveInParallel(count, jobs, values);
    values.resize(count);
    return values;
}

/// A vector in chunks of equal size: it grows without copies, its values stay where they are, and memory for less than
/// a chunk of them is not used.
template <typename T> class ChunkedVector {
  public:
    std::size_t Size() const { return size_; }
    T &operator[](std::size_t i) { return chunks_[i / kChunk][i % kChunk]; }
    const T &operator[](std::size_t i) const { return chunks_[i / kChunk][i % kChunk]; }
    /// Allocates and clears the chunks of `count` values in all, on all workers.
    void Reserve(std::size_t count, const JobPool &jobs) {
        const std::size_t before = chunks_.size(), needed = (count + kChunk - 1) / kChunk;
        chunks_.resize(std::max(before, needed));
        ForAll(jobs, chunks_.size() - before, 1, [&](std::size_t i) { chunks_[before + i].resize(kChunk); });
    }
    /// Appends values T() until there are `count`.
    void Grow(std::size_t count, const JobPool &jobs) {
        Reserve(count, jobs);
        size_ = std::max(size_, count);
    }
    void Add(const T &value) {
        if (size_ == chunks_.size() * kChunk)
            chunks_.emplace_back(kChunk);
        (*this)[size_++] = value;
    }

  private:
    /// About 128 KiB.
    static constexpr std::size_t kChunk = std::bit_floor((std::size_t(128) << 10) / sizeof(T));
    std::vector<std::vector<T>> chunks_; ///< each of kChunk values, T() from number size_ on
    std::size_t size_ = 0;
};

/// The length of the part of `a` that is among the first `count` values when `a` and `b`, both sorted, are merged.
template <typename T, typename Less>
std::size_t CountOfFirstMerged(std::span<const T> a, std::span<const T> b, std::size_t count, const Less &less) {
    std::size_t low = count - std::min(count, b.size()), high = std::min(count, a.size());
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (less(b[count - middle - 1], a[middle]))
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

/// Sorts values by an order in which no two different ones are equal, so that the result is the same for any number of
/// workers: these sort runs, then merge pairs of runs, each in several parts at the same time.
template <typename T, typename Less = std::less<>>
void SortInParallel(std::vector<T> &values, const JobPool &jobs, const Less &less = {}) {
    const std::size_t runs = std::bit_ceil(std::size_t(jobs.Threads()));
    const auto from = [&](std::size_t run) { return values.size() * run / runs; };
    jobs.For(std::int64_t(runs), [&](std::int64_t run, int) {
        T *const all = values.data();
        std::sort(all + from(std::size_t(run)), all + from(std::size_t(run) + 1), less);
    });
    std::vector<T> merged = VectorInParallel<T>(runs > 1 ? values.size() : 0, jobs);
    for (std::size_t width = 1; width < runs; width *= 2, values.swap(merged))
        jobs.For(std::int64_t(runs), [&](std::int64_t part, int) {
            const auto first = std::size_t(part) / (2 * width) * (2 * width); // run of the pair
            const std::size_t start = from(first), middle = from(first + width), end = from(first + 2 * width);
            const std::span<const T> all(values), a = all.subspan(start, middle - start),
                                                  b = all.subspan(middle, end - middle);
            const std::size_t low = from(std::size_t(part)) - start, high = from(std::size_t(part) + 1) - start;
            const std::size_t lowA = CountOfFirstMerged(a, b, low, less), highA = CountOfFirstMerged(a, b, high, less);
            const auto partOfA = a.subspan(lowA, highA - lowA);
            const auto partOfB = b.subspan(low - lowA, high - highA - (low - lowA));
            std::merge(partOfA.begin(), partOfA.end(), partOfB.begin(), partOfB.end(), merged.data() + start + low,
                       less);
        });
}

} // namespace q3
