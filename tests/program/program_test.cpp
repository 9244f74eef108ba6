// GPL-2.0-or-later. The program as a whole: stages from file to file.
#include "common/files/files.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/entities.h"
#include "tests/support/run_program.h"

#include <algorithm>
#include <cstring>

namespace q3::test {

namespace {

/// Coarse cells, for speed.
const std::string kLight = "-light -gridsh 64 64 64 ";
constexpr std::size_t kHeader17 = 8 + 17 * 8, kHeader19 = 8 + 19 * 8;

/// Where the first lump of the file begins: tells how many slots the header has.
std::size_t FirstLump(const std::vector<std::byte> &file) {
    std::size_t first = file.size();
    for (std::size_t lump = 0; lump < 17; lump++)
        if (IntOf(file, 12 + 8 * lump) > 0)
            first = std::min(first, std::size_t(IntOf(file, 8 + 8 * lump)));
    return first;
}

bool HasText(const std::vector<std::byte> &file, std::string_view text) {
    return std::search(file.begin(), file.end(), text.begin(), text.end(),
                       [](std::byte a, char b) { return char(a) == b; }) != file.end();
}

void ExpectOnlyGridsAndEntitiesChanged(const std::vector<std::byte> &before, const std::vector<std::byte> &after) {
    for (std::size_t lump = 0; lump < 17; lump++)
        if (lump != LUMP_ENTITIES && lump != LUMP_LIGHTGRID) {
            EXPECT_EQ(LumpOf(before, lump), LumpOf(after, lump)) << "lump " << lump;
        }
    EXPECT_NE(LumpOf(before, LUMP_LIGHTGRID), LumpOf(after, LUMP_LIGHTGRID));
}

TEST_F(ProgramTest, SHWritesVersion47WithLump18) {
    const auto before = MapBytes();
    const Outcome outcome = RunWell(kLight + "-onlygrid -sh MAP");
    EXPECT_TRUE(outcome.Printed("--- TraceGridSH ---"));
    EXPECT_TRUE(outcome.Printed("0...1...2...3...4...5...6...7...8...9..."));
    const auto after = MapBytes();
    EXPECT_EQ(IntOf(after, 4), 47);
    EXPECT_EQ(FirstLump(after), kHeader19);
    const auto lump = LumpOf(after, LUMP_LIGHTGRID_SH);
    ASSERT_GE(lump.size(), 40u);
    EXPECT_EQ(lump.size(), 40 + 108 * std::size_t(IntOf(lump, 36)));
    EXPECT_EQ(IntOf(after, 12 + 8 * LUMP_ADVERTISEMENTS), 0) << "lump 17 is empty";
    ExpectOnlyGridsAndEntitiesChanged(before, after);
}

TEST_F(ProgramTest, SHBspxWritesVersion46WithADirectory) {
    const auto before = MapBytes();
    RunWell(kLight + "-onlygrid -sh MAP");
    const auto lump = LumpOf(MapBytes(), LUMP_LIGHTGRID_SH);
    RunWell(kLight + "-onlygrid -shbspx MAP");
    const auto after = MapBytes();
    EXPECT_EQ(IntOf(after, 4), 46);
    EXPECT_EQ(FirstLump(after), kHeader17);
    EXPECT_TRUE(HasText(after, "BSPX"));
    EXPECT_TRUE(HasText(after, "LIGHTGRID_SH"));
    EXPECT_NE(std::search(after.begin(), after.end(), lump.begin(), lump.end()), after.end())
        << "the bytes of lump 18, in the other place";
    ExpectOnlyGridsAndEntitiesChanged(before, after);
}

TEST_F(ProgramTest, RelightWithoutSHDropsTheGrid) {
    const auto before = MapBytes();
    for (const std::string option : {"-sh", "-shbspx", "-shradiance"}) {
        RunWell(kLight + option + " -onlygrid MAP");
        RunWell("-light -onlygrid MAP");
        const auto after = MapBytes();
        EXPECT_EQ(IntOf(after, 4), 46);
        EXPECT_EQ(FirstLump(after), kHeader17);
        EXPECT_FALSE(HasText(after, "BSPX")) << option;
        EXPECT_FALSE(HasText(after, "_q3map2_sh")) << option;
        ExpectOnlyGridsAndEntitiesChanged(before, after);
    }
}

TEST_F(ProgramTest, AMapWithoutEntitiesIsLitAllTheSame) {
    KeptLog quiet;
    Bsp bsp = ReadBspFile(Map(".bsp"), {}, quiet.log);
    bsp.entities.clear();
    WriteBspFile(Map(".bsp"), bsp, {}, quiet.log);
    RunWell(kLight + "MAP");
    bsp = ReadBspFile(Map(".bsp"), {}, quiet.log);
    EXPECT_NE(ParseEntities(bsp.entities, "demo").at(0).Value("_q3map2_cmdline").find("-light"),
              std::string_view::npos);
}

TEST_F(ProgramTest, EntitiesKeepTheirKeysAndRecordTheCommand) {
    RunWell(kLight + "-sh MAP");
    KeptLog quiet;
    const Bsp bsp = ReadBspFile(Map(".bsp"), {}, quiet.log);
    const auto entities = ParseEntities(bsp.entities, "demo");
    EXPECT_EQ(entities.front().Value("message"), "Demo arena");
    EXPECT_NE(entities.front().Value("_q3map2_cmdline").find("-light -gridsh 64 64 64 -sh"), std::string_view::npos);
    for (const Entity &entity : entities)
        EXPECT_FALSE(StartsWithNoCase(entity.ClassName(), "light")) << "lights of the .map stay out of the .bsp";
}

TEST_F(ProgramTest, JsonRoundTripGivesTheSameBytes) {
    for (const std::string option : {"", "-sh", "-shbspx"}) {
        RunWell(kLight + option + " MAP");
        RunWell("-json -unpack MAP");
        RunWell("-json -pack MAP");
        EXPECT_EQ(ReadFile(Map("_json.bsp")), MapBytes()) << option;
        EXPECT_EQ(std::filesystem::exists(Map("") / "GridPointsSH.json"), !option.empty()) << option;
        std::filesystem::remove_all(Map(""));
    }
}

TEST_F(ProgramTest, InfoShowsTheGrid) {
    EXPECT_FALSE(RunWell("-info MAP").Printed("SH light grid"));
    RunWell(kLight + "-onlygrid -sh MAP");
    const Outcome lump = RunWell("-info MAP");
    EXPECT_TRUE(lump.Printed("SH light grid"));
    EXPECT_TRUE(lump.Printed("cells of 64 x 64 x 64 units, 17 x 13 x 6 points"));
    EXPECT_TRUE(lump.Printed("lump 18"));
    EXPECT_TRUE(lump.Printed("cosine-convolved"));
    RunWell(kLight + "-shbspx -shradiance MAP");
    const Outcome bspx = RunWell("-info MAP MAP");
    EXPECT_TRUE(bspx.Printed("BSPX"));
    EXPECT_FALSE(bspx.Printed("cosine-convolved"));
    EXPECT_TRUE(bspx.Printed("radiance"));
}

TEST_F(ProgramTest, PreviewIsAPicture) {
    constexpr char kSignature[] = "\x89PNG\r\n\x1a\n";
    const std::string png = (folder_ / "preview.png").string();
    const auto expectPicture = [&] {
        const auto file = ReadFile(png);
        ASSERT_GT(file.size(), 1000u);
        EXPECT_EQ(std::memcmp(file.data(), kSignature, 8), 0);
        std::filesystem::remove(png);
    };
    RunWell(kLight + "-sh -shpreview " + png + " MAP");
    expectPicture();
    RunWell("-shpreview " + png + " MAP");
    expectPicture();
    ExpectError("-light -shpreview " + png + " MAP", "-shpreview needs -sh");
    RunWell("-light MAP");
    ExpectError("-shpreview " + png + " MAP", "no SH light grid");
    EXPECT_FALSE(std::filesystem::exists(png));
}

TEST_F(ProgramTest, ThreadsAndPlaceOfOptionsDoNotChangeTheBytes) {
    const std::string original = (folder_ / "original.bsp").string();
    std::filesystem::copy_file(Map(".bsp"), original);
    std::filesystem::create_directories(folder_ / "base/mod");
    std::vector<std::byte> first;
    for (const std::string words :
         {"-threads 1 -light -sh MAP", "-light -threads 2 -sh MAP", "-v -light -sh -threads 7 MAP",
          "-game quake3 -light -sh MAP", "-light -sh -v -game quake3 -fs_game mod -fs_homepath /nowhere MAP"}) {
        std::filesystem::remove(Map(".bsp")); // libstdc++ overwrites no files on Windows
        std::filesystem::copy_file(original, Map(".bsp"));
        RunWell(words);
        if (first.empty())
            first = MapBytes();
        EXPECT_EQ(MapBytes(), first) << words;
    }
}

TEST_F(ProgramTest, ExtensionOfTheMapDoesNotMatter) {
    const std::string words = kLight + "-sh ";
    RunWell(words + Map("").string());
    const auto bytes = MapBytes();
    RunWell("-light MAP");
    RunWell(words + Map(".map").string());
    EXPECT_EQ(LumpOf(MapBytes(), LUMP_LIGHTGRID_SH), LumpOf(bytes, LUMP_LIGHTGRID_SH));
}

TEST_F(ProgramTest, LightsOfTheMapSourceCount) {
    const Outcome with = RunWell("-light MAP");
    EXPECT_TRUE(with.Printed("2 point lights")) << with.text;
    EXPECT_TRUE(with.Printed("1 spotlight"));
    EXPECT_TRUE(with.Printed("2 diffuse (area) lights"));
    std::filesystem::remove(Map(".map"));
    const Outcome without = RunWell("-force -light MAP");
    EXPECT_TRUE(without.Printed("0 point lights"));
    EXPECT_TRUE(without.Printed("WARNING: demo: no light entities"));
}

/// A map from elsewhere: its light entities are in its source, which is not at hand.
TEST_F(ProgramTest, AMapThatGotDarkForWantOfItsLightsSaysSo) {
    const std::string warning = "WARNING: the light grid has ";
    RunWell("-light MAP");
    std::filesystem::remove(Map(".map"));
    ExpectError("-light -onlygrid MAP", "the light grid has ");
    const Outcome darker = RunWell("-force -light -onlygrid MAP");
    EXPECT_TRUE(darker.Printed(warning)) << darker.text;
    EXPECT_FALSE(RunWell("-light -onlygrid MAP").Printed(warning)) << "as dark as before";
}

TEST_F(ProgramTest, LightGivesLightmapsAndVertexColors) {
    const auto before = MapBytes();
    RunWell("-light -bounce 1 MAP");
    const auto after = MapBytes();
    EXPECT_NE(LumpOf(before, LUMP_LIGHTMAPS), LumpOf(after, LUMP_LIGHTMAPS));
    EXPECT_EQ(LumpOf(after, LUMP_LIGHTMAPS).size() % (128 * 128 * 3), 0u);
    for (const std::size_t lump : {LUMP_PLANES, LUMP_NODES, LUMP_LEAFS, LUMP_BRUSHES, LUMP_VISIBILITY})
        EXPECT_EQ(LumpOf(before, lump), LumpOf(after, lump)) << "lump " << lump;
}

TEST_F(ProgramTest, ExportedLightmapsComeBackAsTheyWere) {
    RunWell("-light MAP");
    const auto before = MapBytes();
    RunWell("-export MAP");
    RunWell("-import MAP");
    EXPECT_EQ(before, MapBytes());
}

TEST_F(ProgramTest, ImportOnlyReadsFromTheFolderOfTheMap) {
    RunWell("-light MAP");
    folder_.Write("base/baseq3/maps/demo", "a file where no folder can be made");
    EXPECT_TRUE(RunWell("-import MAP").Printed("this lightmap stays"));
}

TEST_F(ProgramTest, UnknownOptionsWarnAndGoOn) {
    const Outcome outcome = RunWell("-light -zork -onlygrid -lomem MAP");
    EXPECT_TRUE(outcome.Printed("WARNING: Unknown argument \"-zork\"")) << outcome.text;
    EXPECT_TRUE(outcome.Printed("-lomem")) << "options that change nothing are named";
    EXPECT_TRUE(RunWell("-force -game tetris -light MAP").Printed("WARNING: -game tetris: unknown"));
    EXPECT_TRUE(RunWell("-json -zork -unpack MAP").Printed("Unknown argument \"-zork\""));
}

} // namespace

} // namespace q3::test
