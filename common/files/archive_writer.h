// GPL-2.0-or-later. A zip archive (pk3), made entry by entry.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// An archive in memory that is written as a whole. The same entries in the same order give the same bytes: every entry
/// has the date 1980-01-01, the first that zip knows.
class ArchiveWriter {
  public:
    /// zlib's levels: -1 its own choice, 0 stored as it is, 1 fast to 9 small.
    explicit ArchiveWriter(int level);
    ~ArchiveWriter();
    ArchiveWriter(const ArchiveWriter &) = delete;
    ArchiveWriter &operator=(const ArchiveWriter &) = delete;

    void Add(std::string_view name, std::span<const std::byte> data);
    /// The finished archive. To be called once, as the last call.
    std::vector<std::byte> Finish();
    /// Finish, then replaces the file by the archive, or leaves it as it was, and returns the size in bytes. Without it
    /// nothing is written. Errors: Error naming the path.
    std::uint64_t Commit(const std::filesystem::path &path);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3
