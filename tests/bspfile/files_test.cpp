// GPL-2.0-or-later. Files on disk are replaced whole or not at all.
#include "common/files.h"
#include "tests/bspfile/sample_bsp.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>

#include <sys/resource.h>
#include <unistd.h>

using namespace q3;
using namespace q3::test;
using testing::HasSubstr;
namespace fs = std::filesystem;

namespace {

class Files : public testing::Test {
  protected:
    void SetUp() override {
        std::string name = (fs::temp_directory_path() / "bspfile-XXXXXX").string();
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        folder_ = name;
        fs::permissions(folder_, fs::perms(0777));
    }
    void TearDown() override {
        fs::permissions(folder_, fs::perms(0700));
        fs::remove_all(folder_);
    }
    fs::path Old(std::string_view text, fs::perms mode = fs::perms(0644)) const {
        const fs::path path = folder_ / "map.bsp";
        std::ofstream(path) << text;
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
    fs::path folder_;
};

const std::vector<std::byte> kNew(100000, std::byte('n'));

/// Runs in a child: gives up all rights, tries to write, tells by its exit status whether that was an Error.
[[noreturn]] void WriteAsNobody(const fs::path &path) {
    if (geteuid() == 0 && setuid(65534) != 0)
        std::_Exit(1);
    std::_Exit(ErrorOf([&] { ReplaceFile(path, kNew); }).find("cannot write") != std::string::npos ? 42 : 0);
}

} // namespace

TEST_F(Files, BspFileRoundTripAnnouncesPathAndSize) {
    Bsp bsp = SampleBsp();
    bsp.gridSH = SampleGridSH();
    Listener listener;
    const fs::path path = folder_ / "map.bsp";
    WriteBspFile(path, bsp, {}, listener.log);
    const auto bytes = WriteBsp(bsp, {});
    EXPECT_EQ(listener.text,
              "Writing " + path.string() + "\nWrote 0.0 MB (" + std::to_string(bytes.size()) + " bytes)\n");
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
    Listener listener;
    EXPECT_THAT(ErrorOf([&] { WriteBspFile(path, bsp, {}, listener.log); }), HasSubstr("map.bsp: "));
    EXPECT_EQ(Text(path), "old");
}

TEST_F(Files, AFullDiskLeavesTheOldFile) {
    const fs::path path = Old("old");
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit small{4096, before.rlim_max};
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &small);
    const std::string text = ErrorOf([&] { ReplaceFile(path, kNew); });
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_THAT(text, HasSubstr("map.bsp: cannot write: "));
    EXPECT_EQ(Text(path), "old");
    EXPECT_EQ(FileCount(), 1u); // nothing half-written is left behind
}

TEST_F(Files, AReadOnlyFolderLeavesTheOldFile) {
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
    for (const unsigned mode : {0600u, 0644u, 0666u, 0755u}) {
        const fs::path path = Old("old", fs::perms(mode));
        ReplaceFile(path, kNew);
        EXPECT_EQ(fs::status(path).permissions(), fs::perms(mode));
        EXPECT_EQ(ReadFile(path), kNew);
    }
}

TEST_F(Files, ANewFileFollowsTheUmask) {
    const mode_t before = umask(027);
    ReplaceFile(folder_ / "new.bsp", kNew);
    umask(before);
    EXPECT_EQ(fs::status(folder_ / "new.bsp").permissions(), fs::perms(0640));
}

TEST_F(Files, ASymbolicLinkStaysAndItsTargetIsReplaced) {
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

TEST_F(Files, OnlyRegularFilesAreReplaced) {
    EXPECT_THAT(ErrorOf([&] { ReplaceFile(folder_, kNew); }), HasSubstr("not a regular file"));
    EXPECT_THAT(ErrorOf([&] { ReplaceFile(folder_ / "none" / "map.bsp", kNew); }), HasSubstr("cannot write"));
}
