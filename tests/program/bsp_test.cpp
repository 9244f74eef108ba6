// GPL-2.0-or-later. The bsp stage as a user runs it: which files it reads, writes and removes.
#include "tests/support/run_program.h"

#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"

#include <gmock/gmock.h>

#include <chrono>

namespace q3::test {

namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

namespace fs = std::filesystem;

constexpr std::string_view kEntities = "{\n\"classname\" \"info_player_start\"\n\"origin\" \"0 0 32\"\n}\n"
                                       "{\n\"classname\" \"light\"\n\"origin\" \"0 0 96\"\n\"light\" \"300\"\n}\n";

/// A source of tests/data/maps.
std::string MapSource(std::string_view name) {
    return ReadTextFile(fs::path(TEST_DATA) / "maps" / name);
}

std::string LastLine(const Outcome &outcome) {
    const std::size_t end = outcome.text.find_last_not_of('\n') + 1;
    return outcome.text.substr(outcome.text.rfind('\n', end - 1) + 1, end);
}

class BspTest : public ProgramTest {
  protected:
    /// The files of a compile, which belong together.
    std::vector<std::string> Compiled() const {
        return {TextOf(Room(".bsp")), TextOf(Room(".prt")), TextOf(Room(".srf"))};
    }
    void WriteMap(std::string_view text, std::string_view file = "room.map") const {
        folder_.Write(fs::relative(maps_ / file, folder_.Root()).string(), text);
    }
    fs::path Room(std::string_view extension) const { return maps_ / ("room" + std::string(extension)); }
    std::string TextOf(const fs::path &path) const {
        return folder_.ReadBack(fs::relative(path, folder_.Root()).string());
    }
    Bsp ReadRoom() {
        KeptLog quiet;
        return ReadBspFile(Room(".bsp"), {}, quiet.log);
    }
};

TEST_F(BspTest, SealedMapGetsItsThreeFiles) {
    WriteMap(MapSource("room.map"));
    for (const char *stale : {".lin", ".reg"})
        WriteMap("old", std::string("room") + stale);
    RunWell("-meta " + Room("").string());
    EXPECT_TRUE(TextOf(Room(".prt")).starts_with("PRT1\n4\n4\n16\n"));
    EXPECT_TRUE(TextOf(Room(".srf")).starts_with("default\n"));
    EXPECT_FALSE(fs::exists(Room(".lin")));
    EXPECT_FALSE(fs::exists(Room(".reg")));
    const Bsp bsp = ReadRoom();
    EXPECT_EQ(bsp.drawSurfaces.size(), 6u);
    EXPECT_THAT(bsp.entities, HasSubstr("\"_q3map2_cmdline\" \"-bsp -meta\""));
}

TEST_F(BspTest, LightStageTakesWhatWasCompiled) {
    WriteMap(MapSource("room.map"));
    RunWell("-bsp -meta " + Room(".map").string());
    RunWell("-light -fast " + Room(".bsp").string());
    const Bsp bsp = ReadRoom();
    EXPECT_FALSE(bsp.lightmaps.empty());
    EXPECT_THAT(bsp.entities, HasSubstr("\"-bsp -meta; -light -fast\""));
}

TEST_F(BspTest, LeakLeavesItsLine) {
    WriteMap(MapSource("leak.map"));
    WriteMap("old", "room.prt");
    const Outcome outcome = RunWell("-meta -report " + Room(".json").string() + " " + Room("").string());
    EXPECT_TRUE(outcome.Printed("leaked"));
    EXPECT_THAT(LastLine(outcome), StartsWith("done: the map leaks (" + Room(".lin").string() +
                                              "), 2 warnings (image not found: 1, leak: 1)"));
    EXPECT_THAT(TextOf(Room(".json")), HasSubstr("\"kind\": \"leak\""));
    EXPECT_FALSE(fs::exists(Room(".prt")));
    EXPECT_TRUE(TextOf(Room(".lin")).ends_with("0.000000 0.000000 96.000000\n"));
    EXPECT_TRUE(fs::exists(Room(".bsp")));
}

TEST_F(BspTest, LeakTestWritesNoMap) {
    WriteMap(MapSource("leak.map"));
    const Outcome outcome = Run("-leaktest -report " + Room(".json").string() + " " + Room("").string());
    EXPECT_EQ(outcome.status, 1);
    EXPECT_THAT(LastLine(outcome), StartsWith("failed: the map leaks ("));
    EXPECT_THAT(TextOf(Room(".json")), HasSubstr("\"status\": \"failed\""));
    EXPECT_TRUE(fs::exists(Room(".lin")));
    EXPECT_FALSE(fs::exists(Room(".bsp")));
    EXPECT_FALSE(fs::exists(Room(".srf")));
}

TEST_F(BspTest, OnlyEntitiesReplacesThem) {
    WriteMap(MapSource("room.map"));
    RunWell("-meta " + Room("").string());
    const Bsp before = ReadRoom();
    WriteMap("{\n\"classname\" \"worldspawn\"\n\"message\" \"new\"\n}\n" + std::string(kEntities), "room.ent");
    RunWell("-onlyents " + Room(".ent").string());
    const Bsp after = ReadRoom();
    EXPECT_THAT(after.entities, HasSubstr("\"message\" \"new\""));
    EXPECT_THAT(after.entities, HasSubstr("\"_q3map2_cmdline\" \"-bsp -meta\""));
    EXPECT_THAT(after.entities, Not(HasSubstr("\"classname\" \"light\"")));
    EXPECT_EQ(after.drawVerts.size(), before.drawVerts.size());
    EXPECT_TRUE(fs::exists(Room(".prt")));
}

TEST_F(BspTest, TemporarySourceIsDeleted) {
    WriteMap(MapSource("room.map"), "other.tmp");
    RunWell(fmt::format("-meta -tempname {} {}", (maps_ / "other.tmp").string(), Room(".map").string()));
    EXPECT_TRUE(fs::exists(Room(".bsp")));
    EXPECT_FALSE(fs::exists(maps_ / "other.tmp"));
}

TEST_F(BspTest, FilesHaveThePlacesThatOptionsName) {
    WriteMap(MapSource("room.map"));
    RunWell("-meta " + Room(".map").string());
    const auto beside = Compiled();
    fs::remove(Room(".bsp")), fs::remove(Room(".prt")), fs::remove(Room(".srf"));
    folder_.Write("out/old.lin", "old");
    const auto out = [&](std::string_view name) { return (folder_ / "out" / name).string(); };
    const std::string places = fmt::format("-bspfile {} -srffile {} -prtfile {} -linfile {} ", out("b.bsp"),
                                           out("surfaces"), out("portals"), out("old.lin"));
    const std::string words = "-meta " + places + Room(".map").string();
    RunWell(words);
    EXPECT_EQ((std::vector{TextOf(out("b.bsp")), TextOf(out("portals")), TextOf(out("surfaces"))}), beside);
    EXPECT_FALSE(fs::exists(out("old.lin")));
    for (const char *extension : {".bsp", ".srf", ".prt"})
        EXPECT_FALSE(fs::exists(Room(extension))) << extension;
    WriteMap("{\n\"classname\" \"worldspawn\"\n\"message\" \"new\"\n}\n", "room.ent");
    RunWell("-onlyents -bspfile " + out("b.bsp") + " " + Room(".ent").string());
    EXPECT_THAT(TextOf(out("b.bsp")), HasSubstr("\"message\" \"new\""));
    WriteMap(MapSource("leak.map"));
    EXPECT_THAT(LastLine(RunWell(words)), StartsWith("done: the map leaks (" + out("old.lin")));
    EXPECT_TRUE(TextOf(out("old.lin")).ends_with("0.000000 0.000000 96.000000\n"));
    EXPECT_FALSE(fs::exists(out("portals")));
}

TEST_F(BspTest, PlacesThatCannotBeMeantAreErrors) {
    WriteMap(MapSource("room.map"));
    const std::string map = Room(".map").string();
    const auto expectError = [&](const std::string &words, std::string_view text) {
        const Outcome outcome = Run("-meta " + words + " " + map);
        EXPECT_EQ(outcome.status, 1) << outcome.text;
        EXPECT_THAT(outcome.text, HasSubstr(text));
    };
    expectError("-bspfile out/room", "-bspfile out/room: expected a name that ends in .bsp");
    expectError("-srffile " + map, map + ": two files of this run would have this name");
    expectError("-srffile same -prtfile ./same", "same: two files of this run");
    expectError("-bspfile nowhere/room.bsp", "the folder");
    EXPECT_EQ(TextOf(map), MapSource("room.map"));
    EXPECT_FALSE(fs::exists(Room(".bsp")));
}

TEST_F(BspTest, FastMetaIsMeta) {
    WriteMap(MapSource("room.map"));
    RunWell("-fastmeta " + Room("").string());
    EXPECT_EQ(ReadRoom().drawSurfaces.size(), 6u);
}

TEST_F(BspTest, UnknownOptionIsAWarning) {
    WriteMap(MapSource("room.map"));
    EXPECT_TRUE(RunWell("-bsp -frobnicate " + Room("").string()).Printed("Unknown option \"-frobnicate\""));
}

TEST_F(BspTest, BrokenSourceLeavesTheOldMap) {
    WriteMap(MapSource("room.map"));
    RunWell("-meta " + Room("").string());
    const auto before = Compiled();
    WriteMap("{\n\"classname\" \"worldspawn\"\n{\n( 0 0 0 ) ( 1 0\n");
    const Outcome outcome = Run("-meta " + Room("").string());
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.ErrorLines().size(), 1u);
    EXPECT_EQ(Compiled(), before) << "-vis and -light can go on with the old map";
    WriteMap(MapSource("leak.map"));
    EXPECT_EQ(Run("-leaktest " + Room("").string()).status, 1);
    EXPECT_EQ(Compiled(), before);
}

TEST_F(BspTest, LaterStagesSayThatTheSourceIsNewer) {
    WriteMap(MapSource("room.map"));
    RunWell("-meta " + Room("").string());
    EXPECT_FALSE(RunWell("-vis -saveprt " + Room(".bsp").string()).Printed("is newer than room.bsp"));
    fs::last_write_time(Room(".map"), fs::last_write_time(Room(".bsp")) + std::chrono::seconds(1));
    EXPECT_TRUE(RunWell("-vis -saveprt " + Room(".bsp").string()).Printed("room.map is newer than room.bsp"));
    fs::last_write_time(Room(".map"), fs::last_write_time(Room(".bsp")) + std::chrono::seconds(1));
    EXPECT_TRUE(RunWell("-light -fast " + Room(".bsp").string()).Printed("room.map is newer than room.bsp"));
}

TEST_F(BspTest, TheDemoArenaGoesThroughAllStages) {
    fs::copy(fs::path(DEMO_ARENA) / "maps" / "demo.map", maps_ / "room.map");
    const fs::path game = maps_.parent_path();
    for (const char *part : {"scripts", "models"})
        fs::copy(fs::path(DEMO_ARENA) / part, game / part,
                 fs::copy_options::recursive | fs::copy_options::overwrite_existing);
    RunWell("-meta " + Room(".map").string());
    ASSERT_TRUE(fs::exists(Room(".prt"))) << "it leaks";
    const Bsp compiled = ReadRoom();
    EXPECT_EQ(compiled.models.size(), 2u) << "the world and its door";
    EXPECT_TRUE(compiled.visibility.empty());
    RunWell("-vis " + Room(".bsp").string());
    EXPECT_FALSE(ReadRoom().visibility.empty());
    RunWell("-light -fast -sh -gridsh 128 128 128 " + Room(".bsp").string());
    const Bsp lit = ReadRoom();
    EXPECT_FALSE(lit.lightmaps.empty());
    ASSERT_TRUE(lit.gridSH);
    EXPECT_FALSE(lit.gridSH->points.empty());
}

TEST_F(BspTest, InfoShowsASparseGridAndNewLightDropsIt) {
    RunWell("-light -onlygrid -gridsh 128 128 128 -sh MAP");
    KeptLog quiet;
    Bsp bsp = ReadBspFile(Map(".bsp"), {}, quiet.log);
    SparseGridTree tree{{-64, 8, 0}, {16, 16, 32}, {1, 1, 1}, 1, {{0, 0, 0, 255, 0, 0}}, {}};
    tree.values.assign(8, bsp.gridSH->points.front());
    bsp.sparseGridSH = PackSparseGrid(tree);
    WriteBspFile(Map(".bsp"), bsp, {}, quiet.log);
    EXPECT_TRUE(RunWell("-info MAP").Printed("8 sparse SH grid"));
    RunWell("-light -onlygrid -gridsh 128 128 128 -sh MAP");
    bsp = ReadBspFile(Map(".bsp"), {}, quiet.log);
    EXPECT_FALSE(bsp.sparseGridSH);
    EXPECT_TRUE(bsp.gridSH);
}

} // namespace

} // namespace q3::test
