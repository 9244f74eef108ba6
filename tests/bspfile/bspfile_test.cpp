// GPL-2.0-or-later. Files on disk are replaced whole or not at all.
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "q3map2/bspfile/bspfile.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/game_folder.h"
#include "tests/support/process.h"
#include "tests/support/sample_bsp.h"
#include "tests/support/this_system.h"

#include <glib.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <random>
#include <thread>

#ifndef _WIN32
#include <sys/stat.h>
#include <unistd.h>
#endif

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

/// The folder of a test, for its death tests: Windows begins the whole test anew in another process for each.
constexpr const char *kFolderOfTest = "Q3MAP2_TEST_FOLDER";

class Files : public testing::Test {
  protected:
    void SetUp() override {
        if (const char *parents = g_getenv(kFolderOfTest)) {
            folder_ = parents;
            return;
        }
        folder_ = made_.emplace().Root();
        g_setenv(kFolderOfTest, folder_.string().c_str(), TRUE);
        fs::permissions(folder_, fs::perms(0777));
    }
    void TearDown() override {
        g_unsetenv(kFolderOfTest);
        fs::permissions(folder_, fs::perms(0700));
        std::error_code absent;
        fs::permissions(folder_ / "map.bsp", fs::perms(0600), absent); // Windows removes no write-protected file
    }
    fs::path Old(std::string_view text, fs::perms mode = fs::perms(0644)) const {
        const fs::path path = folder_ / "map.bsp";
        std::ofstream(path, std::ios::binary) << text;
        fs::permissions(path, mode);
        return path;
    }
    static std::string Text(const fs::path &path) {
        std::ifstream file(path);
        return {std::istreambuf_iterator(file), {}};
    }
    std::size_t FileCount() const {
        return std::size_t(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }
    std::optional<GameFolder> made_;
    fs::path folder_;
};

const std::vector<std::byte> kNew(100000, std::byte('n'));

/// The sample with a grid of side x side x side points.
Bsp WithGrid(int side, float value) {
    Bsp bsp = SampleBsp();
    bsp.gridSH.emplace();
    bsp.gridSH->header = {{0, 0, 0}, {8, 8, 8}, {side, side, side}, side * side * side};
    bspGridPointSH_t point{};
    point.coeffs[0] = {value, value, value};
    bsp.gridSH->points.assign(std::size_t(side * side * side), point);
    return bsp;
}

/// Runs `action` while no file can grow beyond that many bytes.
std::string ErrorOnAFullDisk(std::size_t bytes, const std::function<void()> &action) {
    const FileSizeLimit full(bytes);
    return ErrorOf(action);
}

/// Runs in a child. Exit status 42: the action's peak of resident memory is at most `bytes` above what was there.
[[noreturn]] void ExitWithGrowth(std::size_t bytes, const std::function<void()> &action) {
    const double before = PeakMemory();
    action();
    const double growth = PeakMemory() - before;
    std::cerr << growth << " bytes of growth, " << bytes << " allowed\n";
    std::_Exit(growth <= double(bytes) ? 42 : 1);
}

/// Gives up the rights of root, who may write anything. False: that failed.
bool BecomeNobody() {
#ifdef _WIN32
    return true; // write protection holds for administrators too
#else
    return geteuid() != 0 || setuid(65534) == 0;
#endif
}

/// Runs in a child: gives up all rights, tries to write, tells by its exit status whether that was an Error.
[[noreturn]] void WriteAsNobody(const fs::path &path) {
    if (!BecomeNobody())
        std::_Exit(1);
    std::_Exit(ErrorOf([&] { ReplaceFile(path, kNew); }).find("cannot write") != std::string::npos ? 42 : 0);
}

} // namespace

TEST_F(Files, BspFileRoundTripAnnouncesPathAndSize) {
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    KeptLog listener;
    const fs::path path = folder_ / "map.bsp";
    WriteBspFile(path, bsp, {}, listener.log);
    const auto bytes = WriteBsp(bsp, {});
    EXPECT_EQ(listener.text, fmt::format("Writing {}\nWrote {:.1f} KB ({} bytes)\n", path.string(),
                                         double(bytes.size()) / 1000, bytes.size()));
    EXPECT_EQ(ReadFile(path), bytes);
    EXPECT_EQ(WriteBsp(ReadBspFile(path, {}, listener.log), {}), bytes);
    EXPECT_THAT(ErrorOf([&] { ReadBspFile(folder_ / "none.bsp", {}, listener.log); }),
                HasSubstr("none.bsp: cannot read"));
}

TEST_F(Files, ABadMapLeavesTheOldFile) {
    const fs::path path = Old("old");
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    bsp.gridSH->header.numPoints = 5;
    KeptLog listener;
    EXPECT_THAT(ErrorOf([&] { WriteBspFile(path, bsp, {}, listener.log); }), HasSubstr("map.bsp: "));
    EXPECT_EQ(Text(path), "old");
}

TEST_F(Files, AFullDiskLeavesTheOldFile) {
    if (!FileSizeLimit::kExists)
        GTEST_SKIP() << kNoSizeLimit;
    const fs::path path = Old("old");
    const Bsp bsp = WithGrid(10, 1);
    KeptLog listener;
    const std::size_t size = WriteBsp(bsp, {}).size();
    for (const std::size_t room : {std::size_t(0), std::size_t(100), std::size_t(4096), size / 2, size - 1}) {
        EXPECT_THAT(ErrorOnAFullDisk(room, [&] { WriteBspFile(path, bsp, {}, listener.log); }),
                    HasSubstr("map.bsp: cannot write: "));
        EXPECT_EQ(Text(path), "old");
        EXPECT_EQ(FileCount(), 1u) << room; // nothing half-written is left behind
    }
    EXPECT_EQ(ErrorOnAFullDisk(size, [&] { WriteBspFile(path, bsp, {}, listener.log); }), "no error");
}

TEST_F(Files, WhatIsNotCommittedLeavesTheOldFile) {
    const fs::path path = Old("old");
    {
        FileReplacement file(path);
        file.Append(kNew);
        EXPECT_EQ(Text(path), "old");
    }
    EXPECT_EQ(Text(path), "old");
    EXPECT_EQ(FileCount(), 1u);
}

TEST_F(Files, AFolderThatTakesThePlaceMeanwhileIsAnError) {
    const fs::path path = folder_ / "map.bsp";
    {
        FileReplacement file(path);
        file.Append(kNew);
        fs::create_directory(path);
        EXPECT_THAT(ErrorOf([&] { file.Commit(); }), HasSubstr("map.bsp: cannot write: "));
    }
    EXPECT_TRUE(fs::is_directory(path));
    EXPECT_EQ(FileCount(), 1u);
}

TEST_F(Files, TheSameBytesReachMemoryAndDisk) {
    const fs::path path = folder_ / "map.bsp";
    Bsp bsp = SampleBsp();
    bsp.advertisements = {SampleAdvertisement()};
    KeptLog listener;
    for (const BspFormat &format : {BspFormat{}, BspFormat{.version = 47}, kQuakeLive})
        for (const int sh : {0, 1, 2})
            for (const std::size_t foreign : {0u, 1u, 2u}) {
                bsp.gridSH = sh > 0 ? std::optional(SampleGridSH()) : std::nullopt;
                bsp.gridSHContainer = sh == 2 ? GridSHContainer::Bspx : GridSHContainer::Lump;
                bsp.bspx = {{"LMSHIFT", std::vector(5, std::byte(9))}, {"EMPTY", {}}};
                bsp.bspx.resize(foreign);
                const auto bytes = WriteBsp(bsp, format);
                WriteBspFile(path, bsp, format, listener.log);
                EXPECT_EQ(ReadFile(path), bytes);
                EXPECT_EQ(WriteBsp(ReadBspFile(path, format, listener.log), format),
                          WriteBsp(ReadBsp(bytes, "x.bsp", format, listener.log), format));
            }
}

TEST_F(Files, ACutFileIsRefusedAsInMemory) {
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    const auto bytes = WriteBsp(bsp, {});
    const fs::path path = folder_ / "map.bsp";
    KeptLog listener;
    for (std::size_t length = 0; length < bytes.size(); length += 37) {
        const auto cut = std::span(bytes).first(length);
        std::ofstream(path, std::ios::binary)
            .write(reinterpret_cast<const char *>(cut.data()), std::streamsize(cut.size()));
        const std::string text = ErrorOf([&] { ReadBspFile(path, {}, listener.log); });
        EXPECT_THAT(text, HasSubstr("map.bsp: "));
        EXPECT_EQ(text, ErrorOf([&] { ReadBsp(cut, path.string(), {}, listener.log); }));
    }
}

TEST_F(Files, AFileThatShrinksWhileItIsReadIsAnError) {
    InputFile file(Old(std::string(100000, 'a') + "end"));
    std::array<std::byte, 4> bytes{};
    file.Read(file.Size() - 4, bytes);
    EXPECT_EQ(bytes[3], std::byte('d'));
    fs::resize_file(folder_ / "map.bsp", 50002);
    file.Read(0, bytes);
    EXPECT_EQ(bytes[0], std::byte('a'));
    EXPECT_THAT(ErrorOf([&] { file.Read(50000, bytes); }),
                HasSubstr("map.bsp: cannot read: it ends before byte 50004"));
}

TEST_F(Files, OnlyRegularFilesAreRead) {
#ifndef _WIN32 // whose pipes lie in no folder
    const fs::path pipe = folder_ / "pipe";
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THAT(ErrorOf([&] { ReadFile(pipe); }), HasSubstr("pipe: cannot read: not a regular file"));
#endif
    EXPECT_THAT(ErrorOf([&] { ReadFile(folder_); }), HasSubstr("cannot read: not a regular file"));
}

TEST_F(Files, AWriterThatIsKilledLeavesTheOldFile) {
    const fs::path path = Old("old");
    for (int pieces = 0; pieces < 4; pieces++) {
        EXPECT_EXIT(
            {
                FileReplacement file(path);
                for (int i = 0; i < pieces; i++)
                    file.Append(kNew);
                KillThisProcess();
            },
            IsOfAKilledProcess, "");
        EXPECT_EQ(Text(path), "old");
    }
}

/// Maps of different sizes, which the test below writes in turn.
std::array<Bsp, 2> MapsInTurn() {
    return {WithGrid(40, 1), WithGrid(41, 2)};
}

constexpr const char *kMapInTurn = "Q3MAP2_TEST_MAP"; ///< names the map of the test below
constexpr std::string_view kHasWritten = "has written once";

/// No test: what the one below starts and kills.
TEST(Writer, DISABLED_WritesMapsInTurnForever) {
    const std::array<Bsp, 2> maps = MapsInTurn();
    KeptLog listener;
    const char *path = g_getenv(kMapInTurn);
    ASSERT_NE(path, nullptr);
    for (std::size_t next = 0;; next++) {
        WriteBspFile(path, maps[next % 2], {}, listener.log);
        if (next == 0)
            std::cout << kHasWritten << std::endl;
    }
}

TEST_F(Files, AtWhateverMomentAWriterIsKilledTheMapIsWhole) {
    const fs::path path = folder_ / "map.bsp";
    const std::array<Bsp, 2> maps = MapsInTurn();
    const std::array bytes = {WriteBsp(maps[0], {}), WriteBsp(maps[1], {})};
    g_setenv(kMapInTurn, path.string().c_str(), TRUE);
    std::mt19937 random(7);
    std::size_t unfinished = 0;
    for (int round = 0; round < 30; round++) {
        Process writer({ThisProgram().string(), "--gtest_also_run_disabled_tests", "--gtest_filter=Writer.*"}, {},
                       OutputTo::Pipe);
        std::string printed;
        for (std::string more; printed.find(kHasWritten) == std::string::npos && !(more = writer.Read()).empty();)
            printed += more;
        ASSERT_THAT(printed, HasSubstr(kHasWritten));
        std::this_thread::sleep_for(std::chrono::microseconds(1000 + random() % 40000));
        writer.End(9); // SIGKILL
        writer.Wait();
        const auto now = ReadFile(path);
        EXPECT_TRUE(now == bytes[0] || now == bytes[1]) << round;
        for (const auto &entry : std::vector(fs::directory_iterator(folder_), fs::directory_iterator()))
            if (entry.path() != path)
                unfinished += fs::remove(entry.path());
    }
    EXPECT_GT(unfinished, 0u); // some were killed while they wrote
    KeptLog listener;
    EXPECT_EQ(ErrorOf([&] { WriteBspFile(path, maps[0], {}, listener.log); }), "no error");
}

TEST_F(Files, WritingTakesNoSecondCopyInMemory) {
    const Bsp bsp = WithGrid(80, 1);
    const std::size_t lump = bsp.gridSH->points.size() * sizeof(bspGridPointSH_t);
    KeptLog listener;
    for (const GridSHContainer container : {GridSHContainer::Lump, GridSHContainer::Bspx}) {
        const fs::path path = folder_ / "map.bsp";
        EXPECT_EXIT(
            {
                Bsp copy = bsp;
                copy.gridSHContainer = container;
                ExitWithGrowth(lump / 8, [&] { WriteBspFile(path, copy, {}, listener.log); });
            },
            testing::ExitedWithCode(42), "");
        EXPECT_EXIT(ExitWithGrowth(lump + lump / 4, [&] { ReadBspFile(path, {}, listener.log); }),
                    testing::ExitedWithCode(42), "");
        EXPECT_GT(ReadFile(path).size(), lump);
    }
}

TEST_F(Files, AReadOnlyFolderLeavesTheOldFile) {
    if (kIsWindows)
        GTEST_SKIP() << "folders of Windows have no write protection, but access control lists";
    const fs::path path = Old("old", fs::perms(0666));
    fs::permissions(folder_, fs::perms(0555));
    EXPECT_EXIT(WriteAsNobody(path), testing::ExitedWithCode(42), "");
    EXPECT_EQ(Text(path), "old");
}

TEST_F(Files, AWriteProtectedFileIsNotReplaced) {
    const fs::path path = Old("old", fs::perms(0444));
    EXPECT_EXIT(WriteAsNobody(path), testing::ExitedWithCode(42), "");
    EXPECT_EQ(Text(path), "old");
}

TEST_F(Files, PermissionBitsStay) {
    if (kIsWindows)
        GTEST_SKIP() << "files of Windows have no permission bits, but access control lists";
    for (const unsigned mode : {0600u, 0644u, 0666u, 0755u}) {
        const fs::path path = Old("old", fs::perms(mode));
        ReplaceFile(path, kNew);
        EXPECT_EQ(fs::status(path).permissions(), fs::perms(mode));
        EXPECT_EQ(ReadFile(path), kNew);
    }
}

#ifndef _WIN32 // which has no umask
TEST_F(Files, ANewFileFollowsTheUmask) {
    const mode_t before = umask(027);
    ReplaceFile(folder_ / "new.bsp", kNew);
    umask(before);
    EXPECT_EQ(fs::status(folder_ / "new.bsp").permissions(), fs::perms(0640));
}
#endif

TEST_F(Files, ASymbolicLinkStaysAndItsTargetIsReplaced) {
    if (kIsWindows)
        GTEST_SKIP() << "libstdc++ makes and reads no symbolic links on Windows";
    const fs::path path = Old("old");
    fs::create_directory(folder_ / "sub");
    const fs::path link = folder_ / "sub" / "link.bsp";
    fs::create_symlink("../map.bsp", link);
    ReplaceFile(link, kNew);
    EXPECT_TRUE(fs::is_symlink(link));
    EXPECT_EQ(ReadFile(path), kNew);
    fs::create_symlink("loop.bsp", folder_ / "loop.bsp");
    EXPECT_THAT(ErrorOf([&] { ReplaceFile(folder_ / "loop.bsp", kNew); }), HasSubstr("symbolic links"));
}

TEST_F(Files, OfASetAllFilesAreReplacedOrNone) {
    const fs::path first = Old("first"), second = Old("second");
    {
        FileSet set;
        set.AddText(first, "new");
        set.AddText(second, "new");
    }
    EXPECT_EQ(ReadFile(first), ReadFile(second));
    EXPECT_NE(ReadTextFile(first), "new") << "without Commit";
    FileSet set;
    set.AddText(first, "new");
    EXPECT_THAT(ErrorOf([&] { set.AddText(folder_ / "no folder" / "file", "new"); }), HasSubstr("cannot write"));
    EXPECT_NE(ReadTextFile(first), "new");
    set.AddText(second, "new");
    set.Commit();
    EXPECT_EQ(ReadTextFile(first) + ReadTextFile(second), "newnew");
}

TEST_F(Files, WhatCannotBeWrittenIsKnownBeforehand) {
    fs::create_directory(folder_ / "folder");
    EXPECT_EQ(ErrorOf([&] { RequireWritable(folder_ / "new"); }), "no error");
    EXPECT_EQ(ErrorOf([&] { RequireWritable(Old("old")); }), "no error");
    EXPECT_THAT(ErrorOf([&] { RequireWritable(folder_ / "folder"); }), HasSubstr("not a regular file, but a folder"));
    EXPECT_THAT(ErrorOf([&] { RequireWritable(folder_ / "none" / "file"); }), HasSubstr("none does not exist"));
    EXPECT_THAT(ErrorOf([&] { RequireWritable(Old("old") / "file"); }), HasSubstr("map.bsp is not a folder"));
    EXPECT_EQ(ErrorOf([&] { RequireFolder(folder_ / "a" / "b"); }), "no error");
    EXPECT_THAT(ErrorOf([&] { RequireFolder(Old("old") / "b"); }), HasSubstr("map.bsp is a file"));
}

TEST_F(Files, OnlyRegularFilesAreReplaced) {
    EXPECT_THAT(ErrorOf([&] { ReplaceFile(folder_, kNew); }), HasSubstr("not a regular file"));
    EXPECT_THAT(ErrorOf([&] { ReplaceFile(folder_ / "none" / "map.bsp", kNew); }), HasSubstr("cannot write"));
}
