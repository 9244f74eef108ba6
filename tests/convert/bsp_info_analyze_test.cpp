// GPL-2.0-or-later. Guesses about unknown files.
#include "common/error.h"
#include "q3map2/convert/bsp_info.h"
#include "tests/support/small_bsp.h"

#include <gmock/gmock.h>

#include <cstring>

namespace q3::test {

namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::byte> ZeroBytes(std::size_t count) {
    return std::vector<std::byte>(count, std::byte(0));
}

std::vector<std::byte> TextBytes(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

std::string Analysis(const std::vector<std::byte> &file, bool lumpSwap = false) {
    KeptLog log;
    PrintAnalysis(file, lumpSwap, "some.bsp", log.log);
    return log.text;
}

/// Exchanges offset and length in a directory of 17 entries.
std::vector<std::byte> Swapped(std::vector<std::byte> file) {
    for (std::size_t at = 8; at < 8 + std::size_t(17 * 8); at += 8)
        std::swap_ranges(file.begin() + std::ptrdiff_t(at), file.begin() + std::ptrdiff_t(at + 4),
                         file.begin() + std::ptrdiff_t(at + 4));
    return file;
}

TEST(Analyze, GuessesByText) {
    EXPECT_THAT(GuessLump(TextBytes("{\n\"classname\" \"worldspawn\"\n}\n")), ElementsAre("entities"));
    EXPECT_THAT(GuessLump(TextBytes("abcdef textures/base/wall")), ElementsAre("shaders"));
}

TEST(Analyze, GuessesBySize) {
    EXPECT_THAT(GuessLump(ZeroBytes(49152)), Contains("1 lightmaps, 128 x 128"));
    EXPECT_THAT(GuessLump(ZeroBytes(3 * 44)), Contains("3 draw vertices"));
    EXPECT_THAT(GuessLump(ZeroBytes(2 * 44)), Not(Contains(HasSubstr("draw vertices")))) << "a map has three at least";
    EXPECT_TRUE(GuessLump(ZeroBytes(7)).empty());
}

TEST(Analyze, ListsTheLumpsOfAFile) {
    const std::string text = Analysis(WriteBsp(SmallBsp(), {}));
    EXPECT_THAT(text, HasSubstr("some.bsp\nident   IBSP\nversion 46\n"));
    EXPECT_THAT(text, HasSubstr("may be entities\n"));
    EXPECT_THAT(text, HasSubstr("may be shaders\n"));
    EXPECT_THAT(text, HasSubstr("lump 16: "));
    EXPECT_THAT(text, Not(HasSubstr("lump 17: ")));
}

TEST(Analyze, TakesTheLengthFirst) {
    const auto file = WriteBsp(SmallBsp(), {});
    EXPECT_EQ(Analysis(Swapped(file), true), Analysis(file));
}

TEST(Analyze, SaysWhenTheDirectoryMakesNoSense) {
    std::vector<std::byte> file = TextBytes("ABCD0000");
    file.resize(100, std::byte(0x7F));
    EXPECT_THAT(Analysis(file), HasSubstr("try it with -lumpswap\n"));
    EXPECT_THAT(Analysis(file, true), HasSubstr("try it without -lumpswap\n"));
    EXPECT_THROW(Analysis(TextBytes("short")), Error);
}

TEST(Analyze, CutFilesAreFine) {
    const auto file = WriteBsp(FullBsp(GridSHContainer::Lump), {});
    for (std::size_t size = 16; size < 400; ++size)
        Analysis({file.begin(), file.begin() + std::ptrdiff_t(size)});
}

} // namespace

} // namespace q3::test
