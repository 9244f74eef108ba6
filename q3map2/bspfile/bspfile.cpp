// GPL-2.0-or-later. Compiled maps as files on disk.
#include "q3map2/bspfile/bspfile.h"

#include "common/error.h"
#include "common/files.h"

namespace q3 {

Bsp ReadBspFile(const std::filesystem::path &path, const BspFormat &format, Log &log) {
    return ReadBsp(ReadFile(path), path.string(), format, log);
}

void WriteBspFile(const std::filesystem::path &path, const Bsp &bsp, const BspFormat &format, Log &log) {
    log.Print("Writing {}\n", path.string());
    std::vector<std::byte> file;
    try {
        file = WriteBsp(bsp, format);
    } catch (const Error &error) {
        throw Error("{}: {}", path.string(), error.what());
    }
    ReplaceFile(path, file);
    log.Print("Wrote {:.1f} MB ({} bytes)\n", double(file.size()) / (1024 * 1024), file.size());
}

} // namespace q3
