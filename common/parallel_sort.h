// GPL-2.0-or-later. Sorting on all workers.
#pragma once

#include "common/parallel_memory.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace q3 {

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
