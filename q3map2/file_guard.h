// GPL-2.0-or-later. The files that a stage reads and writes: missing, protected and changing files are found early.
#pragma once

#include "common/files/files.h"
#include "q3map2/stages.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

namespace q3 {

/// A stage declares its files before it computes, and checks before it writes that no other program changed them.
class FileGuard {
  public:
    explicit FileGuard(const StageContext &context) : FileGuard(context.options.force, context.log) {}
    FileGuard(bool force, Log &log) : log_(log), force_(force) {}

    /// A file that the result depends on, or that the result replaces. To be called before the file is read; the file
    /// may be missing.
    void Reads(const std::filesystem::path &file);
    /// The same for a file that must exist. Errors: it cannot be read.
    void Needs(const std::filesystem::path &file);
    /// A file that the stage will write, and its approximate size; 0: small or unknown. Errors: it cannot be written,
    /// or its disk lacks the space for it and for the files named before in its folder. With -force, lack of space is a
    /// warning.
    void Writes(const std::filesystem::path &file, std::uint64_t bytes = 0);
    /// The same for files in a folder, which the stage creates if it does not exist.
    void WritesInto(const std::filesystem::path &folder, std::uint64_t bytes = 0);
    /// To be called before the first file is written. Errors: a file of Reads has changed; with -force, a warning.
    void CheckUnchanged() const;

  private:
    struct Input {
        std::filesystem::path file;
        FileState state;
    };

    void Reserve(std::filesystem::path folder, std::uint64_t bytes);
    void FailUnlessForced(const std::string &text) const;

    Log &log_;
    bool force_;
    std::vector<Input> inputs_;
    std::map<std::filesystem::path, std::uint64_t> needed_; ///< bytes, by folder
};

/// Size of the file; 0: there is none.
std::uint64_t SizeOfFile(const std::filesystem::path &file);

/// Warns if the map source beside a .bsp is newer, so that the .bsp lacks its latest changes.
void WarnIfSourceIsNewer(const std::filesystem::path &bspPath, Log &log);

} // namespace q3
