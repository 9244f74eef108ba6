// GPL-2.0-or-later. The files that a stage reads and writes.
#include "q3map2/file_guard.h"

#include "common/error.h"
#include "common/text/counted.h"

namespace q3 {

namespace fs = std::filesystem;

void FileGuard::Reads(const fs::path &file) {
    inputs_.push_back({file, FileState::Of(file)});
}

void FileGuard::Needs(const fs::path &file) {
    const InputFile opened(file);
    Reads(file);
}

void FileGuard::Writes(const fs::path &file, std::uint64_t bytes) {
    RequireWritable(file);
    Reserve(fs::absolute(file).parent_path(), bytes);
}

void FileGuard::WritesInto(const fs::path &folder, std::uint64_t bytes) {
    RequireFolder(folder);
    Reserve(fs::absolute(folder), bytes);
}

/// A new file is complete before it replaces the old one, so the space of the old one does not count as free.
void FileGuard::Reserve(fs::path folder, std::uint64_t bytes) {
    std::error_code failed;
    while (!fs::exists(folder, failed) && folder.has_relative_path())
        folder = folder.parent_path();
    const std::uint64_t needed = needed_[folder] += bytes;
    const fs::space_info space = fs::space(folder, failed);
    if (!failed && needed > 0 && space.available < needed)
        FailUnlessForced(fmt::format(
            "{}: cannot write: {} are free on this disk, and about {} are needed; free some space or choose another "
            "folder",
            folder.string(), SizeText(space.available), SizeText(needed)));
}

void FileGuard::FailUnlessForced(const std::string &text) const {
    if (!force_)
        throw Error("{}", text);
    log_.Warn("files", "{}", text);
}

void FileGuard::CheckUnchanged() const {
    for (const Input &input : inputs_)
        if (const FileState now = FileState::Of(input.file); now != input.state)
            FailUnlessForced(fmt::format(
                "{} was {} while this run was working, by another run or another program: the result {} made "
                "from the old file{}",
                input.file.string(), now.exists ? "written" : "removed", force_ ? "is" : "would be",
                force_ ? "" : ", so nothing is written. Run again, or write it anyway with -force"));
}

std::uint64_t SizeOfFile(const fs::path &file) {
    std::error_code failed;
    const std::uintmax_t size = fs::file_size(file, failed);
    return failed ? 0 : size;
}

void WarnIfSourceIsNewer(const fs::path &bspPath, Log &log) {
    const fs::path source = Beside(bspPath, ".map");
    const FileState map = FileState::Of(source), bsp = FileState::Of(bspPath);
    if (map.exists && bsp.exists && map.time > bsp.time)
        log.Warn("newer map source",
                 "{} is newer than {}: changes since then, other than those of light entities, are not in the .bsp; "
                 "compile the map again with -bsp",
                 source.string(), bspPath.filename().string());
}

} // namespace q3
