// GPL-2.0-or-later. The game's files: folders and pk3 archives as one tree.
#include "common/files/vfs.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text_scan.h"

#include <algorithm>
#include <set>
#include <system_error>

namespace q3 {

namespace fs = std::filesystem;

namespace {

/// ? is one character and * any run; neither crosses a separator. Case-insensitive.
bool MatchesWildcard(std::string_view name, std::string_view pattern) {
    const auto separator = [](char c) { return c == '/' || c == '\\' || c == ':'; };
    std::size_t n = 0, p = 0, starPattern = std::string_view::npos, starName = 0;
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            starPattern = p++;
            starName = n;
        } else if (p < pattern.size() && ((pattern[p] == '?' && !separator(name[n])) ||
                                          EqualNoCase(pattern.substr(p, 1), name.substr(n, 1)))) {
            ++p;
            ++n;
        } else if (starPattern != std::string_view::npos && !separator(name[starName])) {
            p = starPattern + 1;
            n = ++starName;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

bool LessWithoutCase(const std::string &a, const std::string &b) {
    const std::string lowerA = LowerCase(a), lowerB = LowerCase(b);
    return lowerA != lowerB ? lowerA < lowerB : a < b;
}

/// File name of a folder, also when the path ends in a slash.
std::string LastPart(const fs::path &folder) {
    return folder.has_filename() ? folder.filename().string() : folder.parent_path().filename().string();
}

} // namespace

struct VirtualFileSystem::State {
    Log &log;
    std::vector<std::string> forbidden;
    std::vector<fs::path> folders;   ///< the winner first
    std::vector<Archive> archives{}; ///< the winner first

    bool IsForbidden(std::string_view name) const {
        return std::any_of(forbidden.begin(), forbidden.end(),
                           [&](const std::string &pattern) { return MatchesWildcard(name, pattern); });
    }
    void MountArchive(const fs::path &path);
    /// Calls use(path) or use(archive) for each occurrence of a safe name, the winner first, until one returns true.
    template <typename UsePath, typename UseArchive>
    void Visit(const std::string &name, UsePath usePath, UseArchive useArchive) const;
    enum class Occurrences { First, All };
    /// Contents of every occurrence, or of the first readable one. Unreadable ones give a warning.
    std::vector<std::vector<std::byte>> Contents(std::string_view name, Occurrences wanted) const;
};

void VirtualFileSystem::State::MountArchive(const fs::path &path) {
    try {
        archives.emplace_back(path);
    } catch (const Error &error) {
        log.Warn("unreadable archive", "{}", error.what());
    } catch (const fs::filesystem_error &error) {
        log.Warn("unreadable archive", "{}", error.what());
    }
}

template <typename UsePath, typename UseArchive>
void VirtualFileSystem::State::Visit(const std::string &name, UsePath usePath, UseArchive useArchive) const {
    if (name.empty())
        return;
    for (const fs::path &folder : folders) {
        const fs::path path = folder / PathOf(name);
        std::error_code absent;
        if (fs::is_regular_file(path, absent) && usePath(path))
            return;
    }
    for (const Archive &archive : archives)
        if (archive.Contains(name) && useArchive(archive))
            return;
}

std::vector<std::vector<std::byte>> VirtualFileSystem::State::Contents(std::string_view name,
                                                                       Occurrences wanted) const {
    std::vector<std::vector<std::byte>> found;
    const auto take = [&](auto read) {
        try {
            found.push_back(read());
        } catch (const Error &error) {
            log.Warn("unreadable game file", "{}", error.what());
        }
        return wanted == Occurrences::First && !found.empty();
    };
    const std::string safe = SafeName(name);
    Visit(
        safe, [&](const fs::path &path) { return take([&] { return ReadFile(path); }); },
        [&](const Archive &archive) { return take([&] { return archive.Read(safe); }); });
    return found;
}

VirtualFileSystem::VirtualFileSystem(Log &log) : state_(new State{.log = log, .forbidden = {}, .folders = {}}) {}
VirtualFileSystem::~VirtualFileSystem() = default;
VirtualFileSystem::VirtualFileSystem(VirtualFileSystem &&) noexcept = default;

void VirtualFileSystem::SetForbidden(std::vector<std::string> patterns) {
    state_->forbidden = std::move(patterns);
}

void VirtualFileSystem::Mount(const fs::path &folder, std::string_view archiveExtension) {
    if (state_->IsForbidden(LastPart(folder)))
        return;
    state_->log.Print("VFS Init: {}\n", folder.string());
    const std::string archiveEnd = fmt::format(".{}", archiveExtension), folderEnd = archiveEnd + "dir";
    std::vector<std::string> archives, packFolders;
    std::error_code failed;
    for (fs::directory_iterator at(folder, failed), end; !failed && at != end; at.increment(failed)) {
        std::string name = at->path().filename().string();
        if (state_->IsForbidden(name))
            continue;
        std::error_code unknown;
        if (EndsWithNoCase(name, archiveEnd))
            archives.push_back(std::move(name));
        else if (EndsWithNoCase(name, folderEnd) && at->is_directory(unknown))
            packFolders.push_back(std::move(name));
    }
    std::sort(archives.begin(), archives.end(), LessWithoutCase);
    std::sort(packFolders.begin(), packFolders.end(), LessWithoutCase);

    state_->folders.push_back(folder);
    for (auto name = packFolders.rbegin(); name != packFolders.rend(); ++name)
        state_->folders.push_back(folder / *name);
    for (auto name = archives.rbegin(); name != archives.rend(); ++name)
        state_->MountArchive(folder / *name);
}

std::optional<std::vector<std::byte>> VirtualFileSystem::Read(std::string_view name) const {
    auto found = state_->Contents(name, State::Occurrences::First);
    if (found.empty())
        return std::nullopt;
    return std::move(found.front());
}

std::vector<std::vector<std::byte>> VirtualFileSystem::ReadAll(std::string_view name) const {
    return state_->Contents(name, State::Occurrences::All);
}

bool VirtualFileSystem::Exists(std::string_view name) const {
    return !Location(name).empty();
}

std::string VirtualFileSystem::Location(std::string_view name) const {
    std::string location;
    const std::string safe = SafeName(name);
    state_->Visit(
        safe,
        [&](const fs::path &path) {
            location = path.string();
            return true;
        },
        [&](const Archive &archive) {
            location = fmt::format("{}{}{}", archive.Path().string(), kInArchive, safe);
            return true;
        });
    return location;
}

std::vector<std::string> VirtualFileSystem::List(std::string_view folder, std::string_view extension) const {
    const std::string safe = SafeName(folder);
    if (safe.empty())
        return {};
    std::set<std::string> known; // lower case
    std::vector<std::string> names;
    const auto add = [&](std::string name) {
        if (EndsWithNoCase(name, extension) && known.insert(LowerCase(name)).second)
            names.push_back(std::move(name));
    };
    for (const fs::path &root : state_->folders) {
        std::error_code failed, unknown;
        for (fs::directory_iterator at(root / PathOf(safe), failed), end; !failed && at != end; at.increment(failed))
            if (at->is_regular_file(unknown))
                add(at->path().filename().string());
    }
    for (const Archive &archive : state_->archives)
        for (const std::string &name : archive.Names())
            if (name.size() > safe.size() && name[safe.size()] == '/' &&
                EqualNoCase(std::string_view(name).substr(0, safe.size()), safe) &&
                name.find('/', safe.size() + 1) == std::string::npos)
                add(name.substr(safe.size() + 1));
    std::sort(names.begin(), names.end(), LessWithoutCase);
    return names;
}

} // namespace q3
