// GPL-2.0-or-later. q3map2 -vis from file to file, and the check of its results by lines of sight.
#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/cli/program.h"
#include "q3map2/report/version.h"
#include "q3map2/stages/stages.h"
#include "tests/support/game_folder.h"
#include "tests/vis/portal_maps.h"
#include "tools/measure/vis_check/sight_check.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace q3::test {

namespace {

/// Six rooms in a row: planes at x = 128 k, leaf k with cluster k, solid beyond both ends.
Bsp RowOfRooms() {
    Bsp bsp;
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"message\" \"Row\"\n}\n";
    bspShader_t shader{};
    std::ranges::copy(std::string_view("noshader"), shader.shader.begin());
    bsp.shaders.push_back(shader);
    constexpr int kRooms = 6;
    const auto addLeaf = [&](int cluster) {
        bspLeaf_t leaf{};
        leaf.cluster = cluster;
        leaf.area = cluster < 0 ? -1 : 0;
        bsp.leafs.push_back(leaf);
        return int(bsp.leafs.size()) - 1;
    };
    const int solid = addLeaf(-1);
    for (int k = 0; k <= kRooms; ++k) {
        bsp.planes.push_back({{1, 0, 0}, float(128 * k)});
        bsp.planes.push_back({{-1, 0, 0}, float(-128 * k)});
        bspNode_t node{};
        node.planeNum = 2 * k;
        const int behind = k == 0 ? solid : addLeaf(k - 1);
        node.children = {k < kRooms ? k + 1 : -1 - solid, -1 - behind};
        bsp.nodes.push_back(node);
    }
    bspModel_t world{};
    world.maxs = {128 * kRooms, 128, 128};
    bsp.models.push_back(world);
    return bsp;
}

class VisStageTest : public testing::Test {
  protected:
    VisStageTest() {
        WriteBspFile(Bspath(), RowOfRooms(), {}, log_);
        text_.clear();
        folder_.Write("row.prt", Corridor(6));
    }
    std::filesystem::path Bspath() const { return folder_ / "row.bsp"; }
    std::filesystem::path Prt() const { return folder_ / "row.prt"; }
    Bsp Read() { return ReadBspFile(Bspath(), {}, log_); }
    int Run(std::vector<std::string> words) {
        text_.clear();
        words.push_back((folder_ / "row.map").string());
        return RunProgram(Stages(), words, "/games/bin/q3map2", log_);
    }
    void ExpectRefused(const std::string &message) {
        const auto before = ReadFile(Bspath());
        EXPECT_EQ(Run({"-vis"}), 1);
        EXPECT_THAT(text_, testing::HasSubstr(message));
        EXPECT_EQ(ReadFile(Bspath()), before);
    }

    GameFolder folder_;
    std::string text_;
    Log log_{[this](LogLevel, std::string_view part) { text_ += part; }};
};

TEST_F(VisStageTest, WritesTheLumpAndRemovesThePortals) {
    const Bsp before = Read();
    EXPECT_EQ(Run({"-vis", "-FAST", "-nosuch"}), 0);
    EXPECT_THAT(text_, testing::HasSubstr("--- Vis ---"));
    EXPECT_THAT(text_, testing::HasSubstr("-fast (command line"));
    EXPECT_THAT(text_, testing::HasSubstr("Unknown option \"-nosuch\""));
    EXPECT_THAT(text_, testing::HasSubstr("     6 portalclusters\n     5 numportals\n     0 numfaces\n"));
    EXPECT_THAT(text_, testing::HasSubstr("--- BasePortalVis (10) ---\n0...1...2...3...4...5...6...7...8...9... (0)"));
    EXPECT_FALSE(std::filesystem::exists(Prt()));
    Bsp after = Read();
    EXPECT_EQ(after.visibility, RunVis(Corridor(6)).visibility.Lump());
    const Entity world = ParseEntities(after.entities, "row").front();
    EXPECT_EQ(world.Value("_q3map2_cmdline"), "-vis -FAST -nosuch");
    EXPECT_EQ(world.Value("_q3map2_version"), kVersion);
    EXPECT_EQ(world.Value("message"), "Row");
    after.visibility.clear();
    after.entities = before.entities;
    EXPECT_EQ(WriteBsp(after, {}), WriteBsp(before, {})) << "nothing else changes";
}

TEST_F(VisStageTest, OptionsAreAnnounced) {
    EXPECT_EQ(Run({"-v", "-vis", "-saveprt", "-hint", "-mergeportals", "-nosort", "-passageOnly", "-plain", "-v"}), 0);
    for (const std::string line :
         {"  -saveprt (command line", "  -hint (", "  -mergeportals (", "  -nosort (", "  -passageOnly (", "  -plain (",
          "  -v (", "leaves merged", "clusters have exactly"})
        EXPECT_THAT(text_, testing::HasSubstr(line));
    EXPECT_TRUE(std::filesystem::exists(Prt()));
    EXPECT_EQ(Run({"-vis", "-saveprt"}), 0);
    EXPECT_THAT(text_, testing::HasSubstr("--- PassagePortalFlow (10) ---"));
    EXPECT_THAT(text_, testing::Not(testing::HasSubstr("clusters have exactly")));
    EXPECT_EQ(Run({"-vis", "-nopassage"}), 0);
    EXPECT_THAT(text_, testing::HasSubstr("  -nopassage ("));
    EXPECT_THAT(text_, testing::Not(testing::HasSubstr("CreatePassages")));
}

TEST_F(VisStageTest, FarPlaneComesFromTheWorld) {
    Bsp bsp = Read();
    bsp.entities = "{\n\"classname\" \"worldspawn\"\n\"fogclip\" \"250o\"\n}\n";
    WriteBspFile(Bspath(), bsp, {}, log_);
    EXPECT_EQ(Run({"-vis"}), 0);
    EXPECT_THAT(text_, testing::HasSubstr("farplane distance = 250.0\nfarplane Origin2Origin mode on\n"));
    EXPECT_EQ(Read().visibility[8], 7) << "room 0 sees rooms 0, 1 and 2";
}

TEST_F(VisStageTest, NoPortalsNoVis) {
    folder_.Write("row.prt", "PRT1\n6\n0\n0\n");
    const auto before = ReadFile(Bspath());
    EXPECT_EQ(Run({"-vis"}), 0);
    EXPECT_THAT(text_, testing::HasSubstr("No portals means no vis, exiting.\n"));
    EXPECT_EQ(ReadFile(Bspath()), before);
    EXPECT_TRUE(std::filesystem::exists(Prt()));
}

TEST_F(VisStageTest, PortalsThatDoNotFitAreRefused) {
    folder_.Write("row.prt", Corridor(5));
    ExpectRefused("row.prt:2: 5 clusters, expected the 6 of");
    folder_.Write("row.prt", Corridor(6).substr(0, 100));
    ExpectRefused("row.prt:6: ");
    folder_.Write("row.prt", PrtText(6, {"3 0 1 0 (0 0 0 ) (1 1 1 ) (2 2 2 )"}));
    ExpectRefused("row.prt:5: a polygon without area");
    std::filesystem::remove(Prt());
    ExpectRefused("row.prt");
}

TEST_F(VisStageTest, LinesOfSightFindWhatIsHidden) {
    EXPECT_THROW(CheckSight(Read(), 1, 0.5f, 1), Error) << "no visibility data yet";
    EXPECT_EQ(Run({"-vis"}), 0);
    Bsp bsp = Read();
    const SightCheck right = CheckSight(bsp, 2000, 0.5f, 1);
    EXPECT_EQ(right.pairs, 2000);
    EXPECT_GT(right.clear, 1000);
    EXPECT_EQ(right.hidden, 0);
    bsp.visibility[8] = 31; // room 0 no longer sees room 5
    const SightCheck wrong = CheckSight(bsp, 2000, 0.5f, 1);
    EXPECT_GT(wrong.missing, 0);
    EXPECT_EQ(wrong.from + wrong.to, 5);
    EXPECT_EQ(wrong.from * wrong.to, 0);
}

} // namespace

} // namespace q3::test
