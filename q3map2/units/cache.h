// GPL-2.0-or-later. -cache: results of earlier runs in a folder.
#pragma once

#include "common/log.h"
#include "q3map2/units/unit_file.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace q3 {

/// The folder that `-cache default` means: q3map2-sh in the user's folder for caches (XDG_CACHE_HOME, else ~/.cache; on
/// Windows the local application data).
std::filesystem::path DefaultCacheFolder();

/// Entries, each a file named by the hash of its key. A file is written as a whole, so several programs may use a
/// folder at once. An entry that is damaged counts as missing and is removed. The entries that were not used for the
/// longest time are removed when all together are larger than the limit.
class Cache {
  public:
    /// maxBytes: limit of the size of all entries.
    Cache(std::filesystem::path folder, std::uint64_t maxBytes, Log &log);

    std::optional<UnitFile> Read(const Hash128 &key) const;
    /// A failure is a warning, since the result is there in any case.
    void Write(const Hash128 &key, const UnitFile &file) const;

  private:
    std::filesystem::path PathOf(const Hash128 &key) const;
    void Trim() const;

    std::filesystem::path folder_;
    std::uint64_t maxBytes_;
    Log *log_; ///< so that a Cache can be assigned
};

} // namespace q3
