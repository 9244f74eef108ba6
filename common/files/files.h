// GPL-2.0-or-later. Files: reading, and safe replacement.
#pragma once

#include "common/platform/platform.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

class Log;

/// No deflate stream expands to more than this many times its size: a match of 258 bytes takes at least 2 bits.
inline constexpr std::size_t kMaxDeflateRatio = 1032;

/// Deleter of C files.
struct CloseFile {
    void operator()(std::FILE *file) const { std::fclose(file); }
};

/// A regular file that is read in pieces. Errors: Error naming the path and the reason.
class InputFile {
  public:
    explicit InputFile(std::filesystem::path path);
    std::uint64_t Size() const { return size_; }
    /// Fills `into` with the bytes from `at` on. All of them must lie in the file.
    void Read(std::uint64_t at, std::span<std::byte> into);

  private:
    std::filesystem::path path_;
    std::unique_ptr<std::FILE, CloseFile> file_;
    std::uint64_t size_ = 0;
};

/// A file mapped into memory. It must not be changed in place meanwhile, only replaced. Errors as InputFile.
class MappedFile {
  public:
    MappedFile() = default; ///< no bytes
    explicit MappedFile(const std::filesystem::path &path);
    std::span<const std::byte> Bytes() const;

  private:
    struct Unmap {
        void operator()(void *mapping) const;
    };
    std::unique_ptr<void, Unmap> mapping_; ///< GMappedFile
};

/// The whole file. Errors as InputFile.
std::vector<std::byte> ReadFile(const std::filesystem::path &path);

/// The whole file as text. Errors as InputFile.
std::string ReadTextFile(const std::filesystem::path &path);

/// End of the names of files that FileReplacement writes, PATH.XXXXXX.tmp with six letters or digits.
inline constexpr std::string_view kUnfinished = ".tmp";
/// PATH for such a name, else empty. Other programs may use such names too, so check that PATH is one of ours.
std::string TargetOfUnfinished(std::string_view name);

/// Replaces a file piece by piece. Atomic and durable: writes a temporary file beside it, flushes it to disk and
/// renames it. On any failure, and without Commit, the old file is unchanged and the temporary file is removed; a
/// process that is killed may leave its unfinished PATH.XXXXXX.tmp. An existing file keeps its permission bits, and one
/// that is write protected is not replaced; a symbolic link stays and the file it leads to is replaced. Other hard
/// links keep the old contents. Errors: Error naming the path and the reason.
class FileReplacement {
  public:
    explicit FileReplacement(std::filesystem::path path);
    FileReplacement(const FileReplacement &) = delete;
    FileReplacement &operator=(const FileReplacement &) = delete;
    ~FileReplacement();
    /// Writes more bytes after those before.
    void Append(std::span<const std::byte> data);
    /// Puts the whole file on the disk, still under its temporary name. No Append after it.
    void Finish();
    /// Finishes the file and renames it over the old one. To be called once, as the last call.
    void Commit();

  private:
    friend class FileSet;
    /// Before Commit: keeps the old file for Revert, under the name of another unfinished file. File systems without
    /// hard links keep none.
    void KeepOld();
    /// After Commit: puts the old file back, or removes the file if there was none. Before Commit: does nothing. If the
    /// old file cannot be put back, it keeps the name of an unfinished file. Needs no memory.
    void Revert() noexcept;
    [[noreturn]] void Fail(int reason) const;

    std::filesystem::path path_, target_;
    bool isNew_ = false;        ///< whether there is no old file
    std::string temporary_;     ///< empty once it is renamed
    std::filesystem::path old_; ///< the old file that is kept; empty: none
    bool keepsOld_ = false;     ///< whether it stays there
    std::unique_ptr<std::FILE, CloseFile> file_;
};

/// Files that belong together: all are complete on the disk before the first replaces its old version, and if one
/// cannot replace it, those that have are put back. Errors: those of FileReplacement and MakeFolder.
class FileSet {
  public:
    FileSet() = default;
    FileSet(const FileSet &) = delete;
    FileSet &operator=(const FileSet &) = delete;
    ~FileSet();
    FileReplacement &Add(const std::filesystem::path &path) { return files_.emplace_back(path); }
    /// A whole file, which is closed: many of them leave room for other open files.
    void AddFile(const std::filesystem::path &path, std::span<const std::byte> data);
    void AddText(const std::filesystem::path &path, std::string_view text);
    /// Removes a file, if there is one, as soon as all others are replaced. Failure is ignored.
    void AddRemoval(const std::filesystem::path &path) { removed_.push_back(path); }
    /// MakeFolder, for files of the set. Without Commit, the folders that did not exist are removed again.
    void AddFolder(const std::filesystem::path &folder);
    /// A line of the log that Commit prints once all files are replaced.
    void AddLine(Log &log, std::string line) { lines_.emplace_back(&log, std::move(line)); }
    /// Replaces the old files in the order of Add. To be called once.
    void Commit();

  private:
    void RevertAll() noexcept;

    std::deque<FileReplacement> files_;
    std::vector<std::filesystem::path> removed_;
    std::vector<std::filesystem::path> newFolders_; ///< each before those in it
    std::vector<std::pair<Log *, std::string>> lines_;
};

/// FileReplacement in one step.
void ReplaceFile(const std::filesystem::path &path, std::span<const std::byte> data);
void ReplaceTextFile(const std::filesystem::path &path, std::string_view text);

/// Throws Error, with the reason, if the file cannot be created or replaced: its folder is missing or write protected,
/// or a folder, a device or a write-protected file has that name.
void RequireWritable(const std::filesystem::path &file);
/// The same for files in a folder, which may still have to be created, with its parents.
void RequireFolder(const std::filesystem::path &folder);

/// Fingerprint of a file at one time: it differs once another program has written the file. A missing file has one too.
struct FileState {
    bool exists = false;
    std::uint64_t size = 0; ///< bytes
    FileStamp stamp;

    static FileState Of(const std::filesystem::path &path);
    bool operator==(const FileState &) const = default;
};

/// Whether there is a regular file of that name. One that the user may not look at is none. Errors: Error if the system
/// cannot tell.
bool IsFile(const std::filesystem::path &path);

/// Paths of what is in a folder, in any order; nothing if there is no such folder or the user may not read it. Errors:
/// Error if it cannot be read.
std::vector<std::filesystem::path> EntriesOf(const std::filesystem::path &folder);

/// A number that all paths of one disk (file system) share. If there is no such path: 0.
std::uint64_t DiskOf(const std::filesystem::path &path);

/// Makes the folder and its parents if they do not exist. Errors: Error if that fails.
void MakeFolder(const std::filesystem::path &folder);

} // namespace q3
