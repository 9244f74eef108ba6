// GPL-2.0-or-later. Compiled maps as files on disk.
#include "q3map2/bspfile/bspfile.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/counted.h"
#include "q3map2/bspfile/bsp_layout.h"
#include "q3map2/bspfile/bsp_pieces.h"

namespace q3 {

Bsp ReadBspFile(const std::filesystem::path &path, const BspFormat &format, Log &log) {
    InputFile file(path);
    const auto read = [&file](std::uint64_t at, std::span<std::byte> into) { file.Read(at, into); };
    return ReadBspFrom({file.Size(), read}, path.string(), format, log);
}

std::vector<std::byte> WriteBsp(const Bsp &bsp, const BspFormat &format) {
    const BspPieces pieces(bsp, format);
    std::vector<std::byte> file;
    file.reserve(pieces.Size());
    pieces.Write([&file](std::span<const std::byte> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
    return file;
}

void WriteBspFile(const std::filesystem::path &path, const Bsp &bsp, const BspFormat &format, Log &log) {
    log.Print("Writing {}\n", path.string());
    const BspPieces pieces = [&] {
        try {
            return BspPieces(bsp, format);
        } catch (const Error &error) {
            throw Error("{}: {}", path.string(), error.what());
        }
    }();
    FileReplacement file(path);
    pieces.Write([&file](std::span<const std::byte> bytes) { file.Append(bytes); });
    file.Commit();
    log.Print("Wrote {} ({} bytes)\n", SizeText(pieces.Size()), pieces.Size());
}

} // namespace q3
