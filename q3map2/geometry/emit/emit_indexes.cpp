// GPL-2.0-or-later. Order of triangles for the vertex cache.
#include "q3map2/geometry/emit/emit_indexes.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

constexpr int kWarmHits = 3; // all three vertices are in the cache

/// FIFO of the vertices that entered the cache last, newest first. A hit does not move its entry.
class VertexCache {
  public:
    explicit VertexCache(const std::vector<int> &indexes) { std::copy_n(indexes.begin(), kSize, entries_.begin()); }

    /// Number of entries that the triangle uses. The first indexes fill the cache, repeats included, so a vertex may
    /// count more than once at the start.
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
    std::vector<char> used(indexes.size() / kIndexesPerTriangle, 0);
    std::vector<int> ordered;
    ordered.reserve(indexes.size());
    std::size_t firstFree = 0;
    while (firstFree < used.size()) {
        std::size_t best = firstFree;
        int bestHits = -1;
        for (std::size_t i = firstFree; i < used.size() && bestHits != kWarmHits; ++i)
            if (!used[i])
                if (const int hits = cache.Hits(&indexes[i * kIndexesPerTriangle]); hits > bestHits) {
                    bestHits = hits;
                    best = i;
                }
        used[best] = 1;
        while (firstFree < used.size() && used[firstFree])
            ++firstFree;
        const auto corner = indexes.begin() + std::ptrdiff_t(best * kIndexesPerTriangle);
        std::array<int, kIndexesPerTriangle> triangle{corner[0], corner[1], corner[2]};
        for (const int index : triangle)
            cache.Use(index);
        std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
        ordered.insert(ordered.end(), triangle.begin(), triangle.end());
    }
    return ordered;
}

} // namespace q3
