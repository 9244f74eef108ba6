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
    /// Offset of the first occurrence of the run in `list`; a run that does not occur is appended. For an empty run,
    /// the end of the list.
    int FindOrAppend(std::vector<std::int32_t> &list, std::span<const int> run);

  private:
    void HashNewEntries(const std::vector<std::int32_t> &list);

    /// Offsets by the hash of the three or six indexes that start there, ascending.
    std::unordered_map<std::uint64_t, std::vector<std::int32_t>> triangles_, pairs_;
    std::size_t hashedTriangles_ = 0, hashedPairs_ = 0;
};

} // namespace q3
