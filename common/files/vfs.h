// GPL-2.0-or-later. The game's files: folders and pk3 archives as one tree.
#pragma once

#include "common/hash.h"
#include "common/log.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Read-only view of all mounted game folders. Names are relative, with '/', such as "textures/base/wall.tga"; archive
/// names are case-insensitive, loose files by the file system's rules. Precedence:
/// docs/reference/game_files.md. Safe for concurrent reads once set up.
class VirtualFileSystem {
  public:
    explicit VirtualFileSystem(Log &log);
    ~VirtualFileSystem();
    VirtualFileSystem(VirtualFileSystem &&) noexcept;

    /// Wildcards (? and *) for names of folders and archives to skip. Set before mounting.
    void SetForbidden(std::vector<std::string> patterns);
    /// Adds one game folder with its pk3 archives and pk3dir folders; `archiveExtension` without dot ("pk3", "dpk").
    /// Mount the folder that should win first. A missing folder is fine; an unreadable archive is a warning and is
    /// skipped.
    void Mount(const std::filesystem::path &folder, std::string_view archiveExtension);
    /// Puts a package first, and after it the mounted packages that its file DEPS names, those that they name, and so
    /// on; all others keep their order behind these. `package`: the folder that a map is in; one that is not mounted
    /// yet is. Without a version in DEPS the newest counts. A package that is not there is a warning. To be called
    /// after the last Mount; packages are those of Dæmon (dependencies.h).
    void PreferDependencies(const std::filesystem::path &package);

    /// Contents of the winning file of that name, or nothing. A damaged archive entry is a warning and counts as
    /// absent.
    std::optional<std::vector<std::byte>> Read(std::string_view name) const;
    /// The same, but without warnings. Error: where Read would warn.
    std::optional<std::vector<std::byte>> ReadStrictly(std::string_view name) const;
    /// Contents of every occurrence of that name, the winner first.
    std::vector<std::vector<std::byte>> ReadAll(std::string_view name) const;
    bool Exists(std::string_view name) const;
    /// Where the winner is: a path, or "archive.pk3 :: inner name" (kInArchive). Empty when absent.
    std::string Location(std::string_view name) const;
    /// Names directly in `folder` (no trailing '/') that end in `extension` (with dot), each once, sorted,
    /// case-insensitive.
    std::vector<std::string> List(std::string_view folder, std::string_view extension) const;

    /// From now on, notes what is asked for, for Requests. Set before concurrent reads.
    void RecordRequests();
    /// What was asked for since RecordRequests, each once, sorted; for AnswersTo.
    std::vector<std::string> Requests() const;
    /// Notes requests that an earlier run has made for what this run takes from it.
    void AddRequests(std::span<const std::string> requests);
    /// Whether the loose files that were read since RecordRequests are as they were before they were read.
    bool ReadFilesAreUnchanged() const;
    /// A hash of what the requests find: it differs once a file that they read has other contents, or they find other
    /// files. Entries of archives count by the checksum in the archive's directory, loose files by their contents.
    Hash128 AnswersTo(std::span<const std::string> requests) const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3
