// GPL-2.0-or-later. A cache of computed records, each file under the hash of what they depend on.
#include "tools/measure/bounce_error/record_cache.h"

#include "common/files/files.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace q3::bounce {

namespace {

/// Header of a cache file. The parts follow in order.
struct RecordHead {
    std::array<char, 64> key; // hexadecimal digits of a SHA-256
    double cpuSeconds;
    std::uint64_t size; // of all parts, bytes
};

std::size_t SizeOf(std::span<const std::span<std::byte>> parts) {
    std::size_t size = 0;
    for (const std::span<std::byte> part : parts)
        size += part.size();
    return size;
}

} // namespace

void AddLights(bench::Hash &hash, std::span<const Light> lights) {
    for (const Light &light : lights) {
        bench::AddLight(hash, light);
        hash.Value(light.envelope), hash.Value(light.endsAtTolerance), hash.Value(light.tolerance);
        hash.Value(light.angleAttenuation), hash.Value(light.angleScale);
    }
}

RecordCache::RecordCache(const std::filesystem::path &folder, const std::string &key, std::string_view extension)
    : key_(key) {
    if (!folder.empty())
        path_ = folder / fmt::format("{}.{}", key, extension);
}

bool RecordCache::Load(std::span<const std::span<std::byte>> parts, double &cpuSeconds) const {
    if (path_.empty() || !std::filesystem::exists(path_))
        return false;
    const std::vector<std::byte> bytes = ReadFile(path_);
    RecordHead head;
    if (bytes.size() != sizeof head + SizeOf(parts))
        return false;
    std::memcpy(&head, bytes.data(), sizeof head);
    if (std::string_view(head.key.data(), head.key.size()) != key_)
        return false;
    cpuSeconds = head.cpuSeconds;
    const std::byte *from = bytes.data() + sizeof head;
    for (const std::span<std::byte> part : parts) {
        std::copy_n(from, part.size(), part.data());
        from += part.size();
    }
    return true;
}

void RecordCache::Store(std::span<const std::span<std::byte>> parts, double cpuSeconds) const {
    if (path_.empty())
        return;
    RecordHead head{{}, cpuSeconds, SizeOf(parts)};
    std::copy_n(key_.data(), std::min(key_.size(), head.key.size()), head.key.data());
    const auto *first = reinterpret_cast<const std::byte *>(&head);
    std::vector<std::byte> bytes(first, first + sizeof head);
    for (const std::span<std::byte> part : parts)
        bytes.insert(bytes.end(), part.begin(), part.end());
    MakeFolder(path_.parent_path());
    ReplaceFile(path_, bytes);
}

} // namespace q3::bounce
