// GPL-2.0-or-later. -cache: results of earlier runs in a folder.
#include "q3map2/units/cache.h"

#include "common/error.h"
#include "common/files/files.h"

#include <algorithm>
#include <chrono>
#include <glib.h>
#include <system_error>
#include <utility>
#include <vector>

namespace q3 {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kExtension = ".q3c";
/// After removing entries, their sizes add up to at most this part of the limit, so that not every run removes some.
constexpr double kTrimmedFraction = 0.9;
/// Older unfinished entries are of programs that were killed.
constexpr auto kUnfinishedAge = std::chrono::hours(24);

} // namespace

fs::path DefaultCacheFolder() {
    return fs::path(g_get_user_cache_dir()) / "q3map2-sh";
}

Cache::Cache(fs::path folder, std::uint64_t maxBytes, Log &log)
    : folder_(std::move(folder)), maxBytes_(maxBytes), log_(&log) {
    RequireFolder(folder_);
}

fs::path Cache::PathOf(const Hash128 &key) const {
    const std::string name = key.Text();
    return folder_ / name.substr(0, 2) / (name + std::string(kExtension));
}

std::optional<UnitFile> Cache::Read(const Hash128 &key) const {
    const fs::path path = PathOf(key);
    std::error_code failed;
    if (!fs::is_regular_file(path, failed))
        return std::nullopt;
    try {
        UnitFile file = ReadUnitFile(path);
        fs::last_write_time(path, fs::file_time_type::clock::now(), failed); // used now
        return file;
    } catch (const Error &error) {
        log_->Warn("cache", "-cache: an entry is not used, and removed: {}", error.what());
        fs::remove(path, failed);
        return std::nullopt;
    }
}

void Cache::Write(const Hash128 &key, const UnitFile &file) const {
    try {
        MakeFolder(PathOf(key).parent_path());
        WriteUnitFile(PathOf(key), file);
    } catch (const Error &error) {
        log_->Warn("cache", "-cache: the results of this run are not kept: {}", error.what());
    }
    try {
        Trim();
    } catch (const Error &error) {
        log_->Warn("cache", "-cache: old entries are not removed: {}", error.what());
    }
}

void Cache::Trim() const {
    struct Entry {
        fs::path path;
        fs::file_time_type used;
        std::uint64_t bytes;
    };
    std::vector<Entry> entries;
    std::uint64_t total = 0;
    std::error_code failed;
    const auto now = fs::file_time_type::clock::now();
    const auto look = [&](const fs::path &path) {
        std::error_code gone; // another program may have removed it
        if (!fs::is_regular_file(path, gone))
            return;
        const bool isUnfinished = TargetOfUnfinished(path.filename().string()).ends_with(kExtension);
        if (isUnfinished && now - fs::last_write_time(path, gone) > kUnfinishedAge && !gone)
            fs::remove(path, gone);
        if (path.extension() != kExtension)
            return;
        const Entry entry{path, fs::last_write_time(path, gone), fs::file_size(path, gone)};
        if (gone)
            return;
        total += entry.bytes;
        entries.push_back(entry);
    };
    for (const fs::path &folder : EntriesOf(folder_)) // as PathOf has them
        for (const fs::path &path : EntriesOf(folder))
            look(path);
    if (total <= maxBytes_)
        return;
    std::ranges::sort(entries, {}, &Entry::used);
    for (const Entry &entry : entries) {
        if (double(total) <= kTrimmedFraction * double(maxBytes_))
            return;
        fs::remove(entry.path, failed);
        total -= entry.bytes;
    }
}

} // namespace q3
