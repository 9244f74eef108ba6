// GPL-2.0-or-later. The path of a map on the command line: how it may be written, and what is said if there is none.
#include "common/files/files.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/shader/games.h"
#include "tests/support/run_program.h"
#include "tests/support/this_system.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

namespace fs = std::filesystem;

using testing::AllOf;
using testing::HasSubstr;

class PathsTest : public ProgramTest {
  protected:
    /// The demo's source under another name.
    fs::path CopySource(std::string_view name) {
        fs::copy_file(Map(".map"), maps_ / name);
        return maps_ / name;
    }
    std::string ErrorOf(std::string_view words) {
        const Outcome outcome = Run(words);
        EXPECT_EQ(outcome.status, 1) << words;
        const std::vector<std::string> lines = outcome.ErrorLines();
        EXPECT_EQ(lines.size(), 1u) << outcome.text;
        return lines.empty() ? "" : Slashed(lines.front());
    }
};

TEST_F(PathsTest, ADotInTheNameIsNoExtension) {
    for (const std::string name : {"my.map.v2", "ctf.1"}) {
        CopySource(name + ".map");
        const std::string path = (maps_ / name).string();
        RunWell("-meta " + path);
        RunWell("-vis -saveprt " + path);
        const Outcome light = RunWell("-light -onlygrid " + path);
        EXPECT_TRUE(light.Printed("Loading " + path + ".srf")) << light.text;
        EXPECT_TRUE(light.Printed("Loading " + path + ".map")) << light.text;
        RunWell("-exportents " + path);
        for (const std::string_view end : {".bsp", ".srf", ".prt", ".ent"})
            EXPECT_TRUE(fs::is_regular_file(maps_ / (name + std::string(end)))) << name << end;
    }
    EXPECT_FALSE(fs::exists(maps_ / "ctf.bsp"));
    EXPECT_FALSE(fs::exists(maps_ / "my.bsp"));
}

TEST_F(PathsTest, CapitalsInTheExtension) {
    if (kIsWindows)
        GTEST_SKIP() << kNoCase;
    CopySource("X.MAP");
    const std::string name = (maps_ / "X").string();
    RunWell("-meta " + name + ".MAP");
    EXPECT_TRUE(fs::exists(maps_ / "X.bsp"));
    for (const std::string_view extension : {"bsp", "prt", "srf"}) {
        std::string capitals(extension);
        for (char &c : capitals)
            c = char(c - 'a' + 'A');
        fs::rename(maps_ / fmt::format("X.{}", extension), maps_ / fmt::format("X.{}", capitals));
    }
    EXPECT_TRUE(RunWell("-vis " + name + ".BSP").Printed("X.PRT"));
    EXPECT_TRUE(RunWell("-light -onlygrid " + name + ".bsp").Printed("X.SRF"));
    EXPECT_FALSE(fs::exists(maps_ / "X.bsp")) << "the file that is there is replaced";
}

/// The lines of build tools that keep sources and results apart.
TEST_F(PathsTest, EveryStageTakesFilesFromTheirPlaces) {
    folder_.Write("out/maps/.keep", "");
    const std::string source = CopySource("apart.map").string(), bsp = (folder_ / "out/maps/built.bsp").string();
    const std::string srf = (folder_ / "out/s.srf").string(), prt = (folder_ / "out/p.prt").string();
    const std::string places = " -bspfile " + bsp + " ", portals = "-prtfile " + prt + " ";
    RunWell("-bsp -meta " + portals + "-srffile " + srf + places + source);
    EXPECT_THAT(ErrorOf("-vis" + places + source), HasSubstr(Slashed((maps_ / "apart.prt").string()) + " is missing"));
    EXPECT_TRUE(RunWell("-vis -fast -saveprt " + portals + places + source).Printed("Loading " + prt));
    EXPECT_TRUE(fs::exists(prt));
    RunWell("-vis " + portals + places + source);
    EXPECT_FALSE(fs::exists(prt));
    const Outcome light = RunWell("-light -fast -external -srffile " + srf + places + source);
    for (const std::string &file : {source, srf, bsp})
        EXPECT_TRUE(light.Printed("Loading " + file + "\n")) << light.text;
    EXPECT_TRUE(fs::exists(folder_ / "out/maps/built/lm_0000.tga"));
    EXPECT_THAT(ErrorOf("-light" + places + (maps_ / "none.map").string()), HasSubstr("none.map does not exist"));
    EXPECT_THAT(ErrorOf("-light -bspfile " + bsp + "x.bsp " + source), HasSubstr("built.bspx.bsp does not exist"));
    for (const char *extension : {".bsp", ".srf", ".prt"})
        EXPECT_FALSE(fs::exists(maps_ / ("apart" + std::string(extension)))) << extension;
    const std::string built = folder_.ReadBack("out/maps/built.bsp");
    EXPECT_THAT(built, HasSubstr("-bsp -meta; -vis -fast -saveprt; -vis; -light -fast -external\""));
    EXPECT_EQ(built.find(folder_.Root().string()), built.npos) << "bytes depend on the folder";
}

TEST_F(PathsTest, TheNameInOtherCaseIsProposed) {
    if (kIsWindows)
        GTEST_SKIP() << kNoCase;
    const std::string map = Map(".map").string(), wrong = (maps_ / "Demo.map").string();
    EXPECT_EQ(ErrorOf("-meta " + wrong), wrong + " does not exist; did you mean " + map + "?");
    // Even where there are no game files at all.
    EXPECT_THAT(RunProgramFile({"-fs_basepath", "/nope", "-meta", wrong}, folder_.Root()).ErrorLines().at(0),
                HasSubstr("did you mean " + map));
}

TEST_F(PathsTest, WhatMayHaveBeenMeantIsProposed) {
    const std::string bsp = Slashed(Map(".bsp").string());
    const auto wrong = [&](std::string_view name) { return Slashed((maps_ / name).string()); };
    EXPECT_EQ(ErrorOf("-light " + wrong("demmo.bsp")),
              wrong("demmo.bsp") + " does not exist; did you mean " + bsp + "?");
    EXPECT_THAT(ErrorOf("-vis " + (game_ / "demo").string()), HasSubstr("did you mean " + bsp + "?"));
    EXPECT_THAT(ErrorOf("-light demo.bsp"), HasSubstr("did you mean " + bsp + "?")) << "in the game's folder";
    CopySource("other.map");
    EXPECT_THAT(ErrorOf("-light " + wrong("other.bsp")),
                HasSubstr("its source does: q3map2 -bsp " + wrong("other.map") + " compiles it"));
    EXPECT_THAT(ErrorOf("-meta " + (folder_ / "none/x.map").string()),
                HasSubstr("x.map does not exist: there is no folder " + Slashed((folder_ / "none").string())));
    EXPECT_THAT(ErrorOf("-meta " + game_.string()),
                AllOf(HasSubstr(Slashed(game_.string()) + " is a folder"), HasSubstr(".map")));
    CopySource("x.bin"); // the file itself, of whatever extension, if there is no other
    EXPECT_THAT(ErrorOf("-light " + wrong("x.bin")), HasSubstr("x.bin: the file is a map source"));
    EXPECT_THAT(ErrorOf("-repack " + wrong("demmo")), HasSubstr("did you mean " + bsp));
}

TEST_F(PathsTest, QuotesOfPastedPathsGo) {
    const std::string bsp = Map(".bsp").string();
    for (const std::string &word :
         {'"' + bsp + '"', '\'' + bsp + '\'', bsp + '"', '"' + bsp, "\u201C" + bsp + "\u201D"})
        EXPECT_EQ(RunProgramFile({"-info", word}, folder_.Root()).status, 0) << word;
}

TEST_F(PathsTest, FoldersInPlaceOfGames) {
    EXPECT_THAT(ErrorOf("-game q3ut4 -info MAP"), HasSubstr("try -game quake3 -fs_game q3ut4"));
    EXPECT_THAT(ErrorOf("-game baseoa -info MAP"),
                HasSubstr("try -game quake3 -fs_basegame baseoa, or -fs_game baseoa"));
    EXPECT_THAT(ErrorOf("-game missionpack -info MAP"), HasSubstr("-game quake3 -fs_game missionpack"));
    EXPECT_THAT(ErrorOf("-game xreal -info MAP"), HasSubstr("-game quake3 -fs_game xreal"));
    EXPECT_THAT(ErrorOf("-game warfork -info MAP"), HasSubstr("try -game qfusion -fs_basegame basewf"));
    EXPECT_THAT(ErrorOf("-game etmain -info MAP"), HasSubstr("try -game et;"));
    const Outcome help = RunWell("-help game");
    for (const Game &game : Games()) {
        const std::string line = fmt::format("  {:<14}{:<11}", game.name, game.gameDir);
        EXPECT_TRUE(help.Printed(line)) << help.text;
        EXPECT_FALSE(help.Printed(line + '\n')) << "no title";
    }
    EXPECT_TRUE(help.Printed("Enemy Territory"));
}

TEST(MapPaths, OnlyExtensionsOfMapsAreReplaced) {
    EXPECT_EQ(WithExtension("maps/x.map", ".bsp"), "maps/x.bsp");
    EXPECT_EQ(WithExtension("maps/X.BSP", ".prt"), "maps/X.prt");
    EXPECT_EQ(WithExtension("maps/ctf.1", ".bsp"), "maps/ctf.1.bsp");
    EXPECT_EQ(WithExtension("maps/my.map.v2", ".bsp"), "maps/my.map.v2.bsp");
    EXPECT_EQ(WithExtension("maps/ctf.1.bsp", ""), "maps/ctf.1");
    EXPECT_EQ(WithExtension("maps.d/x", ".bsp"), "maps.d/x.bsp");
}

} // namespace

} // namespace q3::test
