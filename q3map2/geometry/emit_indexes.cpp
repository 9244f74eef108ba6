// GPL-2.0-or-later. Draw indexes: order of triangles, and runs that are there already.
#include "q3map2/geometry/emit.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

constexpr std::size_t kTriangle = 3, kPair = 6; // indexes
constexpr int kWarmHits = 3;                    // all that a triangle can have once every vertex is in the cache once

template <typename List> std::uint64_t HashOf(const List &list, std::size_t at, std::size_t count) {
    std::uint64_t hash = 14695981039346656037u;
    for (std::size_t i = 0; i < count; ++i)
        hash = (hash ^ std::uint64_t(std::uint32_t(list[at + i]))) * 1099511628211u;
    return hash;
}

/// What was used last, newest first.
class VertexCache {
  public:
    explicit VertexCache(const std::vector<int> &indexes) { std::copy_n(indexes.begin(), kSize, entries_.begin()); }

    /// Entries that the triangle uses. At the start there are several for one vertex: well-connected ones come first.
    int Hits(const int *triangle) const {
        return int(std::count_if(entries_.begin(), entries_.end(), [&](int entry) {
            return entry == triangle[0] || entry == triangle[1] || entry == triangle[2];
        }));
    }
    void Use(int index) {
        if (Holds(index))
            return;
        std::rotate(entries_.begin(), entries_.end() - 1, entries_.end());
        entries_.front() = index;
    }

    static constexpr std::size_t kSize = 16;

  private:
    bool Holds(int index) const { return std::find(entries_.begin(), entries_.end(), index) != entries_.end(); }

    std::array<int, kSize> entries_{};
};

} // namespace

std::vector<int> OrderTriangles(const std::vector<int> &indexes) {
    if (indexes.size() <= VertexCache::kSize)
        return indexes;
    VertexCache cache(indexes);
    std::vector<char> used(indexes.size() / kTriangle, 0);
    std::vector<int> ordered;
    ordered.reserve(indexes.size());
    std::size_t firstFree = 0;
    while (firstFree < used.size()) {
        std::size_t best = firstFree;
        int bestHits = -1;
        for (std::size_t i = firstFree; i < used.size() && bestHits != kWarmHits; ++i)
            if (!used[i])
                if (const int hits = cache.Hits(&indexes[i * kTriangle]); hits > bestHits) {
                    bestHits = hits;
                    best = i;
                }
        used[best] = 1;
        while (firstFree < used.size() && used[firstFree])
            ++firstFree;
        const auto corner = indexes.begin() + std::ptrdiff_t(best * kTriangle);
        std::array<int, kTriangle> triangle{corner[0], corner[1], corner[2]};
        for (const int index : triangle)
            cache.Use(index);
        std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
        ordered.insert(ordered.end(), triangle.begin(), triangle.end());
    }
    return ordered;
}

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
