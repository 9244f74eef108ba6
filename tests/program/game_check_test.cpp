// GPL-2.0-or-later. Game files that are not where the options say: an error that names the folders searched.
#include "tests/support/run_program.h"
#include "tests/support/this_system.h"

#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"

#include <array>

namespace q3::test {

namespace {

/// The folder of the user's files of Quake 3 below the user's folder.
const std::string kHome = kIsWindows ? "q3a" : ".q3a";

class GameCheckTest : public ProgramTest {
  protected:
    /// Without the -fs_basepath that Run gives.
    Outcome RunBare(std::vector<std::string> arguments) {
        arguments.push_back(Map(".bsp").string());
        return RunProgramFile(arguments, folder_.Root());
    }
    std::string ErrorOf(const Outcome &outcome) {
        EXPECT_EQ(outcome.status, 1) << outcome.text;
        const auto lines = outcome.ErrorLines();
        EXPECT_EQ(lines.size(), 1u) << outcome.text;
        return lines.empty() ? "" : lines.front();
    }
    void ExpectParts(const std::string &line, const std::vector<std::string> &parts) {
        for (const std::string &part : parts)
            EXPECT_NE(Slashed(line).find(Slashed(part)), std::string::npos) << part << " is not in: " << line;
    }
};

TEST_F(GameCheckTest, BasePathThatIsNotThere) {
    const auto before = MapBytes();
    for (const char *stage : {"-light", "-bsp"})
        ExpectParts(ErrorOf(RunBare({"-fs_basepath", "/nope", stage})),
                    {"no game files", "/nope is not a folder", "/nope/baseq3", (folder_ / (kHome + "/baseq3")).string(),
                     "-force"});
    EXPECT_EQ(MapBytes(), before);
}

TEST_F(GameCheckTest, BasePathThatIsNotThereBesideFilesOfTheHomeFolder) {
    folder_.Write(kHome + "/baseq3/scripts/home.shader", "");
    ExpectParts(ErrorOf(RunBare({"-fs_basepath", "/nope", "-light"})), {"/nope is not a folder"});
}

TEST_F(GameCheckTest, FolderWithoutGameFiles) {
    folder_.Write("empty/baseq3/q3config.cfg", "");
    ExpectParts(ErrorOf(RunBare({"-fs_basepath", (folder_ / "empty").string(), "-light"})),
                {"no game files", (folder_ / "empty/baseq3").string(), "-fs_basepath"});
}

/// Without -fs_basepath the game is where the map is: DIR/baseq3/maps/demo.bsp.
TEST_F(GameCheckTest, TheFolderOfTheMapTellsTheGame) {
    const Outcome found = RunBare({"-light", "-onlygrid"});
    EXPECT_EQ(found.status, 0) << found.text;
    EXPECT_TRUE(found.Printed("VFS Init: " + game_.string())) << found.text;
    std::filesystem::rename(game_, folder_ / "base/mod");
    maps_ = folder_ / "base/mod/maps";
    ExpectParts(ErrorOf(RunBare({"-light"})), {"no game files", "baseq3", "-fs_basepath",
                                               "the map is among the game files of " + (folder_ / "base/mod").string(),
                                               "-fs_basegame mod, or -fs_game mod for a mod"});
    EXPECT_EQ(RunBare({"-fs_game", "mod", "-light", "-onlygrid"}).status, 0);
    std::filesystem::rename(maps_, folder_ / "base/mod/maps1"); // not a folder of maps
    maps_ = folder_ / "base/mod/maps1";
    ExpectParts(ErrorOf(RunBare({"-fs_game", "mod", "-light"})), {"-fs_game mod", "no such folder"});
}

/// -fs_nobasepath, -fs_nohomepath and -fs_nomagicpath.
TEST_F(GameCheckTest, FoldersThatAreNotSearched) {
    folder_.Write(kHome + "/baseq3/scripts/home.shader", "");
    const std::string home = Slashed((folder_ / (kHome + "/baseq3")).string()), base = (folder_ / "base").string(),
                      game = Slashed(game_.string());
    const auto searched = [&](std::vector<std::string> words) {
        words.insert(words.end(), {"-light", "-onlygrid", "-force"});
        const Outcome outcome = RunBare(words);
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        std::vector<std::string> folders;
        constexpr std::string_view kLine = "VFS Init: ";
        for (std::size_t at = 0; (at = outcome.text.find(kLine, at)) != std::string::npos; ++at)
            folders.push_back(
                Slashed(outcome.text.substr(at + kLine.size(), outcome.text.find('\n', at) - at - kLine.size())));
        return folders;
    };
    using Folders = std::vector<std::string>;
    EXPECT_EQ(searched({}), (Folders{home, game}));
    EXPECT_EQ(searched({"-fs_nohomepath"}), Folders{game});
    EXPECT_EQ(searched({"-fs_nobasepath"}), Folders{home});
    const Folders guessed = searched({"-fs_nomagicpath", "-fs_nohomepath"});
    ASSERT_EQ(guessed.size(), 1u); // the folder above the program's
    EXPECT_NE(guessed[0], game);
    const Folders none{"-fs_nobasepath", "-fs_nohomepath", "-fs_nomagicpath"};
    EXPECT_EQ(searched(none), Folders{});
    const auto with = [&](Folders more) {
        more.insert(more.begin(), none.begin(), none.end());
        return more;
    };
    EXPECT_EQ(searched(with({"-fs_basepath", base})), Folders{game});
    EXPECT_EQ(searched(with({"-fs_pakpath", game_.string()})), Folders{game});
    ExpectParts(ErrorOf(RunBare(with({"-light"}))), {"no game files", "(searched: nothing)"});
    EXPECT_TRUE(RunBare(with({"-fs_home", base, "-light", "-force"})).Printed("-fs_nohomepath: the folder")) << base;
    ExpectParts(ErrorOf(RunBare(with({"-pk3"}))), {"-fs_nobasepath leaves no folder", "-outdir"});
}

TEST_F(GameCheckTest, OneArchiveIsEnough) {
    folder_.WriteArchive("packed/baseq3/pak0.PK3", {{"scripts/a.shader", "textures/a\n{\n}\n"}});
    EXPECT_EQ(RunBare({"-fs_basepath", (folder_ / "packed").string(), "-light", "-onlygrid"}).status, 0);
}

TEST_F(GameCheckTest, PackagesThatTheMapsPackageNeeds) {
    const std::filesystem::path game = folder_ / "un";
    folder_.WriteArchive("un/pkg/tex_1.dpk", {{"scripts/a.shader", "textures/a\n{\n}\n"}, {"DEPS", "gone 2\n"}});
    folder_.Write("un/pkg/map-demo_src.dpkdir/maps/demo.bsp", MapBytes());
    folder_.Write("un/pkg/map-demo_src.dpkdir/DEPS", "tex\n");
    maps_ = game / "pkg/map-demo_src.dpkdir/maps";
    const auto light = [&](const char *name) {
        return RunBare({"-game", name, "-fs_basepath", game.string(), "-fs_basegame", "pkg", "-light", "-onlygrid"});
    };
    const Outcome found = light("unvanquished");
    EXPECT_EQ(found.status, 0) << found.text;
    EXPECT_TRUE(found.Printed("tex_1.dpk needs gone 2, which is in no folder of the game")) << found.text;
    EXPECT_FALSE(light("quake3").Printed("needs gone")) << "other games have no such packages";
}

TEST_F(GameCheckTest, ModWithoutBaseGame) {
    std::filesystem::rename(game_, folder_ / "base/mod");
    game_ = folder_ / "base/mod";
    maps_ = game_ / "maps";
    RunWell("-fs_game mod -light -onlygrid MAP");
}

TEST_F(GameCheckTest, ModThatIsNotThere) {
    ExpectError("-fs_game moda -light MAP", "-fs_game moda: no such folder");
    const std::string line = ErrorOf(Run("-fs_game moda -bsp MAP"));
    ExpectParts(line, {(folder_ / "base/moda").string(), (folder_ / (kHome + "/moda")).string(), "-force"});
}

TEST_F(GameCheckTest, UnknownGameNamesTheNearest) {
    ExpectError("-game quake -light MAP", "-game quake: unknown; did you mean quake3?");
    ExpectError("-game QuakeLife -bsp MAP", "quakelive");
    ExpectError("-game tremolous -light MAP", "tremulous");
}

TEST_F(GameCheckTest, ForceGoesOnWithAWarning) {
    const auto expectWarning = [&](const Outcome &outcome, std::string_view text) {
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        EXPECT_TRUE(outcome.Printed(fmt::format("WARNING: {}", text))) << outcome.text;
    };
    expectWarning(RunBare({"-fs_basepath", "/nope", "-force", "-light", "-onlygrid"}), "no game files");
    expectWarning(Run("-force -fs_game moda -light -onlygrid MAP"), "-fs_game moda: no such folder");
    expectWarning(Run("-light -onlygrid -force -game tetris MAP"), "-game tetris: unknown, quake3 is used");
}

TEST_F(GameCheckTest, OtherStagesNeedNoGameFiles) {
    RunWell("-light -sh -gridsh 64 64 64 MAP");
    const std::vector<std::string> nowhere{"-fs_basepath", "/nope", "-fs_game", "moda"};
    for (const std::vector<std::string> &stage : {std::vector<std::string>{"-info"},
                                                  {"-export"},
                                                  {"-import"},
                                                  {"-json", "-unpack"},
                                                  {"-json", "-pack"},
                                                  {"-shpreview", (folder_ / "p.png").string()}}) {
        std::vector<std::string> words = nowhere;
        words.insert(words.end(), stage.begin(), stage.end());
        EXPECT_EQ(RunBare(words).status, 0) << stage.front();
    }
}

TEST_F(GameCheckTest, EntitiesAloneNeedNoGameFiles) {
    EXPECT_EQ(RunBare({"-fs_basepath", "/nope", "-bsp", "-onlyents"}).status, 0);
}

/// A box brush of one texture.
std::string Box(const std::array<int, 3> &mins, const std::array<int, 3> &maxs, std::string_view texture) {
    const auto [x, y, z] = mins;
    const auto [u, v, w] = maxs;
    const std::string end = fmt::format(" {} 0 0 0 1 1\n", texture);
    std::string text = "{\n";
    const auto at = [](int a, int b, int c) { return fmt::format("( {} {} {} ) ", a, b, c); };
    for (const std::string &points : {at(x, y, z) + at(x, v, z) + at(x, y, w), at(u, y, z) + at(u, y, w) + at(u, v, z),
                                      at(x, y, z) + at(x, y, w) + at(u, y, z), at(x, v, z) + at(u, v, z) + at(x, v, w),
                                      at(x, y, z) + at(u, y, z) + at(x, v, z), at(x, y, w) + at(x, v, w) + at(u, y, w)})
        text += points + end;
    return text + "}\n";
}

/// A room of 256 x 256 x 256 units full of water, with a clip brush in its lower half and a sky for a ceiling.
std::string PoolMap() {
    std::string text = "{\n\"classname\" \"worldspawn\"\n";
    text += Box({-144, -144, -16}, {144, 144, 0}, "pool/wall") + Box({-144, -144, 256}, {144, 144, 272}, "pool/sky");
    for (const int side : {-144, 128}) {
        text += Box({side, -144, 0}, {side + 16, 144, 256}, "pool/wall");
        text += Box({-128, side, 0}, {128, side + 16, 256}, "pool/wall");
    }
    text += Box({-128, -128, 0}, {128, 128, 256}, "pool/water") + Box({-96, -96, 8}, {96, 96, 128}, "pool/clip");
    return text + "}\n{\n\"classname\" \"light\"\n\"origin\" \"0 0 200\"\n\"light\" \"300\"\n}\n";
}

TEST_F(GameCheckTest, FlagsOfTheMapStandInForScripts) {
    folder_.Write("base/baseq3/scripts/pool.shader",
                  "textures/pool/wall\n{\n}\ntextures/pool/sky\n{\n\tsurfaceparm sky\n}\n"
                  "textures/pool/water\n{\n\tsurfaceparm water\n\tsurfaceparm trans\n}\n"
                  "textures/pool/clip\n{\n\tsurfaceparm playerclip\n\tsurfaceparm nodraw\n}\n");
    std::filesystem::remove(game_ / "scripts/shaderlist.txt");
    folder_.Write("base/baseq3/maps/pool.map", PoolMap());
    const std::string bsp = (maps_ / "pool.bsp").string();
    RunWell("-meta " + (maps_ / "pool.map").string());
    const auto gridWith = [&](const std::string &basePath) {
        const Outcome outcome = RunProgramFile(
            {"-fs_basepath", basePath, "-force", "-light", "-sh", "-gridsh", "32", "32", "32", "-onlygrid", bsp},
            folder_.Root());
        EXPECT_EQ(outcome.status, 0) << outcome.text;
        return LumpOf(ReadFile(bsp), LUMP_LIGHTGRID_SH);
    };
    const auto scripts = gridWith((folder_ / "base").string()), noScripts = gridWith("/nope");
    EXPECT_EQ(noScripts, scripts) << "what is translucent is not taken for solid";
    EXPECT_FALSE(scripts.empty());
}

} // namespace

} // namespace q3::test
