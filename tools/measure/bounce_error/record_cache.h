// GPL-2.0-or-later. A cache of computed records, each file under the hash of what they depend on.
#pragma once

#include "tools/measure/shbench/map_hash.h"

#include <filesystem>
#include <span>
#include <string>

namespace q3::bounce {

/// Adds what the references take of lights from SetupEnvelopes to a hash.
void AddLights(bench::Hash &hash, std::span<const Light> lights);

/// A file of records and the CPU seconds that they took.
class RecordCache {
  public:
    /// folder: of the files; empty: nothing is kept. key: 64 hexadecimal digits of bench::Hash.
    RecordCache(const std::filesystem::path &folder, const std::string &key, std::string_view extension);

    /// Fills the parts, whose sizes must be known, from the file. False if there is none for the key and sizes.
    bool Load(std::span<const std::span<std::byte>> parts, double &cpuSeconds) const;
    /// Writes the file. Errors: the folder cannot be written.
    void Store(std::span<const std::span<std::byte>> parts, double cpuSeconds) const;

  private:
    std::filesystem::path path_; // empty: nothing is kept
    std::string key_;
};

/// The bytes of records, a part of a file.
template <typename T> std::span<std::byte> RecordBytes(std::vector<T> &records) {
    static_assert(std::is_trivially_copyable_v<T>);
    return std::as_writable_bytes(std::span(records));
}

} // namespace q3::bounce
