// GPL-2.0-or-later. The checksum by which a bot navigation file knows its map. MD4 as in RFC 1320; GLib has none.
#include "q3map2/edit/block_checksum.h"

#include <bit>
#include <cstring>

namespace q3 {

namespace {

constexpr std::size_t kBlock = 64, kLengthAt = 56;
using Words = std::array<std::uint32_t, 16>;
using Digest = std::array<std::uint32_t, 4>;

/// A round of the RFC: 16 steps that share a function, a constant, and four rotations.
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
    for (std::size_t i = 0; i < kBlock; ++i)
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
    Digest digest = {0x67452301, 0xEFCDAB89, 0x98BADCFE, 0x10325476};
    std::size_t at = 0;
    for (; at + kBlock <= data.size(); at += kBlock)
        AddBlock(digest, data.data() + at);
    // The rest, a 1 bit, zeros, and the length in bits fill one block or two.
    std::array<std::byte, 2 * kBlock> tail{};
    const std::size_t rest = data.size() - at;
    if (rest > 0)
        std::memcpy(tail.data(), data.data() + at, rest);
    tail[rest] = std::byte(0x80);
    const std::size_t last = rest < kLengthAt ? 0 : kBlock;
    const std::uint64_t bits = std::uint64_t(data.size()) * 8;
    for (std::size_t i = 0; i < 8; ++i)
        tail[last + kLengthAt + i] = std::byte(bits >> (8 * i));
    for (std::size_t block = 0; block <= last; block += kBlock)
        AddBlock(digest, tail.data() + block);
    return digest;
}

std::uint32_t BlockChecksum(std::span<const std::byte> data) {
    const Digest digest = Md4(data);
    return digest[0] ^ digest[1] ^ digest[2] ^ digest[3];
}

} // namespace q3
