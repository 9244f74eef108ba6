// GPL-2.0-or-later. The files that a stage reads and writes: what can go wrong with them is found before the work.
#pragma once

#include "common/files/files.h"
#include "q3map2/stages.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

namespace q3 {

/// A stage names its files before the work, and asks before it writes whether somebody else wrote one meanwhile.
class FileGuard {
  public:
    explicit FileGuard(const StageContext &context) : FileGuard(context.options.force, context.log) {}
    FileGuard(bool force, Log &log) : log_(log), force_(force) {}

    /// A file that the stage will read, or that it replaces by something made from others. To be called before it is
    /// read; it need not be there.
    void Reads(const std::filesystem::path &file);
    /// The same for a file without which the stage can do nothing. Errors: it cannot be read.
    void Needs(const std::filesystem::path &file);
    /// A file that the stage will write, and about how large it gets; 0: small, or not known. Errors: it cannot be
    /// written, or its disk has no room for it and those named before. Lack of room is a warning with -force.
    void Writes(const std::filesystem::path &file, std::uint64_t bytes = 0);
    /// The same for files in a folder that is made if need be.
    void WritesInto(const std::filesystem::path &folder, std::uint64_t bytes = 0);
    /// To be called before the first file is written. Errors: a file of Reads has changed; with -force, a warning.
    void CheckUnchanged() const;

  private:
    struct Input {
        std::filesystem::path file;
        FileState state;
    };

    void Reserve(std::filesystem::path folder, std::uint64_t bytes);
    void Complain(const std::string &text) const;

    Log &log_;
    bool force_;
    std::vector<Input> inputs_;
    std::map<std::filesystem::path, std::uint64_t> needed_; ///< bytes, by folder
};

/// Size of the file; 0: there is none.
std::uint64_t SizeOfFile(const std::filesystem::path &file);

/// Warns that the map source beside a .bsp is newer: the .bsp lacks what was changed since it was compiled.
void WarnIfSourceIsNewer(const std::filesystem::path &bspPath, Log &log);

} // namespace q3
