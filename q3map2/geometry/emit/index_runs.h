// GPL-2.0-or-later. Equal runs of draw indexes are stored once.
#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace q3 {

/// Hash table of the runs of indexes in a list.
class IndexRuns {
  public:
    /// Offset of the first occurrence of the run in `list`; if there is none, the run is appended. The end of the list
    /// for fewer than three indexes.
    int FindOrAppend(std::vector<std::int32_t> &list, std::span<const int> run);

  private:
    void HashNewEntries(const std::vector<std::int32_t> &list);

    /// Hash of the three (triangles_) or six (pairs_) indexes at an offset, to all such offsets in ascending order.
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> triangles_, pairs_;
    std::size_t hashedTriangles_ = 0, hashedPairs_ = 0;
};

} // namespace q3
