// GPL-2.0-or-later. The bsp stage as a user runs it: which files it reads, writes and removes.
#include "tests/program/run_program.h"

#include "q3map2/bspfile/bspfile.h"

#include <gmock/gmock.h>

namespace q3::test {

namespace {

using testing::HasSubstr;
using testing::Not;

namespace fs = std::filesystem;

std::string Side(int axis, bool more, int dist) {
    std::array<std::array<int, 3>, 3> points{};
    for (auto &p : points)
        p[std::size_t(axis)] = dist;
    points[more ? 2 : 1][std::size_t((axis + 1) % 3)] = 64;
    points[more ? 1 : 2][std::size_t((axis + 2) % 3)] = 64;
    std::string text;
    for (const auto &p : points)
        text += fmt::format("( {} {} {} ) ", p[0], p[1], p[2]);
    return text + "test/wall 0 0 0 0.5 0.5 0 0 0\n";
}

std::string Box(std::array<int, 3> mins, std::array<int, 3> maxs) {
    std::string text = "{\n";
    for (int axis = 0; axis < 3; ++axis)
        text += Side(axis, false, mins[std::size_t(axis)]) + Side(axis, true, maxs[std::size_t(axis)]);
    return text + "}\n";
}

constexpr std::string_view kEntities = "{\n\"classname\" \"info_player_start\"\n\"origin\" \"0 0 32\"\n}\n"
                                       "{\n\"classname\" \"light\"\n\"origin\" \"0 0 96\"\n\"light\" \"300\"\n}\n";

std::string RoomText(bool sealed, std::string_view extra = "") {
    std::string text = "{\n\"classname\" \"worldspawn\"\n" + Box({-144, -144, -16}, {-128, 144, 144}) +
                       Box({128, -144, -16}, {144, 144, 144}) + Box({-128, -144, -16}, {128, -128, 144}) +
                       Box({-128, 128, -16}, {128, 144, 144}) + Box({-128, -128, -16}, {128, 128, 0});
    if (sealed)
        text += Box({-128, -128, 128}, {128, 128, 144});
    return text + std::string(extra) + "}\n" + std::string(kEntities);
}

class BspTest : public ProgramTest {
  protected:
    void WriteMap(std::string_view text, std::string_view file = "room.map") const {
        folder_.Write(fs::relative(maps_ / file, folder_.Root()).string(), text);
    }
    fs::path Room(std::string_view extension) const { return maps_ / ("room" + std::string(extension)); }
    std::string TextOf(const fs::path &path) const {
        return folder_.ReadBack(fs::relative(path, folder_.Root()).string());
    }
    Bsp ReadRoom() {
        QuietLog quiet;
        return ReadBspFile(Room(".bsp"), {}, quiet.log);
    }
};

TEST_F(BspTest, SealedMapGetsItsThreeFiles) {
    WriteMap(RoomText(true));
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
    WriteMap(RoomText(true));
    RunWell("-bsp -meta " + Room(".map").string());
    RunWell("-light -fast " + Room(".bsp").string());
    const Bsp bsp = ReadRoom();
    EXPECT_FALSE(bsp.lightmaps.empty());
    EXPECT_THAT(bsp.entities, HasSubstr("\"-bsp -meta; -light -fast\""));
}

TEST_F(BspTest, LeakLeavesItsLine) {
    WriteMap(RoomText(false));
    WriteMap("old", "room.prt");
    const Outcome outcome = RunWell("-meta " + Room("").string());
    EXPECT_TRUE(outcome.Printed("leaked"));
    EXPECT_FALSE(fs::exists(Room(".prt")));
    EXPECT_TRUE(TextOf(Room(".lin")).ends_with("0.000000 0.000000 96.000000\n"));
    EXPECT_TRUE(fs::exists(Room(".bsp")));
}

TEST_F(BspTest, LeakTestWritesNoMap) {
    WriteMap(RoomText(false));
    RunWell("-leaktest " + Room("").string());
    EXPECT_TRUE(fs::exists(Room(".lin")));
    EXPECT_FALSE(fs::exists(Room(".bsp")));
    EXPECT_FALSE(fs::exists(Room(".srf")));
}

TEST_F(BspTest, OnlyEntitiesReplacesThem) {
    WriteMap(RoomText(true));
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
    WriteMap(RoomText(true), "other.tmp");
    RunWell(fmt::format("-meta -tempname {} {}", (maps_ / "other.tmp").string(), Room(".map").string()));
    EXPECT_TRUE(fs::exists(Room(".bsp")));
    EXPECT_FALSE(fs::exists(maps_ / "other.tmp"));
}

TEST_F(BspTest, UnknownOptionIsAWarning) {
    WriteMap(RoomText(true));
    EXPECT_TRUE(RunWell("-frobnicate " + Room("").string()).Printed("Unknown option \"-frobnicate\""));
}

TEST_F(BspTest, BrokenSourceLeavesTheOldMap) {
    WriteMap(RoomText(true));
    RunWell("-meta " + Room("").string());
    WriteMap("{\n\"classname\" \"worldspawn\"\n{\n( 0 0 0 ) ( 1 0\n");
    const Outcome outcome = Run("-meta " + Room("").string());
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.ErrorLines().size(), 1u);
    EXPECT_EQ(ReadRoom().drawSurfaces.size(), 6u);
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

} // namespace

} // namespace q3::test
