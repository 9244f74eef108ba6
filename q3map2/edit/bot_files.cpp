// GPL-2.0-or-later. Bot navigation files (.aas) beside a map, and the checksum by which they know it.
#include "q3map2/edit/bot_files.h"

#include "common/error.h"
#include "common/files/files.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>

namespace q3 {

// ---- The checksum by which a bot navigation file knows its map: MD4 as in RFC 1320, which GLib does not have ----

namespace {

constexpr std::size_t kBlockBytes = 64;
constexpr std::size_t kLengthAt = 56; ///< byte of the last block where the length of the data begins
using Words = std::array<std::uint32_t, 16>;
using Digest = std::array<std::uint32_t, 4>;

/// A round of RFC 1320, section 3.4: 16 steps that share a function, a constant, and four rotations.
struct Round {
    std::uint32_t (*mix)(std::uint32_t, std::uint32_t, std::uint32_t);
    std::uint32_t constant;
    std::array<int, 4> rotations;
    std::array<std::uint8_t, 16> order; ///< of the words of the block
};

constexpr std::array<Round, 3> kRounds = {{
    {[](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return (x & y) | (~x & z); },
     0,
     {3, 7, 11, 19},
     {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}},
    {[](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return (x & y) | (x & z) | (y & z); },
     0x5A827999,
     {3, 5, 9, 13},
     {0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15}},
    {[](std::uint32_t x, std::uint32_t y, std::uint32_t z) { return x ^ y ^ z; },
     0x6ED9EBA1,
     {3, 9, 11, 15},
     {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15}},
}};

Words LoadBlock(const std::byte *bytes) {
    Words words{};
    for (std::size_t i = 0; i < kBlockBytes; ++i)
        words[i / 4] |= std::to_integer<std::uint32_t>(bytes[i]) << (8 * (i % 4));
    return words;
}

void AddBlock(Digest &digest, const std::byte *bytes) {
    const Words words = LoadBlock(bytes);
    auto [a, b, c, d] = digest;
    for (const Round &round : kRounds)
        for (std::size_t i = 0; i < round.order.size(); ++i) {
            const std::uint32_t next =
                std::rotl(a + round.mix(b, c, d) + words[round.order[i]] + round.constant, round.rotations[i % 4]);
            a = d, d = c, c = b, b = next;
        }
    digest = {digest[0] + a, digest[1] + b, digest[2] + c, digest[3] + d};
}

} // namespace

std::array<std::uint32_t, 4> Md4(std::span<const std::byte> data) {
    Digest digest = {0x67452301, 0xEFCDAB89, 0x98BADCFE, 0x10325476}; // RFC 1320, section 3.3
    std::size_t at = 0;
    for (; at + kBlockBytes <= data.size(); at += kBlockBytes)
        AddBlock(digest, data.data() + at);
    // The rest, a 1 bit, zeros, and the length in bits fill one block or two.
    std::array<std::byte, 2 * kBlockBytes> tail{};
    const std::size_t rest = data.size() - at;
    if (rest > 0)
        std::memcpy(tail.data(), data.data() + at, rest);
    tail[rest] = std::byte(0x80);
    const std::size_t last = rest < kLengthAt ? 0 : kBlockBytes;
    const std::uint64_t bits = std::uint64_t(data.size()) * 8;
    for (std::size_t i = 0; i < 8; ++i)
        tail[last + kLengthAt + i] = std::byte(bits >> (8 * i));
    for (std::size_t block = 0; block <= last; block += kBlockBytes)
        AddBlock(digest, tail.data() + block);
    return digest;
}

std::uint32_t BlockChecksum(std::span<const std::byte> data) {
    const Digest digest = Md4(data);
    return digest[0] ^ digest[1] ^ digest[2] ^ digest[3];
}

// ---- Bot navigation files (.aas) beside a map ----

namespace {

// The head: ident, version and checksum, each 4 bytes, little endian. From version 5 on, byte i after the version is
// xored with 119 i.
constexpr std::size_t kHeadBytes = 12, kVersionAt = 4, kChecksumAt = 8;
constexpr std::string_view kIdent = "EAAS";
constexpr std::uint32_t kLastPlainVersion = 4;
constexpr unsigned kKeyStep = 119;

/// Byte i is xored with keyStep * i first.
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

std::vector<std::filesystem::path> BotFilesBeside(const std::filesystem::path &bspPath) {
    std::vector<std::filesystem::path> paths;
    for (const std::string_view end : kBotFileEnds)
        paths.emplace_back(bspPath).replace_filename(bspPath.stem().string() + std::string(end));
    return paths;
}

std::vector<BotFile> FindBotFiles(const std::filesystem::path &bspPath) {
    std::vector<BotFile> files;
    for (const std::filesystem::path &path : BotFilesBeside(bspPath)) {
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
