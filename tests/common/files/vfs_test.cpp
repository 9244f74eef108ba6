// GPL-2.0-or-later. The virtual file system.
#include "common/error.h"
#include "common/files/dependencies.h"
#include "common/files/vfs.h"
#include "common/text/text.h"
#include "tests/support/game_folder.h"

#include <algorithm>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace q3 {
namespace {

using test::GameFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string Text(const std::vector<std::byte> &bytes) {
    return std::string(AsText(bytes));
}

class Vfs : public testing::Test {
  protected:
    std::string Read(std::string_view name) const {
        const auto bytes = vfs.Read(name);
        return bytes ? Text(*bytes) : "(absent)";
    }
    std::vector<std::string> ReadAll(std::string_view name) const {
        std::vector<std::string> texts;
        for (const auto &bytes : vfs.ReadAll(name))
            texts.push_back(Text(bytes));
        return texts;
    }

    GameFolder folder;
    test::KeptLog out;
    VirtualFileSystem vfs{out.log};
};

TEST_F(Vfs, LooseFileBeatsArchivesOfEveryFolder) {
    folder.WriteArchive("mod/z.pk3", {{"a.txt", "mod archive"}});
    folder.Write("base/a.txt", "base loose");
    vfs.Mount(folder / "mod", "pk3");
    vfs.Mount(folder / "base", "pk3");
    EXPECT_EQ(Read("a.txt"), "base loose");
    EXPECT_THAT(ReadAll("a.txt"), ElementsAre("base loose", "mod archive"));
}

TEST_F(Vfs, EarlierFolderWins) {
    folder.Write("mod/a.txt", "mod");
    folder.Write("base/a.txt", "base");
    folder.WriteArchive("mod/a.pk3", {{"b.txt", "mod"}});
    folder.WriteArchive("base/z.pk3", {{"b.txt", "base"}});
    vfs.Mount(folder / "mod", "pk3");
    vfs.Mount(folder / "base", "pk3");
    EXPECT_THAT(ReadAll("a.txt"), ElementsAre("mod", "base"));
    EXPECT_THAT(ReadAll("b.txt"), ElementsAre("mod", "base"));
}

TEST_F(Vfs, AlphabeticallyLastArchiveOfAFolderWinsWithoutCase) {
    folder.WriteArchive("pak0.pk3", {{"a.txt", "pak0"}});
    folder.WriteArchive("PAK1.PK3", {{"a.txt", "PAK1"}});
    folder.WriteArchive("pak2.pk3", {{"a.txt", "pak2"}});
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_THAT(ReadAll("a.txt"), ElementsAre("pak2", "PAK1", "pak0"));
}

TEST_F(Vfs, ArchiveFoldersAreLooseFolders) {
    folder.Write("one.pk3dir/a.txt", "one");
    folder.Write("two.PK3DIR/a.txt", "two");
    folder.WriteArchive("z.pk3", {{"a.txt", "archive"}});
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_THAT(ReadAll("a.txt"), ElementsAre("two", "one", "archive"));
    folder.Write("a.txt", "loose");
    EXPECT_EQ(Read("a.txt"), "loose");
}

TEST_F(Vfs, ArchiveExtensionIsTheGames) {
    folder.WriteArchive("a.pk3", {{"a.txt", "pk3"}});
    folder.WriteArchive("b.dpk", {{"b.txt", "dpk"}});
    folder.Write("c.dpkdir/c.txt", "dpkdir");
    vfs.Mount(folder.Root(), "dpk");
    EXPECT_FALSE(vfs.Exists("a.txt"));
    EXPECT_EQ(Read("b.txt"), "dpk");
    EXPECT_EQ(Read("c.txt"), "dpkdir");
}

// ---- Packages that need others ----

using Packages = Vfs;

TEST_F(Packages, WhatDepsNamesComesFirst) {
    folder.Write("pkg/map-x_src.dpkdir/DEPS", "tex-a\n  res-b 1.0 \n\n");
    folder.Write("pkg/map-x_src.dpkdir/a.txt", "map");
    folder.WriteArchive("pkg/tex-a_1.0.dpk", {{"a.txt", "a 1.0"}, {"b.txt", "a 1.0"}});
    folder.WriteArchive("pkg/tex-a_1.10.dpk", {{"a.txt", "a 1.10"}, {"b.txt", "a 1.10"}, {"DEPS", "deep-c"}});
    folder.WriteArchive("pkg/tex-a_1.9.dpk", {{"b.txt", "a 1.9"}});
    folder.WriteArchive("pkg/res-b_1.0.dpk", {{"b.txt", "b 1.0"}, {"c.txt", "b 1.0"}});
    folder.WriteArchive("pkg/res-b_2.0.dpk", {{"c.txt", "b 2.0"}});
    folder.Write("pkg/deep-c_0.dpkdir/c.txt", "deep");
    folder.Write("pkg/deep-c_0.dpkdir/DEPS", "map-x\n");
    folder.Write("pkg/zzz_9.dpkdir/b.txt", "not needed");
    vfs.Mount(folder / "pkg", "dpk");
    EXPECT_EQ(Read("b.txt"), "not needed") << "folders before archives";
    vfs.PreferDependencies(folder / "pkg/map-x_src.dpkdir");
    EXPECT_THAT(ReadAll("a.txt"), ElementsAre("map", "a 1.10", "a 1.0"));
    EXPECT_THAT(ReadAll("b.txt"), ElementsAre("a 1.10", "b 1.0", "not needed", "a 1.9", "a 1.0"));
    EXPECT_THAT(ReadAll("c.txt"), ElementsAre("deep", "b 1.0", "b 2.0"));
    EXPECT_EQ(out.log.WarningCount("missing package"), 0);
}

TEST_F(Packages, AMissingOneIsAWarningWithWhoNeedsIt) {
    folder.Write("src/map-x.dpkdir/DEPS", "none\nres-b 3.0\ntoo many words\nres-b\n");
    folder.WriteArchive("pkg/res-b_1.0.dpk", {{"a.txt", "b"}});
    folder.Write("pkg/a.txt", "loose");
    vfs.Mount(folder / "pkg", "dpk");
    vfs.PreferDependencies(folder / "src/map-x.dpkdir");
    EXPECT_EQ(Read("a.txt"), "b");
    EXPECT_TRUE(vfs.Exists("DEPS")) << "the package of the map is mounted";
    EXPECT_EQ(out.log.WarningCount("missing package"), 2);
    EXPECT_EQ(out.log.WarningCount("package dependencies"), 1);
    EXPECT_THAT(out.text, HasSubstr("map-x.dpkdir needs none, which is in no folder of the game"));
    EXPECT_THAT(out.text, HasSubstr("line 3: expected a package, and its version or nothing"));
}

TEST(PackageNames, VersionsAreThoseOfDebian) {
    EXPECT_EQ(ParsePackageName("map-x_1.2_abc").name, "map-x");
    EXPECT_EQ(ParsePackageName("map-x_1.2_abc").version, "1.2");
    EXPECT_EQ(ParsePackageName("map-x").version, "");
    const char *const kOldToNew[] = {"", "0.9~rc1", "0.9", "0.9a", "0.9+b", "0.10", "1.0", "1.0.1", "src"};
    for (std::size_t i = 1; i < std::size(kOldToNew); ++i) {
        EXPECT_LT(CompareVersions(kOldToNew[i - 1], kOldToNew[i]), 0) << kOldToNew[i];
        EXPECT_GT(CompareVersions(kOldToNew[i], kOldToNew[i - 1]), 0) << kOldToNew[i];
    }
    EXPECT_EQ(CompareVersions("1.01", "1.1"), 0);
    EXPECT_GT(CompareVersions("123456789012345678901", "23456789012345678901"), 0);
}

// ---- Archives ----

TEST_F(Vfs, ArchiveNamesHaveNoCaseAndAnySlash) {
    folder.WriteArchive("a.pk3", {{"Textures\\Base/Wall.TGA", "wall"}});
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_EQ(Read("textures/base/wall.tga"), "wall");
    EXPECT_EQ(Read("TEXTURES\\BASE\\WALL.tga"), "wall");
    EXPECT_THAT(vfs.Location("textures/base/wall.tga"), HasSubstr("a.pk3 :: textures/base/wall.tga"));
    EXPECT_EQ(vfs.Location("textures/base/floor.tga"), "");
}

TEST_F(Vfs, ForbiddenPatternsHideFoldersAndArchives) {
    folder.WriteArchive("game/Old_pak.pk3", {{"a.txt", "old"}});
    folder.WriteArchive("game/new.pk3", {{"b.txt", "new"}});
    folder.Write("game/x1.pk3dir/c.txt", "x1");
    folder.Write("game/x12.pk3dir/d.txt", "x12");
    folder.Write("secret/e.txt", "secret");
    vfs.SetForbidden({"old*", "X?.pk3dir", "sec*et"});
    vfs.Mount(folder / "game", "pk3");
    vfs.Mount(folder / "secret/", "pk3");
    EXPECT_FALSE(vfs.Exists("a.txt"));
    EXPECT_TRUE(vfs.Exists("b.txt"));
    EXPECT_FALSE(vfs.Exists("c.txt"));
    EXPECT_TRUE(vfs.Exists("d.txt"));
    EXPECT_FALSE(vfs.Exists("e.txt"));
}

TEST_F(Vfs, ListsOneFolderOnceAndSorted) {
    folder.Write("scripts/b.shader", "");
    folder.Write("scripts/Z.SHADER", "");
    folder.Write("scripts/note.txt", "");
    folder.Write("scripts/deep/c.shader", "");
    folder.WriteArchive(
        "p.pk3",
        {{"Scripts/B.shader", ""}, {"scripts/a.shader", ""}, {"scripts/deep/d.shader", ""}, {"scriptsx/e.shader", ""}});
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_THAT(vfs.List("scripts", ".shader"), ElementsAre("a.shader", "b.shader", "Z.SHADER"));
    EXPECT_THAT(vfs.List("nowhere", ".shader"), IsEmpty());
}

TEST_F(Vfs, NamesThatLeadOutAreAbsent) {
    folder.Write("secret.txt", "secret");
    folder.WriteArchive("game/a.pk3", {{"../evil.txt", "x"},
                                       {"/abs.txt", "x"},
                                       {"c:/drive.txt", "x"},
                                       {"good.txt", "good"},
                                       {"a/../../b.txt", "x"},
                                       {"bell\a.txt", "x"}});
    vfs.Mount(folder / "game", "pk3");
    for (const std::string &name :
         {std::string("../secret.txt"), std::string("..\\secret.txt"), (folder / "secret.txt").string(),
          std::string(""), std::string("/abs.txt"), std::string("c:/drive.txt"), std::string("../evil.txt"),
          std::string("bell\a.txt"), std::string("a/../good.txt")})
        EXPECT_EQ(Read(name), "(absent)") << name;
    EXPECT_EQ(Read("good.txt"), "good");
}

TEST_F(Vfs, SlashesInFrontAreDroppedAsByEngines) {
    folder.Write("game/textures/a.txt", "loose");
    folder.WriteArchive("game/a.pk3", {{"textures/b.txt", "packed"}});
    vfs.Mount(folder / "game", "pk3");
    for (const std::string_view front : {"/", "//", "\\", "./", "/./"}) {
        EXPECT_EQ(Read(fmt::format("{}textures/a.txt", front)), "loose") << front;
        EXPECT_EQ(Read(fmt::format("{}textures\\b.txt", front)), "packed") << front;
    }
    EXPECT_EQ(Read("textures//a.txt"), "loose");
    EXPECT_EQ(Read("textures/./b.txt"), "packed");
    EXPECT_EQ(Read("/../a.pk3"), "(absent)");
}

TEST_F(Vfs, MissingFolderIsFineAndFoldersAreNoFiles) {
    vfs.Mount(folder / "nowhere", "pk3");
    folder.Write("game/textures/a.txt", "");
    vfs.Mount(folder / "game", "pk3");
    EXPECT_FALSE(vfs.Exists("textures"));
    EXPECT_TRUE(vfs.Exists("textures/a.txt"));
    EXPECT_EQ(Read("textures/a.txt"), "");
}

TEST_F(Vfs, DamagedEntryIsAWarningAndTheNextOccurrenceCounts) {
    folder.WriteArchive("b.pk3", {{"a.txt", "the text of the entry"}}, 0);
    folder.WriteArchive("a.pk3", {{"a.txt", "whole"}});
    std::string bytes = folder.ReadBack("b.pk3");
    bytes[bytes.find("text of")] = 'T';
    folder.Write("b.pk3", bytes);
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_THROW(vfs.ReadStrictly("a.txt"), Error);
    EXPECT_EQ(vfs.ReadStrictly("b.txt"), std::nullopt);
    EXPECT_EQ(out.log.WarningCount("unreadable game file"), 0);
    EXPECT_EQ(Read("a.txt"), "whole");
    EXPECT_EQ(out.log.WarningCount("unreadable game file"), 1);
    EXPECT_THAT(out.text, HasSubstr("b.pk3 :: a.txt"));
}

TEST_F(Vfs, AnEncryptedEntryIsNamedAsSuch) {
    folder.WriteArchive("a.pk3", {{"a.txt", "secret"}});
    std::string bytes = folder.ReadBack("a.pk3");
    bytes[bytes.find("PK\x01\x02") + 8] |= 1; // flags of the central record
    folder.Write("a.pk3", bytes);
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_EQ(Read("a.txt"), "(absent)");
    EXPECT_THAT(out.text, HasSubstr("a.pk3 :: a.txt: the entry is encrypted, expected plain data"));
}

TEST_F(Vfs, WhatTheSystemCannotLookAtIsAWarningAndTheRestCounts) {
    folder.WriteArchive("game/a.pk3", {{"a.txt", "archive"}, {"scripts/a.shader", ""}});
    std::error_code failed;
    for (const char *circle : {"a.txt", "scripts", "b.pk3"})
        std::filesystem::create_symlink(circle, folder / fmt::format("game/{}", circle), failed);
    if (failed)
        GTEST_SKIP() << "no symbolic links here";
    vfs.Mount(folder / "game", "pk3");
    EXPECT_EQ(Read("a.txt"), "archive");
    EXPECT_THAT(vfs.List("scripts", ".shader"), ElementsAre("a.shader"));
    EXPECT_GE(out.log.WarningCount("unreadable game file"), 1);
    EXPECT_GE(out.log.WarningCount("unreadable game folder"), 1);
    EXPECT_EQ(out.log.WarningCount("unreadable archive"), 1);
    EXPECT_THAT(out.text, HasSubstr("b.pk3"));
}

TEST_F(Vfs, FileThatIsNoArchiveIsAWarning) {
    folder.Write("a.pk3", "this is no archive");
    folder.Write("b.pk3", "");
    std::filesystem::create_directory(folder / "c.pk3");
    folder.WriteArchive("d.pk3", {{"a.txt", "good"}});
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_EQ(Read("a.txt"), "good");
    EXPECT_EQ(out.log.WarningCount("unreadable archive"), 3);
}

TEST_F(Vfs, LyingSizesAreNotBelieved) {
    folder.WriteArchive("a.pk3", {{"a.txt", "0123456789"}});
    const std::string whole = folder.ReadBack("a.pk3");
    // Uncompressed size: at 24 of the central record, which starts with PK 1 2.
    for (const std::string &size : {std::string("\xFF\xFF\xFF\x0F", 4), std::string("\xFF\xFF\xFF\x7F", 4),
                                    std::string("\x0B\0\0\0", 4), std::string("\x09\0\0\0", 4)}) {
        std::string bytes = whole;
        bytes.replace(bytes.find("PK\x01\x02") + 24, 4, size);
        folder.Write("a.pk3", bytes);
        VirtualFileSystem other(out.log);
        other.Mount(folder.Root(), "pk3");
        EXPECT_TRUE(other.Exists("a.txt"));
        EXPECT_FALSE(other.Read("a.txt").has_value());
    }
}

TEST_F(Vfs, NoChangedOrMissingByteOfAnArchiveDoesHarm) {
    const std::string text(300, 'x');
    folder.WriteArchive("whole.zip", {{"a.txt", text}, {"b/c.txt", "0123456789"}});
    const std::string whole = folder.ReadBack("whole.zip");
    const auto check = [&](const std::string &bytes) {
        folder.Write("a.pk3", bytes);
        VirtualFileSystem other(out.log);
        other.Mount(folder.Root(), "pk3");
        const auto a = other.Read("a.txt");
        EXPECT_TRUE(!a || Text(*a) == text);
    };
    for (std::size_t i = 0; i < whole.size(); ++i) {
        check(whole.substr(0, i));
        for (const char mask : {'\x01', '\x80', '\xFF'}) {
            std::string bytes = whole;
            bytes[i] = char(bytes[i] ^ mask);
            check(bytes);
        }
    }
    check(whole);
    EXPECT_GT(out.log.WarningCount("unreadable game file"), 0);
}

// What an archive may have besides entries, and what goes beyond the plain format.
TEST_F(Vfs, UnusualArchivesAreReadAll) {
    const GameFolder::Entries entries = {{"a.txt", "first"}, {std::string(300, 'n'), "long"}, {"b.txt", "second"}};
    folder.WriteArchive("whole.zip", entries);
    const std::string whole = folder.ReadBack("whole.zip");
    const std::size_t directory = whole.find("PK\x01\x02"), end = whole.find("PK\x05\x06");
    std::string commented = whole, extended = whole;
    commented.replace(end + 20, 2, std::string("\x03\0", 2)); // size of the archive's comment
    commented += "end";
    // An extra field of 8 bytes of the first header, and a comment of 2; the directory grows by 10.
    extended.replace(directory + 30, 4, std::string("\x08\0\x02\0", 4));
    extended.insert(directory + 46 + 5, "\x99\x99\x04\0abcdcc", 10);
    extended[end + 10 + 12] = char(extended[end + 10 + 12] + 10);
    for (const std::string &bytes : {whole, commented, extended, "bytes before it" + whole}) {
        folder.Write("a.pk3", bytes);
        VirtualFileSystem other(out.log);
        other.Mount(folder.Root(), "pk3");
        const auto a = other.Read("a.txt"), b = other.Read("b.txt");
        ASSERT_TRUE(a && b);
        EXPECT_EQ(Text(*a) + Text(*b), "firstsecond");
        EXPECT_FALSE(other.Exists(entries[1].first));
    }
    EXPECT_EQ(out.log.WarningCount("unreadable archive"), 0);
}

TEST_F(Vfs, DamagedDirectoryIsAWarningThatCountsTheEntriesBefore) {
    folder.WriteArchive("a.pk3", {{"a.txt", "first"}, {"b.txt", "second"}, {"c.txt", "third"}});
    std::string bytes = folder.ReadBack("a.pk3");
    bytes[bytes.rfind("PK\x01\x02")] = 'X';
    folder.Write("a.pk3", bytes);
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_FALSE(vfs.Exists("a.txt"));
    EXPECT_EQ(out.log.WarningCount("unreadable archive"), 1);
    EXPECT_THAT(out.text, HasSubstr("the directory of the archive is damaged after 2 entries"));
}

TEST_F(Vfs, LargeEntryComesWhole) {
    std::string text(3'000'000, '\0');
    for (std::size_t i = 0; i < text.size(); ++i)
        text[i] = char(i * i >> 8);
    folder.WriteArchive("a.pk3", {{"a.bin", text}, {"zero.bin", std::string(1'000'000, '\0')}});
    vfs.Mount(folder.Root(), "pk3");
    EXPECT_TRUE(Read("a.bin") == text);
    EXPECT_EQ(Read("zero.bin").size(), 1'000'000u);
}

TEST_F(Vfs, ThreadsReadTheSameArchive) {
    GameFolder::Entries entries;
    for (int i = 0; i < 20; ++i)
        entries.emplace_back(fmt::format("{}.txt", i), std::string(10'000, char('a' + i)));
    folder.WriteArchive("a.pk3", entries);
    vfs.Mount(folder.Root(), "pk3");
    std::atomic<int> wrong = 0;
    {
        std::vector<std::jthread> threads;
        for (int t = 0; t < 4; ++t)
            threads.emplace_back([&, t] {
                for (std::size_t i = 0; i < 100; ++i) {
                    const auto &[name, text] = entries[(i * 7 + std::size_t(t)) % entries.size()];
                    const auto bytes = vfs.Read(name);
                    wrong += !bytes || Text(*bytes) != text;
                }
            });
    }
    EXPECT_EQ(wrong, 0);
}

} // namespace
} // namespace q3
