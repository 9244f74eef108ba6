// GPL-2.0-or-later. Files cut, mangled and forged: an Error or a valid map, nothing else.
#include "common/error.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

using namespace q3;
using namespace q3::test;
using testing::AllOf;
using testing::HasSubstr;

namespace {

using Bytes = std::vector<std::byte>;

/// The sample in every layout that is written.
std::vector<Bytes> AllLayouts() {
    Bsp bsp = SampleBsp();
    std::vector<Bytes> files{WriteBsp(bsp, {})};
    bsp.advertisements = {SampleAdvertisement()};
    files.push_back(WriteBsp(bsp, kQuakeLive));
    bsp.gridSH = SampleGridSH();
    files.push_back(WriteBsp(bsp, kQuakeLive));
    bsp.gridSHContainer = GridSHContainer::Bspx;
    bsp.bspx = {{"FOREIGN", Bytes(6, std::byte(1))}};
    files.push_back(WriteBsp(bsp, kQuakeLive));
    bsp.vertexE5bgr9.assign(bsp.drawVerts.size(), 7);
    bsp.rnm = RnmLightmaps{.header = {.side = 2, .pageCount = 1}, .pages = {{3, {}}}};
    for (std::vector<std::uint32_t> &map : bsp.rnm->pages[0].maps)
        map.assign(4, 9);
    files.push_back(WriteBsp(bsp, kQuakeLive));
    return files;
}

struct StyledFile {
    BspFormat format;
    Bytes bytes;
};
/// The sample as RBSP and FBSP, with lumps of this program and of others in the BSPX directory.
std::vector<StyledFile> StyledFiles() {
    Bsp bsp = SampleBsp();
    bsp.drawSurfaces[0].lightmapStyles = bsp.drawSurfaces[0].vertexStyles = {0, 3, 33, kNoStyle};
    bsp.gridPoints[2].styles = kNoStyles;
    bsp.gridSH = SampleGridSH();
    bsp.gridSHContainer = GridSHContainer::Bspx;
    bsp.bspx = {{"FOREIGN", Bytes(6, std::byte(1))}};
    std::vector<StyledFile> files;
    for (const std::string_view ident : {kRbspIdent, kFbspIdent}) {
        const BspFormat format{.version = 1, .ident = ident};
        files.push_back({format, WriteBsp(bsp, format)});
    }
    return files;
}

/// True when the file was refused; what is accepted must survive a second pass.
bool Refused(const Bytes &file, const BspFormat &format) {
    KeptLog listener;
    try {
        const Bsp bsp = ReadBsp(file, "x.bsp", format, listener.log);
        const Bytes again = WriteBsp(bsp, format);
        EXPECT_EQ(WriteBsp(ReadBsp(again, "again.bsp", format, listener.log), format), again);
        return false;
    } catch (const Error &error) {
        const std::string_view text = error.what();
        EXPECT_TRUE(text.starts_with("x.bsp: ")) << text;
        EXPECT_EQ(text.find('\n'), text.npos) << text;
        return true;
    }
}

} // namespace

TEST(Hostile, CutAtEveryLength) {
    const std::vector<Bytes> files = AllLayouts();
    const std::size_t lumpsEnd = WriteBsp(SampleBsp(), {}).size() + 8 + 128; // one slot and one advertisement more
    for (std::size_t i = 0; i < files.size(); i++)
        for (std::size_t length = 0; length < files[i].size(); length++) {
            const Bytes cut(files[i].begin(), files[i].begin() + std::ptrdiff_t(length));
            const bool refused = Refused(cut, kQuakeLive);
            // Slot 17 may be text in other layouts, and BSPX is an add-on: without them the map still stands.
            const bool needed = i == 0 || i == 2 || length < lumpsEnd - 128;
            EXPECT_TRUE(refused || !needed) << "layout " << i << " cut at " << length;
        }
}

TEST(Hostile, StyledFilesCutAtEveryLength) {
    Bsp bsp = SampleBsp();
    for (const auto &[format, bytes] : StyledFiles()) {
        const std::size_t lumpsEnd = WriteBsp(bsp, format).size() - 60; // its grid has one record less
        for (std::size_t length = 0; length < bytes.size(); length++) {
            const bool refused = Refused({bytes.begin(), bytes.begin() + std::ptrdiff_t(length)}, format);
            EXPECT_TRUE(refused || length >= lumpsEnd) << format.ident << " cut at " << length;
        }
    }
}

TEST(Hostile, AHeaderOfNothingButEmptyLumps) {
    Bytes file(144);
    std::memcpy(file.data(), "IBSP", 4);
    SetInt(file, 4, 47);
    for (; file.size() < 170; file.push_back({}))
        EXPECT_TRUE(Refused(file, kQuakeLive)) << file.size();
}

TEST(Hostile, EveryLumpOffsetAndLength) {
    const Bytes good = WriteBsp(SampleBsp(), {});
    const auto size = std::int32_t(good.size());
    for (std::size_t slot = 0; slot < 17; slot++) {
        for (const std::int32_t offset : {-1, INT32_MIN, INT32_MAX, size + 1, 1, 143}) {
            Bytes file = good;
            SetInt(file, 8 + 8 * slot, offset);
            const bool harmless = slot == LUMP_LIGHTMAPS && offset > 0 && offset < size; // an empty lump
            EXPECT_NE(Refused(file, {}), harmless) << slot << " offset " << offset;
        }
        for (const std::int32_t length : {-1, INT32_MIN, INT32_MAX, size, size - 143}) {
            Bytes file = good;
            SetInt(file, 12 + 8 * slot, length);
            EXPECT_TRUE(Refused(file, {})) << slot << " length " << length;
        }
    }
}

TEST(Hostile, LumpsMayLieOnAnyByte) {
    Bytes file = WriteBsp(SampleBsp(), {});
    const Bytes good = file;
    file.insert(file.begin() + 144, std::byte(0));
    for (std::size_t slot = 0; slot < 17; slot++)
        SetInt(file, 8 + 8 * slot, IntAt(file, 8 + 8 * slot) + 1);
    KeptLog listener;
    EXPECT_EQ(WriteBsp(ReadBsp(file, "x.bsp", {}, listener.log), {}), good);
}

TEST(Hostile, MessagesNameTheLump) {
    const Bytes good = WriteBsp(SampleBsp(), {});
    const auto message = [&good](std::size_t at, std::int32_t value) {
        Bytes file = good;
        SetInt(file, at, value);
        KeptLog listener;
        return ErrorOf([&] { ReadBsp(file, "x.bsp", {}, listener.log); });
    };
    EXPECT_EQ(message(8 + 8 * 2, -5), "x.bsp: lump 2 (planes): offset -5 is negative");
    EXPECT_EQ(message(12 + 8 * 4, -7), "x.bsp: lump 4 (leafs): length -7 is negative");
    EXPECT_EQ(message(8 + 8 * 7, 8), "x.bsp: lump 7 (models): offset 8 lies inside the header of 144 bytes");
    EXPECT_THAT(message(12 + 8 * 8, INT32_MAX), HasSubstr("lump 8 (brushes): offset"));
    EXPECT_THAT(message(12 + 8 * 8, 23), HasSubstr("length 23 is not a multiple of the record size 12"));
    EXPECT_EQ(ErrorOf([] {
                  KeptLog listener;
                  ReadBsp(Bytes(143), "x.bsp", {}, listener.log);
              }),
              "x.bsp: 143 bytes, but a BSP header has 144");
}

TEST(Hostile, FilesOfOtherGamesAreNamed) {
    const auto message = [](std::string text, std::size_t size) {
        text.resize(std::max(size, text.size()), text.find('\0') == std::string::npos ? ' ' : '\0');
        KeptLog listener;
        return ErrorOf([&] { ReadBsp(std::as_bytes(std::span(text)), "x.bsp", {}, listener.log); });
    };
    const auto bytes = [](std::string_view mark, char version) {
        return std::string(mark) + version + std::string(3, 0);
    };
    const std::pair<std::string, std::string> files[] = {{bytes("", 29), "Quake or Hexen II (version 29)"},
                                                         {bytes("", 30), "Half-Life (version 30)"},
                                                         {bytes("IBSP", 38), "Quake II (IBSP 38)"},
                                                         {bytes("IBSP", 59), "Call of Duty (IBSP 59)"},
                                                         {bytes("VBSP", 20), "Source game (VBSP)"},
                                                         {bytes("QBSP", 38), "extended limits (QBSP)"},
                                                         {"PK\3\4", "zip archive"},
                                                         {"\x1F\x8B\x08", "gzip"},
                                                         {"Version 2\n{\n", "Doom 3"},
                                                         {"{\n\"classname\" \"worldspawn\"\n}\n", "a map source"},
                                                         {"hello", "the file is text"}};
    for (const auto &[begin, kind] : files)
        for (const std::size_t size : {0, 4000}) {
            EXPECT_THAT(message(begin, size), AllOf(HasSubstr("x.bsp: the file is "), HasSubstr(kind)));
        }
    EXPECT_THAT(message("", 0), HasSubstr("the file is empty"));
    EXPECT_THAT(message(bytes("IBSP", 99), 4000), HasSubstr("BSP version 99, expected 46 or 47"));
}

namespace {

/// Random numbers below a bound.
class Below {
  public:
    explicit Below(unsigned seed) : random_(seed) {}
    std::size_t operator()(std::size_t bound) { return std::size_t(random_()) % bound; }

  private:
    std::mt19937 random_;
};

/// The file with up to six bits or words changed.
Bytes Mutant(Bytes file, Below &below) {
    const std::int32_t words[] = {0, 1, -1, 2, 3, 255, 4096, 65536, INT32_MAX, INT32_MIN, 0x7fc00000, 0x7f800000};
    for (std::size_t flips = 1 + below(6); flips > 0; flips--) {
        if (below(2) == 0)
            file[below(file.size())] ^= std::byte(1 << below(8));
        else
            SetInt(file, below(file.size() / 4) * 4, words[below(std::size(words))]);
    }
    return file;
}

} // namespace

TEST(Hostile, RandomBytesAndWords) {
    const std::vector<Bytes> files = AllLayouts();
    Below below(20240607);
    int refused = 0;
    constexpr int kRounds = 20000;
    for (int round = 0; round < kRounds; round++) {
        const Bytes file = Mutant(files[below(files.size())], below);
        refused += Refused(file, below(2) == 0 ? BspFormat{} : kQuakeLive);
    }
    EXPECT_GT(refused, kRounds / 10);
    EXPECT_LT(refused, kRounds);
}

TEST(Hostile, RandomBytesAndWordsOfStyledFiles) {
    Below below(41);
    constexpr int kRounds = 10000;
    for (const auto &[format, bytes] : StyledFiles()) {
        int refused = 0;
        for (int round = 0; round < kRounds; round++)
            refused += Refused(Mutant(bytes, below), format);
        EXPECT_GT(refused, kRounds / 10) << format.ident;
        EXPECT_LT(refused, kRounds) << format.ident;
    }
}

TEST(Hostile, ForceNeverCrashesEither) {
    const std::vector<Bytes> files = AllLayouts();
    std::mt19937 random(4);
    int accepted = 0;
    for (int round = 0; round < 2000; round++) {
        Bytes file = files[random() % files.size()];
        for (int i = 0; i < 3; i++)
            file[random() % 200] ^= std::byte(1 << random() % 8);
        accepted += !Refused(file, {.force = true});
    }
    EXPECT_GT(accepted, 0);
}
