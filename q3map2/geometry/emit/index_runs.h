// GPL-2.0-or-later. The list of draw indexes, where equal runs are stored once.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Finds where a run of indexes already is in a list.
class IndexRuns {
  public:
    /// First place in `list` of that run, which is appended when it is nowhere. An empty run: the end of the list.
    int Place(std::vector<std::int32_t> &list, std::span<const int> run);

  private:
    void Learn(const std::vector<std::int32_t> &list);

    /// Places by a hash of the indexes that start there, in order.
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> triangles_, pairs_;
    std::size_t learnedTriangles_ = 0, learnedPairs_ = 0;
};

} // namespace q3
