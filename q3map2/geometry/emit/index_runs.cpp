// GPL-2.0-or-later. Runs of draw indexes that are in the list already.
#include "q3map2/geometry/emit/index_runs.h"

#include <algorithm>

namespace q3 {
namespace {

constexpr std::size_t kTriangle = 3, kPair = 6; ///< indexes

template <typename List> std::uint64_t HashOf(const List &list, std::size_t at, std::size_t count) {
    std::uint64_t hash = 14695981039346656037u;
    for (std::size_t i = 0; i < count; ++i)
        hash = (hash ^ std::uint64_t(std::uint32_t(list[at + i]))) * 1099511628211u;
    return hash;
}

} // namespace

void IndexRuns::Learn(const std::vector<std::int32_t> &list) {
    for (; learnedTriangles_ + kTriangle <= list.size(); ++learnedTriangles_)
        triangles_[HashOf(list, learnedTriangles_, kTriangle)].push_back(std::int32_t(learnedTriangles_));
    for (; learnedPairs_ + kPair <= list.size(); ++learnedPairs_)
        pairs_[HashOf(list, learnedPairs_, kPair)].push_back(std::int32_t(learnedPairs_));
}

int IndexRuns::Place(std::vector<std::int32_t> &list, std::span<const int> run) {
    const int end = int(list.size());
    if (run.size() < kTriangle)
        return end;
    Learn(list);
    const bool isLong = run.size() >= kPair;
    const auto &places = isLong ? pairs_ : triangles_;
    if (const auto found = places.find(HashOf(run, 0, isLong ? kPair : kTriangle)); found != places.end())
        for (const std::int32_t place : found->second)
            if (std::size_t(place) + run.size() <= list.size() &&
                std::equal(run.begin(), run.end(), list.begin() + place))
                return place;
    list.insert(list.end(), run.begin(), run.end());
    return end;
}

} // namespace q3
