// GPL-2.0-or-later. Bot navigation files (.aas) beside a map.
#include "q3map2/edit/bot_files.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/edit/block_checksum.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace q3 {

namespace {

// A head of ident, version and checksum, each 4 bytes, little endian. From version 5 on the bytes that follow the
// version are xored with multiples of 119.
constexpr std::size_t kHeadBytes = 12, kVersionAt = 4, kChecksumAt = 8;
constexpr std::string_view kIdent = "EAAS";
constexpr std::uint32_t kLastPlainVersion = 4;
constexpr unsigned kKeyStep = 119;

std::uint32_t LoadWord(std::span<const std::byte> bytes, unsigned keyStep) {
    std::uint32_t word = 0;
    for (unsigned i = 0; i < 4; ++i)
        word |= (std::to_integer<std::uint32_t>(bytes[i]) ^ (keyStep * i & 0xff)) << (8 * i);
    return word;
}

unsigned KeyStepOf(std::span<const std::byte> head) {
    return LoadWord(head.subspan(kVersionAt), 0) <= kLastPlainVersion ? 0 : kKeyStep;
}

void CheckHead(const std::filesystem::path &path, std::span<const std::byte> head) {
    if (!std::ranges::equal(head.first(kIdent.size()), kIdent, {}, [](std::byte b) { return char(b); }))
        throw Error("{}: expected a bot navigation file, which begins with {}", path.string(), kIdent);
}

} // namespace

std::uint32_t ChecksumIn(std::span<const std::byte> file, const std::filesystem::path &path) {
    if (file.size() < kHeadBytes)
        throw Error("{}: {} bytes, expected a bot navigation file of at least {}", path.string(), file.size(),
                    kHeadBytes);
    const auto head = file.first(kHeadBytes);
    CheckHead(path, head);
    return LoadWord(head.subspan(kChecksumAt), KeyStepOf(head));
}

std::vector<BotFile> FindBotFiles(const std::filesystem::path &bspPath) {
    std::vector<BotFile> files;
    for (const std::string_view end : kBotFileEnds) {
        auto path = bspPath;
        path.replace_filename(bspPath.stem().string() + std::string(end));
        if (!std::filesystem::exists(path))
            continue;
        InputFile file(path);
        std::array<std::byte, kHeadBytes> head{};
        const auto read = std::span(head).first(std::size_t(std::min<std::uint64_t>(file.Size(), kHeadBytes)));
        file.Read(0, read);
        files.push_back({path, ChecksumIn(read, path)});
    }
    return files;
}

std::uint32_t MapChecksum(const std::filesystem::path &bspPath) {
    return BlockChecksum(ReadFile(bspPath));
}

void SetChecksum(const BotFile &file, std::uint32_t checksum) {
    std::vector<std::byte> bytes = ReadFile(file.path);
    if (bytes.size() < kHeadBytes)
        throw Error("{}: expected a bot navigation file", file.path.string());
    CheckHead(file.path, bytes);
    const unsigned keyStep = KeyStepOf(bytes);
    for (unsigned i = 0; i < 4; ++i)
        bytes[kChecksumAt + i] = std::byte((checksum >> (8 * i) & 0xff) ^ (keyStep * i & 0xff));
    ReplaceFile(file.path, bytes);
}

} // namespace q3
