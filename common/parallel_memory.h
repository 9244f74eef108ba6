// GPL-2.0-or-later. Memory of large vectors that all workers help to get from the system.
#pragma once

#include "common/jobs.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace q3 {

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

/// Makes room for at least `count` values in all. A vector that grows again and again takes half as much more each
/// time.
template <typename T> void GrowInParallel(std::size_t count, const JobPool &jobs, std::vector<T> &values) {
    if (count <= values.capacity())
        return;
    std::vector<T> larger;
    ReserveInParallel(std::max(count, values.size() + values.size() / 2), jobs, larger);
    larger.insert(larger.end(), values.begin(), values.end());
    values = std::move(larger);
}

/// A vector of `count` values T().
template <typename T> std::vector<T> VectorInParallel(std::size_t count, const JobPool &jobs) {
    std::vector<T> values;
    ReserveInParallel(count, jobs, values);
    values.resize(count);
    return values;
}

} // namespace q3
