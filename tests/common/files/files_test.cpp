// GPL-2.0-or-later. Files with long names and foreign letters, and files that another program has open.
#include "common/files/files.h"

#include "common/error.h"
#include "common/platform/platform.h"
#include "tests/support/game_folder.h"
#include "tests/support/this_system.h"

#include <gmock/gmock.h>

#include <chrono>
#include <future>
#include <thread>

namespace q3::test {

namespace {

namespace fs = std::filesystem;

/// Letters of two, three and four bytes in UTF-8, and a blank.
constexpr std::string_view kForeignName = "\u00e4\u00f6\u00fc\u00df \u65e5\u672c \U0001f600";

/// Below `root`, over 300 characters deep: Windows has a limit of 260 that programs must ask to be without.
fs::path DeepFolder(fs::path root) {
    for (int i = 0; i < 6; i++)
        root /= std::string(50, char('a' + i));
    return root;
}

/// What FileReplacement, InputFile, FileState and the others do with a file of that name in that folder.
void ExpectUsable(const fs::path &folder, std::string_view name) {
    MakeFolder(folder);
    const fs::path path = folder / name;
    EXPECT_NO_THROW(RequireWritable(path));
    const FileState missing = FileState::Of(path);
    EXPECT_FALSE(missing.exists);
    ReplaceTextFile(path, "old");
    const FileState old = FileState::Of(path);
    EXPECT_TRUE(old.exists);
    EXPECT_EQ(old.size, 3u);
    ReplaceTextFile(path, "newer");
    EXPECT_EQ(ReadTextFile(path), "newer");
    EXPECT_EQ(FileState::Of(path).size, 5u);
    EXPECT_EQ(DiskOf(path), DiskOf(folder));
    EXPECT_NE(DiskOf(path), 0u);
    std::vector<std::string> names;
    for (const auto &entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    EXPECT_THAT(names, testing::ElementsAre(std::string(name)));
}

TEST(FileNames, MayHoldLettersOfAllLanguagesAndBlanks) {
    const GameFolder folder;
    ExpectUsable(folder / kForeignName, std::string(kForeignName) + ".bsp");
}

TEST(FileNames, MayBeLongerThan260Characters) {
    const GameFolder folder;
    ExpectUsable(DeepFolder(folder.Root()), "map.bsp");
}

TEST(FileNames, OfWindowsMayHaveDriveLettersAndBackslashes) {
    if (!kIsWindows)
        GTEST_SKIP() << "only Windows has drive letters";
    const GameFolder folder;
    ReplaceTextFile(folder / "x.bsp", "text");
    std::string name = (folder / "x.bsp").string();
    EXPECT_EQ(name.at(1), ':');
    for (const char from : {'/', '\\'}) {
        std::replace(name.begin(), name.end(), from, char('/' + '\\' - from));
        EXPECT_EQ(ReadTextFile(name), "text") << name;
        name[0] = char(name[0] ^ ' '); // the other case
        EXPECT_EQ(ReadTextFile(name), "text") << name;
    }
}

/// Virus scanners do so, with files that have just been written.
TEST(FilesInUse, AreReplacedWhenAnotherProgramHasThemOpenForAMoment) {
    const GameFolder folder;
    folder.Write("x.bsp", "old");
    auto reader = std::make_unique<std::ifstream>(folder / "x.bsp");
    ASSERT_TRUE(reader->is_open());
    const auto closed = std::async(std::launch::async, [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
        reader.reset();
    });
    ReplaceTextFile(folder / "x.bsp", "new");
    closed.wait();
    EXPECT_EQ(ReadTextFile(folder / "x.bsp"), "new");
}

TEST(FilesInUse, StayWhenAnotherProgramHasThemOpenForLong) {
    const GameFolder folder;
    folder.Write("x.bsp", "old");
    {
        std::ifstream reader(folder / "x.bsp");
        if (!kIsWindows)
            ReplaceTextFile(folder / "x.bsp", "new"); // the reader keeps the old one
        else
            EXPECT_THROW(ReplaceTextFile(folder / "x.bsp", "new"), Error);
        std::string text;
        reader >> text;
        EXPECT_EQ(text, "old");
    }
    EXPECT_EQ(ReadTextFile(folder / "x.bsp"), kIsWindows ? "old" : "new");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.Root()), fs::directory_iterator()), 1) << "nothing is left";
}

// ---- Files that belong together ----

std::vector<std::string> NamesIn(const fs::path &folder) {
    std::vector<std::string> names;
    for (const auto &entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    return names;
}

TEST(FileSets, ReplaceAllFilesAndThenRemoveOthers) {
    const GameFolder folder;
    for (const std::string_view name : {"a", "b", "stale"})
        folder.Write(name, "old");
    {
        FileSet files;
        files.AddText(folder / "a", "new");
        files.AddText(folder / "b", "new");
        files.AddFolder(folder / "in/side");
        files.AddText(folder / "in/side/c", "new");
        files.AddRemoval(folder / "stale");
        files.AddRemoval(folder / "none");
        EXPECT_EQ(folder.ReadBack("a"), "old");
        files.Commit();
    }
    for (const std::string_view name : {"a", "b", "in/side/c"})
        EXPECT_EQ(folder.ReadBack(name), "new") << name;
    EXPECT_THAT(NamesIn(folder.Root()), testing::UnorderedElementsAre("a", "b", "in"));
}

TEST(FileSets, PutOldFilesBackIfAnotherCannotBeReplaced) {
    const GameFolder folder;
    folder.Write("a", "old");
    folder.Write("stale", "old");
    {
        FileSet files;
        files.AddText(folder / "a", "new");
        files.AddText(folder / "made", "new");
        files.AddText(folder / "last", "new");
        files.AddRemoval(folder / "stale");
        fs::create_directories(folder / "last/inner"); // nothing can be renamed over it
        EXPECT_THROW(files.Commit(), Error);
    }
    EXPECT_EQ(folder.ReadBack("a"), "old");
    EXPECT_THAT(NamesIn(folder.Root()), testing::UnorderedElementsAre("a", "stale", "last"));
}

TEST(FileSets, LeaveNothingWithoutCommit) {
    const GameFolder folder;
    folder.Write("there/a", "old");
    {
        FileSet files;
        files.AddFolder(folder / "there/new/inner");
        files.AddFolder(folder / "there/new/other");
        files.AddText(folder / "there/new/inner/b", "new");
        files.AddText(folder / "there/a", "new");
    }
    EXPECT_EQ(folder.ReadBack("there/a"), "old");
    EXPECT_THAT(NamesIn(folder / "there"), testing::ElementsAre("a"));
}

// ---- What is there ----

TEST(Entries, AreThoseOfTheFolderOrNone) {
    const GameFolder folder;
    folder.Write("a", "");
    folder.Write("b/c", "");
    EXPECT_THAT(EntriesOf(folder.Root()), testing::UnorderedElementsAre(folder / "a", folder / "b"));
    EXPECT_THAT(EntriesOf(folder / "none"), testing::IsEmpty());
    EXPECT_THAT(EntriesOf(folder / "a"), testing::IsEmpty()) << "a file";
    EXPECT_TRUE(IsFile(folder / "a"));
    EXPECT_FALSE(IsFile(folder / "b"));
    EXPECT_FALSE(IsFile(folder / "a/none"));
    EXPECT_FALSE(IsFile(folder / std::string(1000, 'x'))) << "no file system has such long names";
}

TEST(Entries, ThatTheSystemCannotLookAtAreErrors) {
    const GameFolder folder;
    std::error_code failed;
    fs::create_symlink("circle", folder / "circle", failed);
    if (failed)
        GTEST_SKIP() << "no symbolic links here";
    EXPECT_THROW(IsFile(folder / "circle"), Error);
    EXPECT_THROW(EntriesOf(folder / "circle"), Error);
}

} // namespace

} // namespace q3::test
