// GPL-2.0-or-later. -editorfiles, and the calls that editors make besides their menus.
#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/cli/documentation.h"
#include "q3map2/cli/presets.h"
#include "q3map2/editors/editor_files.h"
#include "q3map2/stages/stages.h"
#include "tests/support/run_program.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;

using EditorFilesTest = ProgramTest;

/// To write them again: q3map2 -editorfiles tools/generated/editors
TEST_F(EditorFilesTest, TheRepositoryHasWhatTheProgramWrites) {
    RunWell("-editorfiles " + (folder_ / "out").string());
    int files = 0;
    for (const auto &entry : std::filesystem::recursive_directory_iterator(folder_ / "out"))
        if (entry.is_regular_file()) {
            ++files;
            const auto name = std::filesystem::relative(entry.path(), folder_ / "out");
            EXPECT_EQ(ReadTextFile(entry.path()),
                      ReadTextFile(std::filesystem::path(SOURCE) / "tools/generated/editors" / name))
                << name;
        }
    EXPECT_EQ(files, 5);
}

TEST_F(EditorFilesTest, NameTheGame) {
    RunWell("-game quakelive -editorfiles " + (folder_ / "out").string());
    for (const char *name : {"netradiant/default_build_menu.xml", "gtkradiant/default_project.proj",
                             "trenchbroom/CompilationProfiles.cfg"})
        EXPECT_THAT(ReadTextFile(folder_ / "out" / name), HasSubstr("-game quakelive -fs_basepath ")) << name;
}

TEST_F(EditorFilesTest, NeedOneFolder) {
    ExpectError("-editorfiles", "usage: q3map2 -editorfiles DIR");
    const std::string belowAFile = (Map(".map") / "folder").string();
    ExpectError("-editorfiles " + belowAFile, belowAFile);
}

TEST(EditorSteps, OfEveryPresetAreFoundSound) {
    std::vector<std::string_view> presets;
    for (const Preset &preset : Presets())
        presets.push_back(preset.name);
    const std::vector<EditorBuild> builds = EditorBuilds(presets);
    ASSERT_GE(builds.size(), 3 * presets.size() + 1);
    const std::string page = ReadTextFile(std::filesystem::path(SOURCE) / "docs/guide/editors.md");
    for (const EditorBuild &build : builds) {
        EXPECT_THAT(page, HasSubstr("\n| " + build.label + " | "));
        for (const std::string &step : build.steps)
            EXPECT_NO_THROW(CheckBuildStep(Stages(), step)) << step;
    }
}

TEST(EditorSteps, WithWhatThereIsNotAreErrors) {
    for (const char *step : {"-light -zork", "-ligth -preset draft", "-light -preset nice", "-vis -preset draft -sh",
                             "-light -gridsh 64 64", "-light stray", "-preset draft"})
        EXPECT_THROW(CheckBuildStep(Stages(), step), Error) << step;
}

TEST_F(EditorFilesTest, QuotesThatAnEditorLeavesAroundWordsAreNoPartOfThem) {
    const Outcome outcome = RunProgramFile({"-fs_basepath", fmt::format("\"{}\"", (folder_ / "base").string()), "-info",
                                            "\"" + Map(".bsp").string() + "\""},
                                           folder_.Root());
    EXPECT_EQ(outcome.status, 0) << outcome.text;
}

/// The call with which NetRadiant finds the faces that nobody sees: the selected brushes, six around them, a place to
/// stand, and selected entities.
TEST_F(EditorFilesTest, AutoCaulkNamesTheFacesOfTheSelection) {
    const auto box = [](int x0, int y0, int z0, int x1, int y1, int z1) {
        const auto side = [](int ax, int ay, int az, int bx, int by, int bz, int cx, int cy, int cz) {
            return fmt::format("( {} {} {} ) ( {} {} {} ) ( {} {} {} ) wall 0 0 0 0.5 0.5 0 0 0\n", ax, ay, az, bx, by,
                               bz, cx, cy, cz);
        };
        // West, east, south, north, bottom, top.
        return "{\n" + side(x0, y0, z0, x0, y1, z0, x0, y0, z1) + side(x1, y0, z0, x1, y0, z1, x1, y1, z0) +
               side(x0, y0, z0, x0, y0, z1, x1, y0, z0) + side(x0, y1, z0, x1, y1, z0, x0, y1, z1) +
               side(x0, y0, z0, x1, y0, z0, x0, y1, z0) + side(x0, y0, z1, x0, y1, z1, x1, y0, z1) + "}\n";
    };
    std::string map = "{\n\"classname\" \"worldspawn\"\n";
    // Two blocks that share a face, the second with a far plane that cuts nothing off.
    map += box(0, 0, 0, 64, 64, 64);
    std::string second = box(64, 0, 0, 128, 64, 64);
    second.insert(2, "( 0 0 900 ) ( 0 64 900 ) ( 64 0 900 ) wall 0 0 0 0.5 0.5 0 0 0\n");
    map += second;
    const int low = -1024, high = 1152;
    map += box(low - 8, low, low, low, high, high) + box(high, low, low, high + 8, high, high) +
           box(low, low - 8, low, high, low, high) + box(low, high, low, high, high + 8, high) +
           box(low, low, low - 8, high, high, low) + box(low, low, high, high, high, high + 8);
    map += "}\n{\n\"classname\" \"info_player_start\"\n\"origin\" \"32 32 256\"\n}\n";
    folder_.Write("base/baseq3/maps/demo_ac.map", map);
    const std::string base = (folder_ / "base").string() + "/";
    const Outcome outcome = RunProgramFile({"-game", "quake3", "-fs_basepath", base, "-fs_homepath", base, "-fs_game",
                                            "baseq3", "-autocaulk", "-fulldetail", (maps_ / "demo_ac.map").string()},
                                           folder_.Root());
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_THAT(ReadTextFile(maps_ / "demo_ac.caulk"), HasSubstr("\n1 c-----\n0 -c----\n"));
    EXPECT_FALSE(std::filesystem::exists(maps_ / "demo_ac.bsp"));
}

} // namespace

} // namespace q3::test
