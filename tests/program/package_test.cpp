// GPL-2.0-or-later. The program: packages, bot files, and edited maps, from file to file.
#include "common/files/archive.h"
#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/edit/bot_files.h"
#include "tests/support/run_program.h"

namespace q3::test {

namespace {

class PackageProgramTest : public ProgramTest {
  protected:
    /// A bot file for the map as it is.
    void PutBotFile() const {
        folder_.Write("base/baseq3/maps/demo.aas", std::string("EAAS\5\0\0\0abcdareas", 17));
        SetChecksum(FindBotFiles(Map(".bsp")).at(0), MapChecksum(Map(".bsp")));
    }
    bool BotFileFits() const { return FindBotFiles(Map(".bsp")).at(0).checksum == MapChecksum(Map(".bsp")); }
    Bsp Read(std::string_view name) const {
        KeptLog quiet;
        return ReadBspFile(maps_ / name, {}, quiet.log);
    }
};

TEST_F(PackageProgramTest, Pk3HoldsTheMap) {
    PutBotFile();
    const Outcome outcome = Run("-pk3 MAP");
    const bool isComplete = outcome.status == 0;
    const Archive archive(folder_ / (isComplete ? "base/demo_autopacked.pk3" : "base/demo_FAILEDpack.pk3"));
    EXPECT_EQ(archive.Read("maps/demo.bsp"), MapBytes());
    EXPECT_TRUE(archive.Contains("maps/demo.aas"));
    EXPECT_EQ(outcome.Printed("!FAIL!"), !isComplete);
    EXPECT_TRUE(outcome.Printed("quake3.exclude"));
}

TEST_F(PackageProgramTest, AMissingSoundFailsThePackage) {
    const std::string key = "\"music\" \"music/none.wav\"\n";
    Bsp bsp = Read("demo.bsp");
    bsp.entities.insert(bsp.entities.find('}'), key);
    KeptLog quiet;
    WriteBspFile(Map(".bsp"), bsp, {}, quiet.log);
    folder_.Write("base/demo_autopacked.pk3", "old");
    const Outcome outcome = Run("-pk3 -complevel -1 MAP");
    EXPECT_EQ(outcome.status, 1);
    EXPECT_TRUE(outcome.Printed("!FAIL! music/none.wav: wanted by entity 0 of demo, worldspawn"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "base/demo_FAILEDpack.pk3"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "base/demo_autopacked.pk3")) << "an old package would look good";
}

TEST_F(PackageProgramTest, FilesBesideTheFolderOfTheMap) {
    folder_.Write("work/music/own.wav", "RIFF");
    std::filesystem::create_directories(folder_ / "work/maps");
    Bsp bsp = Read("demo.bsp");
    bsp.entities.insert(bsp.entities.find('}'), "\"music\" \"music/own.wav\"\n");
    KeptLog quiet;
    WriteBspFile(folder_ / "work/maps/own.bsp", bsp, {}, quiet.log);
    for (const char *name : {"work/maps/own.bsp", "work/maps/./own.bsp"}) {
        const Outcome outcome = Run("-pk3 " + (folder_ / name).string());
        const bool isComplete = outcome.status == 0;
        const Archive archive(folder_ / (isComplete ? "base/own_autopacked.pk3" : "base/own_FAILEDpack.pk3"));
        EXPECT_TRUE(archive.Contains("music/own.wav")) << name;
    }
}

TEST_F(PackageProgramTest, BadLevelsAndOtherFoldersOfThePackage) {
    ExpectError("-pk3 -complevel 11 MAP", "-complevel 11: expected a whole number from -1 to 10");
    ExpectError("-pk3 -complevel -2 MAP", "-complevel -2");
    ExpectError("-pk3", "usage: q3map2 -pk3");
    const std::filesystem::path out = folder_ / "new/out"; // made when it is not there
    Run("-pk3 -outdir " + out.string() + " MAP");
    EXPECT_FALSE(std::filesystem::is_empty(out));
    ExpectError("-pk3 -outdir " + Map(".map").string() + " MAP", "cannot make this folder");
}

TEST_F(PackageProgramTest, RepackStripsScripts) {
    folder_.Write("base/baseq3/levelshots/demo.jpg", "picture");
    Run("-repack MAP");
    EXPECT_TRUE(std::filesystem::exists(folder_ / "base/demo_strippedBYrepacker.shader"));
    {
        const Archive archive(folder_ / "base/demo_repacked.pk3");
        for (const std::string &name : archive.Names())
            EXPECT_EQ(name.find(".shader"), std::string::npos) << name;
        EXPECT_FALSE(archive.Contains("maps/demo.bsp"));
        EXPECT_TRUE(archive.Contains("levelshots/demo.jpg"));
    } // Windows removes no open file
    std::filesystem::remove(folder_ / "base/demo_repacked.pk3");
    const std::string list = (folder_ / "maps.txt").string();
    folder_.Write("maps.txt", Map(".bsp").string() + "\r\n\n");
    EXPECT_TRUE(Run("-repack -analyze " + list).Printed("images of shaders:"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "base/demo_repacked.pk3"));
}

TEST_F(PackageProgramTest, LightWarnsOfBotFilesOrFixesThem) {
    PutBotFile();
    EXPECT_TRUE(RunWell("-light -onlygrid -gridsh 64 64 64 MAP").Printed("there will be no bots"));
    EXPECT_FALSE(BotFileFits());
    EXPECT_TRUE(RunWell("-light -onlygrid -fixaas MAP").Printed("did not fit the map before either"));
    EXPECT_TRUE(BotFileFits());
    const Outcome again = RunWell("-light -onlygrid -sh -gridsh 64 64 64 -fixaas MAP");
    EXPECT_TRUE(again.Printed("demo.aas fits the map again"));
    EXPECT_FALSE(again.Printed("did not fit"));
    EXPECT_TRUE(BotFileFits());
}

TEST_F(PackageProgramTest, ABotFileOfAnArchiveIsLookedAtToo) {
    PutBotFile();
    const std::string fits = folder_.ReadBack("base/baseq3/maps/demo.aas");
    std::filesystem::remove(game_ / "maps/demo.aas");
    folder_.WriteArchive("base/baseq3/bots.pk3", {{"maps/demo.aas", fits}});
    EXPECT_FALSE(Run("-pk3 MAP").Printed("is for another version of"));
    RunWell("-light -onlygrid MAP");
    for (const char *words : {"-pk3 MAP", "-pk3 -basepak bots* MAP"})
        EXPECT_TRUE(Run(words).Printed("bots.pk3 :: maps/demo.aas is for another version of " + Map(".bsp").string()));
}

TEST_F(PackageProgramTest, FixAasEntersTheMap) {
    ExpectError("-fixaas MAP", "no bot file next to it");
    PutBotFile();
    EXPECT_TRUE(RunWell("-fixaas MAP").Printed("fits already"));
    RunWell("-light -onlygrid -gridsh 64 64 64 -sh MAP");
    EXPECT_FALSE(BotFileFits());
    RunWell("-fixaas MAP");
    EXPECT_TRUE(BotFileFits());
}

TEST_F(PackageProgramTest, EditedMapsStandBesideTheirSource) {
    const auto before = MapBytes();
    RunWell("-scale 2 MAP");
    EXPECT_EQ(Read("demo_s.bsp").models[0].maxs[0], 2 * Read("demo.bsp").models[0].maxs[0]);
    RunWell("-shift -64 0 128 MAP");
    EXPECT_EQ(Read("demo_sh.bsp").models[0].maxs[0], Read("demo.bsp").models[0].maxs[0] - 64);
    RunWell("-mergebsp -world MAP " + (maps_ / "demo_sh.bsp").string());
    const Bsp merged = Read("demo_merged.bsp");
    EXPECT_EQ(merged.models[0].numBSPSurfaces, 2 * Read("demo.bsp").models[0].numBSPSurfaces);
    EXPECT_EQ(MapBytes(), before);
    const auto world = ParseEntities(merged.entities, "merged").front();
    EXPECT_NE(world.Value("_q3map2_cmdline").find("-mergebsp -world"), std::string_view::npos);
    ExpectError("-scale 1 MAP", "all factors are 1");
    ExpectError("-scale -2 MAP", "the factor is -2");
    ExpectError("-shift MAP", "expected 1 to 3");
}

} // namespace

} // namespace q3::test
