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

/// A file is complete before it replaces its old one, so the old one gives no room.
void FileGuard::Reserve(fs::path folder, std::uint64_t bytes) {
    std::error_code failed;
    while (!fs::exists(folder, failed) && folder.has_relative_path())
        folder = folder.parent_path();
    const std::uint64_t needed = needed_[folder] += bytes;
    const fs::space_info space = fs::space(folder, failed);
    if (!failed && needed > 0 && space.available < needed)
        Complain(fmt::format("{}: cannot write: {} free on this disk, and about {} needed; make room or choose another "
                             "folder",
                             folder.string(), SizeText(space.available), SizeText(needed)));
}

void FileGuard::Complain(const std::string &text) const {
    if (!force_)
        throw Error("{}", text);
    log_.Warn("files", "{}", text);
}

void FileGuard::CheckUnchanged() const {
    for (const Input &input : inputs_)
        if (const FileState now = FileState::Of(input.file); now != input.state)
            Complain(fmt::format("{} was {} while this run was working, by another run or another program, so the "
                                 "result would be that of the old one{}",
                                 input.file.string(), now.exists ? "written" : "removed",
                                 force_ ? "" : ": nothing is written. Run again, or write all the same with -force"));
}

std::uint64_t SizeOfFile(const fs::path &file) {
    std::error_code failed;
    const std::uintmax_t size = fs::file_size(file, failed);
    return failed ? 0 : size;
}

void WarnIfSourceIsNewer(const fs::path &bspPath, Log &log) {
    const fs::path source = WithExtension(bspPath, ".map");
    const FileState map = FileState::Of(source), bsp = FileState::Of(bspPath);
    if (map.exists && bsp.exists && map.time > bsp.time)
        log.Warn("newer map source",
                 "{} is newer than {}: what was changed in it since, other than light entities, is not in the .bsp; "
                 "compile the map again with -bsp",
                 source.string(), bspPath.filename().string());
}

} // namespace q3
