// GPL-2.0-or-later. Equal runs of draw indexes are stored once.
#include "q3map2/geometry/emit/index_runs.h"

#include "q3map2/geometry/emit/emit_indexes.h"

#include <algorithm>

namespace q3 {
namespace {

constexpr std::size_t kPair = 2 * kIndexesPerTriangle; ///< number of indexes of two triangles

template <typename List> std::uint64_t HashOf(const List &list, std::size_t at, std::size_t count) {
    std::uint64_t hash = 14695981039346656037u;
    for (std::size_t i = 0; i < count; ++i)
        hash = (hash ^ std::uint64_t(std::uint32_t(list[at + i]))) * 1099511628211u;
    return hash;
}

} // namespace

void IndexRuns::HashNewEntries(const std::vector<std::int32_t> &list) {
    for (; hashedTriangles_ + kIndexesPerTriangle <= list.size(); ++hashedTriangles_)
        triangles_[HashOf(list, hashedTriangles_, kIndexesPerTriangle)].push_back(std::int32_t(hashedTriangles_));
    for (; hashedPairs_ + kPair <= list.size(); ++hashedPairs_)
        pairs_[HashOf(list, hashedPairs_, kPair)].push_back(std::int32_t(hashedPairs_));
}

int IndexRuns::FindOrAppend(std::vector<std::int32_t> &list, std::span<const int> run) {
    const int end = int(list.size());
    if (run.size() < kIndexesPerTriangle)
        return end;
    HashNewEntries(list);
    const bool isLong = run.size() >= kPair;
    const auto &offsets = isLong ? pairs_ : triangles_;
    if (const auto found = offsets.find(HashOf(run, 0, isLong ? kPair : kIndexesPerTriangle)); found != offsets.end())
        for (const std::int32_t offset : found->second)
            if (std::size_t(offset) + run.size() <= list.size() &&
                std::equal(run.begin(), run.end(), list.begin() + offset))
                return offset;
    list.insert(list.end(), run.begin(), run.end());
    return end;
}

} // namespace q3
