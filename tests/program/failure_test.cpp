// GPL-2.0-or-later. The program when something is wrong: exit status, one clear line, the old map untouched.
#include "common/error.h"
#include "common/files/files.h"
#include "common/platform/platform.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/stages/written_map.h"
#include "tests/support/file_size_limit.h"
#include "tests/support/run_program.h"
#include "tests/support/this_system.h"

#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <map>

namespace q3::test {

namespace {

class FailureTest : public ProgramTest {
  protected:
    void Append(const std::filesystem::path &path, std::string_view text) {
        std::ofstream(path, std::ios::binary | std::ios::app) << text;
    }
    void Overwrite(const std::filesystem::path &path, std::string_view text) {
        std::ofstream(path, std::ios::binary) << text;
    }
    void Patch(std::size_t at, std::int32_t value) {
        auto file = MapBytes();
        std::memcpy(file.data() + at, &value, 4);
        ReplaceFile(Map(".bsp"), file);
    }
    void ReplaceInShader(std::string_view from, std::string_view to) {
        std::string text = ReadTextFile(game_ / "scripts/demo.shader");
        const std::size_t at = text.find(from);
        ASSERT_NE(at, std::string::npos);
        Overwrite(game_ / "scripts/demo.shader", text.replace(at, from.size(), to));
    }
};

TEST_F(FailureTest, NothingToDo) {
    EXPECT_EQ(RunProgramFile({}, folder_.Root()).status, 1);
    ExpectError("", "no arguments");
    ExpectError("-vlight MAP", "-vlight is not a stage");
    ExpectError("-bsp", "usage: q3map2");
    ExpectError("-light", "usage: q3map2");
    ExpectError("-shpreview", "usage: q3map2");
    EXPECT_EQ(Run("-info").status, 255);
}

TEST_F(FailureTest, MapThatIsNotThere) {
    const std::string nowhere = (folder_ / "nowhere/at/all.bsp").string();
    ExpectError("-light " + nowhere, nowhere);
    ExpectError("-info " + nowhere, nowhere);
    ExpectError("-json -unpack " + nowhere, nowhere);
    ExpectError("-light " + maps_.string(), "maps is a folder, expected a map, such as " + Map(".bsp").string());
}

#ifndef _WIN32 // where nothing but the program itself raises an exception in it
TEST_F(FailureTest, ACrashIsReportedAndKeepsItsSignal) {
    for (const int signal : {SIGSEGV, SIGABRT}) {
        // Long enough to be in a pass when the signal comes.
        const auto before = MapBytes();
        const Outcome outcome =
            Run("-light -sh -gridsh 8 8 8 -samples 4 -bounce 4 MAP", {.bytes = 400, .signal = signal});
        if (kIsSanitized) // whose own report comes instead
            continue;
        EXPECT_EQ(outcome.signal, signal) << outcome.text;
        EXPECT_TRUE(outcome.Printed(signal == SIGABRT ? "Abort (SIGABRT)" : "Invalid memory access (SIGSEGV)"));
        for (const std::string_view part : {"commit   ", "Embree   ", "-light -sh -gridsh 8 8 8", "file     ",
                                            "demo.bsp", "in pass  ", "Please report"})
            EXPECT_TRUE(outcome.Printed(part)) << part << '\n' << outcome.text;
        EXPECT_EQ(MapBytes(), before);
    }
}
#endif

TEST_F(FailureTest, CutMaps) {
    const auto whole = MapBytes();
    for (const std::size_t size : {std::size_t(0), std::size_t(3), std::size_t(8), std::size_t(100), std::size_t(200),
                                   whole.size() / 2, whole.size() - 1}) {
        ReplaceFile(Map(".bsp"), std::span(whole).first(size));
        ExpectError("-light -sh MAP", "demo.bsp");
    }
}

TEST_F(FailureTest, AKilledRunLeavesWholeFiles) {
    constexpr std::string_view kLight = "-light -external -lightmapsize 256 MAP";
    constexpr std::size_t kKills = 20;
    const auto pages = [&] {
        std::map<std::filesystem::path, std::vector<std::byte>> found;
        if (std::filesystem::exists(Map("")))
            for (const auto &entry : std::filesystem::directory_iterator(Map("")))
                if (entry.path().extension() == ".tga")
                    found[entry.path()] = ReadFile(entry.path());
        return found;
    };
    const auto before = MapBytes();
    const std::size_t printed = RunWell(kLight).text.size();
    const auto after = MapBytes();
    const auto lit = pages();
    ASSERT_NE(before, after);
    ASSERT_FALSE(lit.empty());
    std::size_t killed = 0;
    for (std::size_t i = 0; i < kKills; ++i) {
        ReplaceFile(Map(".bsp"), before);
        std::filesystem::remove_all(Map(""));
        killed += Run(kLight, {.bytes = printed * i / kKills}).status == -1;
        const auto now = MapBytes();
        EXPECT_TRUE(now == before || now == after) << "killed after " << printed * i / kKills << " bytes of output";
        for (const auto &[path, bytes] : pages())
            EXPECT_TRUE(lit.contains(path) && bytes == lit.at(path)) << path;
        EXPECT_TRUE(now != after || pages() == lit) << "the map is written after what it needs";
    }
    EXPECT_GT(killed, 0u);
}

TEST_F(FailureTest, CorruptLumps) {
    const auto whole = MapBytes();
    const auto surfaces = std::size_t(IntOf(whole, 8 + 8 * 13));
    struct Damage {
        std::size_t at;
        std::int32_t value;
    };
    for (const Damage &damage : {Damage{0, 0x12345678},
                                 {4, 99},
                                 {8 + 8, 0x7fffffff},
                                 {12 + 8, -4},
                                 {12 + 8 * 13, 103},
                                 {surfaces, 1 << 20},
                                 {surfaces + 12, -1},
                                 {surfaces + 20, 0x7fffffff}}) {
        ReplaceFile(Map(".bsp"), whole);
        Patch(damage.at, damage.value);
        ExpectError("-light -sh MAP", "demo.bsp");
    }
}

TEST_F(FailureTest, JsonFolderWithAMissingOrDamagedFile) {
    RunWell("-json -unpack MAP");
    const auto planes = Map("") / "planes.json";
    const std::string text = ReadTextFile(planes);
    Overwrite(planes, text.substr(0, text.size() / 2));
    ExpectError("-json -pack MAP", "planes.json");
    std::filesystem::remove(planes);
    ExpectError("-json -pack MAP", "planes.json");
    EXPECT_FALSE(std::filesystem::exists(Map("_json.bsp")));
    std::filesystem::remove_all(Map(""));
    ExpectError("-json -pack MAP", "demo");
    ExpectError("-json -pack -unpack MAP", "exclude each other");
}

TEST_F(FailureTest, SurfaceFileOfAnotherMap) {
    Overwrite(Map(".srf"), "default\n{\n\tcastShadows 1\n}\n\n9999 // planar\n{\n\tshader textures/demo/wall\n}\n");
    ExpectError("-light MAP", "demo.srf");
    Overwrite(Map(".srf"), "default\n{\n\tcastShadows 1\n");
    ExpectError("-light MAP", "demo.srf");
}

TEST_F(FailureTest, MapSourceWithUnbalancedBraces) {
    const std::string text = ReadTextFile(Map(".map"));
    Overwrite(Map(".map"), text + "{\n\"classname\" \"light\"\n");
    ExpectError("-light MAP", "demo.map");
    Overwrite(Map(".map"), text + "}\n");
    ExpectError("-light MAP", "demo.map");
}

TEST_F(FailureTest, LightStyleOutOfRange) {
    Append(Map(".map"), "{\n\"classname\" \"light\"\n\"style\" \"999\"\n}\n");
    const Outcome outcome = RunWell("-light -fast -nogrid MAP");
    EXPECT_TRUE(outcome.Printed("_style \"999\": expected a number from 0 to 254; 254 is used")) << outcome.text;
}

TEST_F(FailureTest, OptionsWithBadValues) {
    ExpectError("-light -sh -gridscalesh 0 MAP", "-gridscalesh");
    ExpectError("-light -sh -gridsh 0 0 0 MAP", "-gridsh");
}

TEST_F(FailureTest, MapThatCannotBeWrittenWholeStays) {
    if (!FileSizeLimit::kExists)
        GTEST_SKIP() << kNoSizeLimit;
    const std::size_t size = MapBytes().size();
    for (const std::size_t limit : {std::size_t(0), std::size_t(4096), size / 2}) {
        const FileSizeLimit full(limit);
        ExpectError("-light MAP", "demo.bsp: cannot write");
        ExpectError("-json -unpack MAP", "cannot write");
    }
}

TEST_F(FailureTest, FilesOfJsonThatCannotAllBeWrittenStay) {
    if (!FileSizeLimit::kExists)
        GTEST_SKIP() << kNoSizeLimit;
    const auto files = [&] {
        std::map<std::filesystem::path, std::vector<std::byte>> found;
        if (std::filesystem::exists(Map("")))
            for (const auto &entry : std::filesystem::directory_iterator(Map("")))
                found[entry.path()] = ReadFile(entry.path());
        return found;
    };
    const auto fail = [&] {
        const FileSizeLimit full(8192); // less than the largest of them, more than others
        ExpectError("-json -unpack MAP", "cannot write");
    };
    fail();
    EXPECT_FALSE(std::filesystem::exists(Map("")));
    RunWell("-json -unpack MAP");
    const auto before = files();
    RunWell("-light -fast MAP");
    fail();
    EXPECT_EQ(files(), before);
}

TEST_F(FailureTest, AnIncompleteLogFileIsAWarning) {
    if (!FileSizeLimit::kExists)
        GTEST_SKIP() << kNoSizeLimit;
    const std::string log = (folder_ / "log.txt").string();
    const FileSizeLimit full(100);
    const Outcome outcome = RunWell("-log " + log + " -info MAP");
    EXPECT_TRUE(outcome.Printed("-log " + log + ": a part is missing")) << outcome.text;
}

TEST_F(FailureTest, TargetsAreLookedAtBeforeTheWork) {
    const std::string none = (folder_ / "none" / "x").string();
    ExpectError("-light -sh -shpreview " + none + ".png MAP", "the folder " + (folder_ / "none").string());
    ExpectError("-shreport -o " + none + ".html MAP", "the folder " + (folder_ / "none").string());
    std::filesystem::create_directories(maps_ / "demo_s.bsp");
    for (const std::string_view stage : {"-scale 2 MAP", "-bsp -report /nowhere/at/all/r.json MAP"})
        ExpectError(stage, "cannot write");
    EXPECT_FALSE(Run("-scale 2 MAP").Printed("Loading"));
}

/// A stage whose map is written by another run while it works.
TEST(FileGuardTest, AnInputThatChangesMeanwhileIsAnError) {
    const GameFolder folder;
    folder.Write("x.bsp", "old");
    KeptLog out;
    FileGuard guard(false, out.log), forced(true, out.log);
    for (FileGuard *each : {&guard, &forced}) {
        each->Needs(folder / "x.bsp");
        each->Reads(folder / "x.srf");
        EXPECT_NO_THROW(each->CheckUnchanged());
    }
    ReplaceTextFile(folder / "x.bsp", "new"); // as long as before
    try {
        guard.CheckUnchanged();
        FAIL() << "the change was not noticed";
    } catch (const Error &error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("x.bsp was written while this run was working"));
        EXPECT_THAT(error.what(), testing::HasSubstr("-force"));
    }
    forced.CheckUnchanged();
    EXPECT_THAT(out.text, testing::HasSubstr("WARNING: "));
}

TEST(FileGuardTest, AFileThatAppearsOrGoesCountsAsWell) {
    for (const std::string name : {"x", "gr\u00f6\u00dfe"}) {
        const GameFolder folder;
        folder.Write(name + ".map", "{}");
        KeptLog out;
        FileGuard appears(false, out.log), goes(false, out.log);
        appears.Reads(folder / (name + ".srf"));
        goes.Reads(folder / (name + ".map"));
        folder.Write(name + ".srf", "default");
        std::filesystem::remove(folder / (name + ".map"));
        EXPECT_THROW(appears.CheckUnchanged(), Error);
        EXPECT_THROW(goes.CheckUnchanged(), Error);
    }
}

/// The light stage reads x.MAP where there is no x.map.
TEST(FileGuardTest, ANewerSourceIsFoundInAnyCase) {
    if (kIsWindows)
        GTEST_SKIP() << kNoCase;
    const GameFolder folder;
    folder.Write("x.bsp", "old");
    folder.Write("x.MAP", "{}");
    std::filesystem::last_write_time(folder / "x.bsp",
                                     std::filesystem::last_write_time(folder / "x.MAP") - std::chrono::hours(1));
    KeptLog out;
    WarnIfSourceIsNewer(FilesOf(folder / "x.bsp"), out.log);
    EXPECT_THAT(out.text, testing::HasSubstr("x.MAP is newer than x.bsp"));
}

TEST(FileGuardTest, NoDiskHasRoomForAnExabyte) {
    const GameFolder folder;
    KeptLog out;
    constexpr std::uint64_t kExabyte = 1000000000000000000;
    EXPECT_THROW(FileGuard(false, out.log).Writes(folder / "x.bsp", kExabyte), Error);
    EXPECT_THROW(FileGuard(false, out.log).WritesInto(folder / "maps/x", kExabyte), Error);
    EXPECT_NO_THROW(FileGuard(true, out.log).Writes(folder / "x.bsp", kExabyte));
    EXPECT_THAT(out.text, testing::HasSubstr("free on this disk"));
}

TEST(FileGuardTest, FoldersOfOneDiskShareItsSpace) {
    const GameFolder folder;
    KeptLog out;
    std::filesystem::create_directories(folder / "a");
    std::filesystem::create_directories(folder / "b");
    const std::uint64_t most = std::filesystem::space(folder / "a").available / 8 * 5;
    FileGuard guard(false, out.log);
    EXPECT_NO_THROW(guard.Writes(folder / "a/x.bsp", most));
    EXPECT_THROW(guard.Writes(folder / "b/x.bsp", most), Error);
}

/// The measured rule of docs/guide/troubleshooting.md: the file, and its lumps without BSPX once more.
TEST(EngineMemoryTest, AMapBeyondTheDefaultOfItsEnginesSaysWhatToDo) {
    const GameFolder folder;
    folder.Write("x.bsp", "");
    Bsp bsp;
    bsp.bspx = {{"OTHER", std::vector<std::byte>(30000000)}};
    EXPECT_EQ(EngineMemoryFor(bsp, 40000000), EngineMemoryFor({}, 40000000) - 30000000) << "BSPX is not copied";
    const auto warning = [&](std::uint64_t bytes, std::string_view game) {
        std::filesystem::resize_file(folder / "x.bsp", bytes); // takes no room on the disk
        KeptLog out;
        WarnOfEngineMemory(folder / "x.bsp", bsp, *FindGame(game), out.log);
        return out.text;
    };
    EXPECT_EQ(warning(60000000, "quake3"), "");
    EXPECT_THAT(warning(90000000, "quake3"), testing::HasSubstr("+set com_hunkMegs 192"));
    EXPECT_EQ(warning(90000000, "xonotic"), "") << "its engine has no such limit";
}

TEST_F(FailureTest, FolderWhereAFileMustGo) {
    std::filesystem::create_directories(Map(".srf") / "inner");
    ExpectError("-meta " + Map(".map").string(), "demo.srf: cannot write: not a regular file");
    std::filesystem::remove_all(Map(".srf"));
    Overwrite(Map(""), "where the pages would go");
    ExpectError("-light -external -lightmapsize 256 MAP", Map("").string());
}

TEST_F(FailureTest, ArchiveWithADamagedEntryIsAWarning) {
    const std::string shader = "textures/demo/extra\n{\n\tq3map_surfacelight 5\n}\n";
    folder_.WriteArchive("base/baseq3/broken.pk3", {{"scripts/extra.shader", shader}}, 0);
    std::string archive = ReadTextFile(game_ / "broken.pk3");
    const std::size_t at = archive.find(shader);
    ASSERT_NE(at, std::string::npos);
    archive[at + 5] = '!';
    Overwrite(game_ / "broken.pk3", archive);
    Append(game_ / "scripts/shaderlist.txt", "extra\n");
    const Outcome outcome = RunWell("-light MAP");
    EXPECT_TRUE(outcome.Printed("WARNING")) << outcome.text;
    EXPECT_TRUE(outcome.Printed("broken.pk3")) << outcome.text;
    Overwrite(game_ / "broken.pk3", archive.substr(0, 20));
    EXPECT_TRUE(RunWell("-light MAP").Printed("broken.pk3"));
}

TEST_F(FailureTest, MissingShadersAndImagesAreNoErrors) {
    ReplaceInShader("q3map_lightRGB 1 0.75 0.45", "q3map_lightImage textures/none/such.tga");
    ReplaceInShader("q3map_skyLight 60 3", "q3map_skyLight 60 3\n\tskyParms env/none - -");
    const Outcome images = RunWell("-light -sh MAP");
    EXPECT_TRUE(images.Printed("WARNING")) << images.text;
    EXPECT_TRUE(images.Printed("env/none"));
    std::filesystem::remove_all(game_ / "scripts");
    const Outcome scripts = RunWell("-light -sh MAP");
    EXPECT_TRUE(scripts.Printed("0 shaders defined"));
    EXPECT_TRUE(scripts.Printed("0 diffuse (area) lights"));
}

} // namespace

} // namespace q3::test
