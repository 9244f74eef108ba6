// GPL-2.0-or-later. The game's files: folders and pk3 archives as one tree.
#include "common/files/vfs.h"

#include "common/error.h"
#include "common/files/archive.h"
#include "common/files/dependencies.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "common/text/text.h"
#include "common/text/text_scan.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <set>
#include <system_error>

namespace q3 {

namespace fs = std::filesystem;

namespace {

/// First letter of requests: contents, or only the place, of the first file of a name; contents of all of them; names
/// in a folder.
constexpr char kRequestFirst = 'F', kRequestPlace = 'P', kRequestAll = 'A', kRequestList = 'L';

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

/// A folder, or an archive with its directory read.
struct MountedFiles {
    fs::path path;
    std::unique_ptr<Archive> archive{}; ///< null: a folder
};

} // namespace

struct VirtualFileSystem::State {
    Log &log;
    std::vector<std::string> forbidden;
    std::vector<MountedFiles> mounted; ///< the winner first: folders, then archives; before them preferred packages
    std::size_t folders = 0;           ///< how many of them are folders, until packages are preferred
    bool records = false;              ///< whether requests are noted
    mutable std::mutex mutex{};        ///< of `requests`
    mutable std::set<std::string> requests{};
    mutable std::map<fs::path, FileState> readFiles{}; ///< loose files, as they were before they were read first

    void NoteFile(const fs::path &path) const {
        if (!records)
            return;
        const FileState state = FileState::Of(path);
        const std::lock_guard lock(mutex);
        readFiles.try_emplace(path, state);
    }
    /// kind: what is asked for, a kRequest.
    void Note(char kind, std::string_view name, std::string_view extension = {}) const {
        if (!records)
            return;
        const std::lock_guard lock(mutex);
        requests.insert(fmt::format("{}{}{}{}", kind, name, extension.empty() ? "" : "*", extension));
    }

    bool IsForbidden(std::string_view name) const {
        return std::any_of(forbidden.begin(), forbidden.end(),
                           [&](const std::string &pattern) { return MatchesWildcard(name, pattern); });
    }
    void MountFolder(fs::path path);
    void MountArchive(const fs::path &path);
    std::size_t FindPackage(const PackageName &wanted) const;
    std::vector<PackageName> DependenciesOf(const MountedFiles &package) const;
    void Prefer(const PackageName &wanted, const fs::path &needing, std::size_t &preferred);
    void PreferAt(std::size_t at, std::size_t &preferred);
    /// As IsFile and EntriesOf, but what cannot be read gives a warning, and counts as not there.
    bool IsGameFile(const fs::path &path) const;
    std::vector<fs::path> EntriesOfFolder(const fs::path &folder) const;
    /// Calls use(path) or use(archive) for each occurrence of a safe name, the winner first, until one returns true.
    template <typename UsePath, typename UseArchive>
    void Visit(const std::string &name, UsePath usePath, UseArchive useArchive) const;
    enum class Occurrences { First, All };
    /// Contents of every occurrence, or of the first readable one. Unreadable ones give a warning.
    std::vector<std::vector<std::byte>> Contents(std::string_view name, Occurrences wanted) const;
};

bool VirtualFileSystem::State::IsGameFile(const fs::path &path) const {
    try {
        return IsFile(path);
    } catch (const Error &error) {
        log.Warn("unreadable game file", "{}", error.what());
        return false;
    }
}

std::vector<fs::path> VirtualFileSystem::State::EntriesOfFolder(const fs::path &folder) const {
    try {
        return EntriesOf(folder);
    } catch (const Error &error) {
        log.Warn("unreadable game folder", "{}", error.what());
        return {};
    }
}

void VirtualFileSystem::State::MountFolder(fs::path path) {
    mounted.insert(mounted.begin() + std::ptrdiff_t(folders++), {std::move(path)});
}

void VirtualFileSystem::State::MountArchive(const fs::path &path) {
    try {
        mounted.push_back({path, std::make_unique<Archive>(path)});
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
    for (const MountedFiles &files : mounted) {
        if (files.archive) {
            if (files.archive->Contains(name) && useArchive(*files.archive))
                return;
            continue;
        }
        const fs::path path = files.path / PathOf(name);
        if (IsGameFile(path) && usePath(path))
            return;
    }
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
        safe,
        [&](const fs::path &path) {
            NoteFile(path);
            return take([&] { return ReadFile(path); });
        },
        [&](const Archive &archive) { return take([&] { return archive.Read(safe); }); });
    return found;
}

VirtualFileSystem::VirtualFileSystem(Log &log) : state_(new State{.log = log, .forbidden = {}, .mounted = {}}) {}
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
    for (const fs::path &entry : state_->EntriesOfFolder(folder)) {
        std::string name = entry.filename().string();
        if (state_->IsForbidden(name))
            continue;
        std::error_code unknown;
        if (EndsWithNoCase(name, archiveEnd))
            archives.push_back(std::move(name));
        else if (EndsWithNoCase(name, folderEnd) && fs::is_directory(entry, unknown))
            packFolders.push_back(std::move(name));
    }
    std::sort(archives.begin(), archives.end(), LessWithoutCase);
    std::sort(packFolders.begin(), packFolders.end(), LessWithoutCase);

    state_->MountFolder(folder);
    for (auto name = packFolders.rbegin(); name != packFolders.rend(); ++name)
        state_->MountFolder(folder / *name);
    for (auto name = archives.rbegin(); name != archives.rend(); ++name)
        state_->MountArchive(folder / *name);
}

// ---- Packages that others need ----

/// Number of the mounted package with that name: the version that is asked for, else the newest; of equal ones the one
/// that wins already. The count of all: there is none.
std::size_t VirtualFileSystem::State::FindPackage(const PackageName &wanted) const {
    std::size_t found = mounted.size();
    std::string newest;
    for (std::size_t i = 0; i < mounted.size(); ++i) {
        const fs::path name = LastPart(mounted[i].path);
        const std::string_view extension = mounted[i].archive ? kPackageExtension : kPackageFolderExtension;
        if (!EqualNoCase(name.extension().string(), extension))
            continue;
        PackageName package = ParsePackageName(name.stem().string());
        const bool isCandidate =
            package.name == wanted.name && (wanted.version.empty() || package.version == wanted.version);
        if (isCandidate && (found == mounted.size() || CompareVersions(package.version, newest) > 0)) {
            found = i;
            newest = std::move(package.version);
        }
    }
    return found;
}

std::vector<PackageName> VirtualFileSystem::State::DependenciesOf(const MountedFiles &package) const {
    try {
        const fs::path file = package.path / kDependencyFile;
        if (package.archive)
            return package.archive->Contains(kDependencyFile)
                       ? ParseDependencies(AsText(package.archive->Read(kDependencyFile)), file.string(), log)
                       : std::vector<PackageName>();
        std::error_code absent;
        if (fs::is_regular_file(file, absent))
            return ParseDependencies(AsText(ReadFile(file)), file.string(), log);
    } catch (const Error &error) {
        log.Warn("unreadable game file", "{}", error.what());
    }
    return {};
}

/// Moves the package at `at` behind the `preferred` ones, and behind it those that it needs.
void VirtualFileSystem::State::PreferAt(std::size_t at, std::size_t &preferred) {
    std::rotate(mounted.begin() + std::ptrdiff_t(preferred), mounted.begin() + std::ptrdiff_t(at),
                mounted.begin() + std::ptrdiff_t(at + 1));
    const std::size_t here = preferred++;
    const fs::path needing = mounted[here].path;
    for (const PackageName &wanted : DependenciesOf(mounted[here]))
        Prefer(wanted, needing, preferred);
}

void VirtualFileSystem::State::Prefer(const PackageName &wanted, const fs::path &needing, std::size_t &preferred) {
    const std::size_t found = FindPackage(wanted);
    if (found == mounted.size())
        return log.Warn("missing package", "{} needs {}{}{}, which is in no folder of the game", needing.string(),
                        wanted.name, wanted.version.empty() ? "" : " ", wanted.version);
    if (found >= preferred) // else it is one of them already
        PreferAt(found, preferred);
}

void VirtualFileSystem::PreferDependencies(const fs::path &package) {
    const auto isPackage = [&](const MountedFiles &files) {
        std::error_code absent;
        return !files.archive && fs::equivalent(files.path, package, absent);
    };
    auto &mounted = state_->mounted;
    auto found = std::ranges::find_if(mounted, isPackage);
    if (found == mounted.end()) {
        if (state_->IsForbidden(LastPart(package)))
            return;
        state_->log.Print("VFS Init: {}\n", package.string());
        mounted.insert(mounted.begin(), {package});
        found = mounted.begin();
    }
    std::size_t preferred = 0;
    state_->PreferAt(std::size_t(found - mounted.begin()), preferred);
}

// ---- Reading ----

std::optional<std::vector<std::byte>> VirtualFileSystem::Read(std::string_view name) const {
    state_->Note(kRequestFirst, name);
    auto found = state_->Contents(name, State::Occurrences::First);
    if (found.empty())
        return std::nullopt;
    return std::move(found.front());
}

std::optional<std::vector<std::byte>> VirtualFileSystem::ReadStrictly(std::string_view name) const {
    state_->Note(kRequestFirst, name);
    std::optional<std::vector<std::byte>> found;
    const std::string safe = SafeName(name);
    state_->Visit(
        safe,
        [&](const fs::path &path) {
            state_->NoteFile(path);
            found = ReadFile(path);
            return true;
        },
        [&](const Archive &archive) {
            found = archive.Read(safe);
            return true;
        });
    return found;
}

std::vector<std::vector<std::byte>> VirtualFileSystem::ReadAll(std::string_view name) const {
    state_->Note(kRequestAll, name);
    return state_->Contents(name, State::Occurrences::All);
}

bool VirtualFileSystem::Exists(std::string_view name) const {
    return !Location(name).empty();
}

std::string VirtualFileSystem::Location(std::string_view name) const {
    state_->Note(kRequestPlace, name);
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
    state_->Note(kRequestList, folder, extension);
    const std::string safe = SafeName(folder);
    if (safe.empty())
        return {};
    std::set<std::string> known; // lower case
    std::vector<std::string> names;
    const auto add = [&](std::string name) {
        if (EndsWithNoCase(name, extension) && known.insert(LowerCase(name)).second)
            names.push_back(std::move(name));
    };
    for (const MountedFiles &files : state_->mounted) {
        if (files.archive) {
            for (const std::string &name : files.archive->Names())
                if (name.size() > safe.size() && name[safe.size()] == '/' &&
                    EqualNoCase(std::string_view(name).substr(0, safe.size()), safe) &&
                    name.find('/', safe.size() + 1) == std::string::npos)
                    add(name.substr(safe.size() + 1));
            continue;
        }
        for (const fs::path &entry : state_->EntriesOfFolder(files.path / PathOf(safe)))
            if (state_->IsGameFile(entry))
                add(entry.filename().string());
    }
    std::sort(names.begin(), names.end(), LessWithoutCase);
    return names;
}

// ---- Requests, and what they find ----

void VirtualFileSystem::RecordRequests() {
    state_->records = true;
}

std::vector<std::string> VirtualFileSystem::Requests() const {
    const std::lock_guard lock(state_->mutex);
    return {state_->requests.begin(), state_->requests.end()};
}

void VirtualFileSystem::AddRequests(std::span<const std::string> requests) {
    const std::lock_guard lock(state_->mutex);
    state_->requests.insert(requests.begin(), requests.end());
}

bool VirtualFileSystem::ReadFilesAreUnchanged() const {
    const std::lock_guard lock(state_->mutex);
    return std::ranges::all_of(state_->readFiles,
                               [](const auto &read) { return FileState::Of(read.first) == read.second; });
}

Hash128 VirtualFileSystem::AnswersTo(std::span<const std::string> requests) const {
    KeyBuilder key("answers");
    for (const std::string &request : requests) {
        key.AddText(request);
        if (request.empty())
            continue;
        const std::string_view name = std::string_view(request).substr(1);
        if (const std::size_t star = name.rfind('*'); request.front() == kRequestList && star != name.npos) {
            for (const std::string &found : List(name.substr(0, star), name.substr(star + 1)))
                key.AddText(found);
            continue;
        }
        const bool readsAll = request.front() == kRequestAll, reads = request.front() != kRequestPlace;
        const std::string safe = SafeName(name);
        state_->Visit(
            safe,
            [&](const fs::path &path) {
                key.Add(true);
                if (!reads)
                    return true;
                state_->NoteFile(path);
                try {
                    const Hash128 hash = HashOf(MappedFile(path).Bytes());
                    key.Add(hash.low, hash.high);
                } catch (const Error &) { // as for Read, the next file of that name counts
                    return false;
                }
                return !readsAll;
            },
            [&](const Archive &archive) {
                key.Add(true);
                if (reads)
                    key.Add(archive.ChecksumOf(safe));
                return !readsAll;
            });
    }
    return key.Key();
}

} // namespace q3
