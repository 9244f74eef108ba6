// GPL-2.0-or-later. Checksums of bot navigation files.
#include "common/error.h"
#include "q3map2/edit/bot_files.h"
#include "tests/support/game_folder.h"

#include <bit>

namespace q3::test {

namespace {

std::string Digest(std::string_view text) {
    std::string hex;
    for (const std::uint32_t word : Md4(std::as_bytes(std::span(text))))
        for (int i = 0; i < 4; ++i)
            hex += fmt::format("{:02x}", word >> (8 * i) & 0xff);
    return hex;
}

// RFC 1320, appendix A.5.
TEST(BlockChecksum, Md4IsThatOfTheRfc) {
    EXPECT_EQ(Digest(""), "31d6cfe0d16ae931b73c59d7e0c089c0");
    EXPECT_EQ(Digest("a"), "bde52cb31de33e46245e05fbdbd6fb24");
    EXPECT_EQ(Digest("abc"), "a448017aaf21d8525fc10ae87aa6729d");
    EXPECT_EQ(Digest("message digest"), "d9130a8164549fe818874806e1c7014b");
    EXPECT_EQ(Digest("abcdefghijklmnopqrstuvwxyz"), "d79e1c308aa5bbcdeea8ed63df412da9");
    EXPECT_EQ(Digest("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789"),
              "043f8582f241db351ce627e153e7f0e4");
    EXPECT_EQ(Digest("12345678901234567890123456789012345678901234567890123456789012345678901234567890"),
              "e33b4ddc9c38f2199c3e7b164fcc0536");
}

// The words of the digest of "abc", little endian: 7a0148a4, 52d821af, e80ac15f, 9d72a67a.
TEST(BlockChecksum, IsTheXorOfTheWords) {
    EXPECT_EQ(BlockChecksum(std::as_bytes(std::span("abc", 3))), 0x7a0148a4u ^ 0x52d821afu ^ 0xe80ac15fu ^ 0x9d72a67au);
}

std::string AasFile(char version, std::string_view checksum) {
    return std::string("EAAS") + version + std::string(3, '\0') + std::string(checksum) + "areas";
}

// The bytes of 0x5DA10E2E as a file of version 5 has them: each xored with 0, 119, 238 and 101 (357 mod 256).
TEST(BotFiles, ChecksumIsStoredWithItsKey) {
    const GameFolder folder;
    folder.Write("x.bsp", "abc");
    folder.Write("x.aas", AasFile(5, {"\x11\x22\x33\x44", 4}));
    const std::uint32_t checksum = MapChecksum(folder / "x.bsp");
    EXPECT_EQ(checksum, 0x5da10e2eu);
    const auto files = FindBotFiles(folder / "x.bsp");
    ASSERT_EQ(files.size(), 1u);
    EXPECT_EQ(files[0].checksum, 0x11u | (0x22u ^ 119) << 8 | (0x33u ^ 238) << 16 | (0x44u ^ 101) << 24);
    SetChecksum(files[0], checksum);
    EXPECT_EQ(folder.ReadBack("x.aas"), AasFile(5, {"\x2e\x79\x4f\x38", 4}));
    EXPECT_EQ(FindBotFiles(folder / "x.bsp")[0].checksum, checksum);
}

TEST(BotFiles, OldVersionsHaveNoKey) {
    const GameFolder folder;
    folder.Write("x.aas", AasFile(4, {"\x11\x22\x33\x44", 4}));
    const auto files = FindBotFiles(folder / "x.bsp");
    ASSERT_EQ(files.size(), 1u);
    EXPECT_EQ(files[0].checksum, 0x44332211u);
    SetChecksum(files[0], 0x01020304);
    EXPECT_EQ(folder.ReadBack("x.aas"), AasFile(4, {"\x04\x03\x02\x01", 4}));
}

TEST(BotFiles, FilesOfBothBotSizesAreFound) {
    const GameFolder folder;
    for (const std::string name : {"x_b0.aas", "x_b1.aas", "y.aas"})
        folder.Write(name, AasFile(8, "abcd"));
    EXPECT_EQ(FindBotFiles(folder / "x.bsp").size(), 2u);
}

TEST(BotFiles, OtherFilesAreErrors) {
    const GameFolder folder;
    folder.Write("x.aas", "IBSP and so on");
    EXPECT_THROW(FindBotFiles(folder / "x.bsp"), Error);
    folder.Write("x.aas", "EAAS");
    EXPECT_THROW(FindBotFiles(folder / "x.bsp"), Error);
}

} // namespace

} // namespace q3::test
