// GPL-2.0-or-later. Mistakes on the command line and in maps: what they must not do, and what is said.
#include "tests/support/run_program.h"

#include "common/files/files.h"

#include <gmock/gmock.h>

#include <fstream>

namespace q3::test {

namespace {

using testing::HasSubstr;

class TrapsTest : public ProgramTest {
  protected:
    std::string MapText() const { return folder_.ReadBack("base/baseq3/maps/demo.map"); }
    void AppendToMap(std::string_view text) const {
        folder_.Write("base/baseq3/maps/demo.map", MapText() + std::string(text));
    }
    /// Keys at the start of the world.
    void AddWorldKeys(std::string_view text) const {
        std::string map = MapText();
        folder_.Write("base/baseq3/maps/demo.map", map.insert(map.find('{') + 2, text));
    }
    static std::string LastLine(const Outcome &outcome) {
        const std::size_t end = outcome.text.find_last_not_of('\n');
        return outcome.text.substr(outcome.text.rfind('\n', end) + 1);
    }
};

TEST_F(TrapsTest, StageWordAndFileStandAnywhere) {
    constexpr std::string_view kWords = "-light -onlygrid -sh -gridsh 64 64 64 MAP";
    const auto before = MapBytes();
    RunWell(kWords);
    const auto lit = MapBytes();
    EXPECT_NE(lit, before);
    for (const char *words : {"-sh -light -onlygrid -gridsh 64 64 64 MAP", "-light MAP -onlygrid -sh -gridsh 64 64 64",
                              "MAP -onlygrid -sh -gridsh 64 64 64 -light"}) {
        std::ofstream(Map(".bsp"), std::ios::binary)
            .write(reinterpret_cast<const char *>(before.data()), std::streamsize(before.size()));
        RunWell(words);
        EXPECT_EQ(LumpOf(MapBytes(), 18), LumpOf(lit, 18)) << words;
        EXPECT_EQ(LumpOf(MapBytes(), 13), LumpOf(lit, 13)) << words;
    }
}

TEST_F(TrapsTest, MistypedStagesDoNotReplaceTheMap) {
    ExpectError("-lihgt -sh MAP", "-lihgt: unknown; did you mean -light?");
    ExpectError("--light MAP", "did you mean -light?");
    ExpectError("light MAP", "light: unknown; did you mean -light?");
    ExpectError("-sh MAP", "-sh: unknown; it is an option of -light");
    ExpectError("-zork -light MAP", "-zork: -light has no such option");
    ExpectError("-bounc 8 -light MAP", "did you mean -bounce?");
    ExpectError("-meta MAP", "is a compiled map");
    ExpectError("MAP", "name a stage");
    ExpectError("-bsp -light MAP", "-bsp and -light on one line");
}

TEST_F(TrapsTest, CompiledMapWithoutItsSourceIsNotCompiled) {
    std::filesystem::remove(Map(".map"));
    ExpectError("-bsp -meta MAP", "without a map source next to it");
}

TEST_F(TrapsTest, MapSourcesCompileAsEver) {
    for (const std::string &words :
         {"-meta " + Map(".map").string(), "-meta " + Map("").string(), Map(".map").string(),
          "-bsp -meta " + Map(".bsp").string(), "-v -meta -threads 2 " + Map(".map").string()}) {
        std::filesystem::remove(Map(".bsp"));
        if (words.ends_with(".bsp"))
            RunWell("-meta " + Map(".map").string());
        RunWell(words);
        EXPECT_TRUE(std::filesystem::exists(Map(".bsp"))) << words;
    }
}

TEST_F(TrapsTest, UnknownOptionsOfAStageWarnAndAreRepeatedAtTheEnd) {
    const Outcome outcome = RunWell("-light -onlygrid -bounc MAP");
    const std::string text = "Unknown argument \"-bounc\"; did you mean -bounce?";
    EXPECT_THAT(outcome.text, HasSubstr("WARNING: " + text));
    EXPECT_GT(outcome.text.rfind(text), outcome.text.find("Writing"));
    EXPECT_THAT(LastLine(outcome), HasSubstr("1 warning (unknown option: 1)"));
}

TEST_F(TrapsTest, AMistypedOptionIsToldOnceWithItsValue) {
    for (const char *words : {"-light -onlygrid -smaplesize 8 MAP", "-light -onlygrid MAP -smaplesize 8"}) {
        const Outcome outcome = RunWell(words);
        EXPECT_TRUE(
            outcome.Printed("Unknown argument \"-smaplesize\"; did you mean -samplesize?; its value 8 is ignored"))
            << outcome.text;
        EXPECT_THAT(LastLine(outcome), HasSubstr("1 warning (unknown option: 1)")) << words;
    }
    EXPECT_TRUE(RunWell("-light -onlygrid -bounce=2 MAP").Printed("write -bounce 2"));
    const Outcome info = RunWell("-info -zork 8 MAP");
    EXPECT_TRUE(info.Printed("its value 8 is ignored")) << info.text;
}

TEST_F(TrapsTest, UnknownOptionsThatNameFilesAreErrors) {
    folder_.Write("base/baseq3/maps/other.bsp", std::string_view("IBSP"));
    for (const std::string words :
         {"-outfile other.bsp", "-zork other.bsp", "-zork maps/page", "-zork a\\b", "-zork page.TGA", "-outfile x",
          "-lumppath x", "-imagedir x", "-OUTFILE", "-outfile=x", "-zork=maps/other.srf"}) {
        const std::string text = words + ": -light has no such option, and it seems to name a file";
        ExpectError("-light -onlygrid " + words + " MAP", text);
        ExpectError("-light -onlygrid MAP " + words, text);
    }
    ExpectError("-vis -lightmapdir x MAP", "it is an option of -light");
    ExpectError("-info -outfile MAP", "-outfile: -info has no such option");
    // The map of the line, numbers and names are no files.
    for (const std::string words : {"-zork", "-zork 0.5", "-outfile 8", "-zork name", "-zork=name", "-profiled"})
        EXPECT_TRUE(RunWell("-light -onlygrid " + words + " MAP").Printed("Unknown argument \"-")) << words;
}

TEST_F(TrapsTest, TwoMapsOnALineAreAnError) {
    folder_.Write("base/baseq3/maps/other.map", MapText());
    ExpectError("-light " + Map(".map").replace_filename("other.map").string() + " MAP", "a line is for one map");
}

TEST_F(TrapsTest, SurfaceFilesWinOverLuxelSizesAndTheRunSaysSo) {
    RunWell("-bsp -meta -samplesize 32 " + Map(".map").string());
    const Outcome outcome = RunWell("-light -onlygrid -samplesize 8 MAP");
    EXPECT_TRUE(outcome.Printed("-samplesize 8 has no effect: demo.srf")) << outcome.text;
    EXPECT_TRUE(outcome.Printed("(32 unless a shader or key says otherwise)"));
    EXPECT_FALSE(outcome.Printed("-samplesize 8 (command line"));
    std::filesystem::remove(Map(".srf"));
    EXPECT_TRUE(RunWell("-light -onlygrid -samplesize 8 MAP").Printed("-samplesize 8 (command line; default 16)"));
}

TEST_F(TrapsTest, LargeSurfacesOfBuildLinesAreTaken) {
    RunWell("-bsp -meta -mv 100000000 -mi 6000000 -custinfoparms MAP");
    ExpectError("-light -super 9 MAP", "-super 9: expected a whole number from 1 to 8; time and memory grow with N²");
}

TEST_F(TrapsTest, WordsWithoutEffectInMapsAndShadersSayWhatToWrite) {
    AddWorldKeys("\"_phong\" \"1\"\n\"_sunlight\" \"200\"\n");
    EXPECT_TRUE(RunWell("-bsp -meta " + Map(".map").string())
                    .Printed("the key _phong \"1\" has no effect. "
                             "Use the key _shadeangle"));
    std::string script = folder_.ReadBack("base/baseq3/scripts/demo.shader");
    const std::size_t at = script.find("\tq3map_lightRGB");
    folder_.Write("base/baseq3/scripts/demo.shader",
                  script.insert(at, "\tq3map_lightImage textures/none\n\tq3map_ssbumpImage textures/bumps.tga\n"));
    const Outcome light = RunWell("-light -bounce 1 -nogrid MAP");
    EXPECT_TRUE(light.Printed("the key _sunlight \"200\" has no effect. Use a light_environment")) << light.text;
    EXPECT_TRUE(
        light.Printed("textures/demo/wall: q3map_ssbumpImage textures/bumps: no image of that name can be read"));
    EXPECT_TRUE(light.Printed("textures/demo/wall: q3map_lightImage textures/none: no image of that name can be read"));
}

TEST_F(TrapsTest, BadNumbersAreRefusedByName) {
    for (const char *words :
         {"-bounce x", "-bounce 1.5", "-bounce 2x", "-gridscalesh nan", "-gridscalesh inf", "-gridscalesh 1e99",
          "-gridscalesh 1.5x", "-gridsh 32 32", "-gridsh 32 x 32", "-area", "-scale -", "-super 9", "-shadeangle 400",
          "-threads two", "-dirtdepth ,5", "-novertex 3", "-lightmapsize big", "-samples +"}) {
        const std::string name = std::string(words).substr(0, std::string_view(words).find(' '));
        ExpectError(fmt::format("-light MAP -sh {}", words), name);
    }
    ExpectError("-bsp -samplesize 0 MAP", "-samplesize 0: expected a whole number from 1 to 16384 (game units)");
    ExpectError("-bsp -mi two MAP", "-mi two");
    ExpectError("-vis -threads 1.0 MAP", "-threads 1.0");
}

TEST_F(TrapsTest, CellsUnderTheMinimumWarnWithBothValues) {
    const Outcome outcome = RunWell("-light -onlygrid -sh -gridsh 4 96 96 MAP");
    EXPECT_TRUE(outcome.Printed("WARNING: -gridsh 4: the minimum is 8; 8 is used")) << outcome.text;
    EXPECT_TRUE(outcome.Printed("SH grid cells of 8 96 96"));
}

TEST_F(TrapsTest, BadNumbersInKeysWarnWithEntityAndKey) {
    AddWorldKeys("\"_minlight\" \"much\"\n\"_maxlight\" \"300\"\n");
    AppendToMap("{\n\"classname\" \"light\"\n\"origin\" \"0 0 64\"\n\"light\" \"20O\"\n\"_samples\" \"0\"\n}\n");
    const Outcome outcome = RunWell("-v -light -onlygrid MAP");
    EXPECT_TRUE(outcome.Printed("_light \"20O\": \"O\" after the number is not read")) << outcome.text;
    EXPECT_TRUE(outcome.Printed("_samples \"0\": expected a number from 1 to 4096; 1 is used"));
    const std::size_t at = outcome.text.find("_light \"20O\"");
    EXPECT_THAT(outcome.text.substr(at - 24, 24), HasSubstr("(light): ")) << "entity number and class";
    const Outcome bsp = RunWell("-v -bsp MAP");
    EXPECT_TRUE(bsp.Printed("_maxlight \"300\": expected a number from 0 to 255; 255 is used")) << bsp.text;
    EXPECT_TRUE(bsp.Printed("entity 0 (worldspawn): _minlight \"much\": expected a number")) << bsp.text;
}

TEST_F(TrapsTest, EveryRunEndsWithOneLine) {
    for (const std::string &words :
         {"-bsp " + Map(".map").string(), std::string("-vis MAP"), std::string("-light -onlygrid MAP"),
          std::string("-info MAP"), std::string("-export MAP"), std::string("-json MAP")}) {
        const std::string line = LastLine(RunWell(words));
        EXPECT_TRUE(line.starts_with("done: ")) << words << ": " << line;
        for (const char *part : {"warning", " s, ", " CPU s, ", " MB peak memory"})
            EXPECT_THAT(line, HasSubstr(part)) << words;
    }
    EXPECT_TRUE(LastLine(Run("-light /nowhere/x.bsp")).starts_with("failed: no warnings, "));
    EXPECT_TRUE(LastLine(Run("-light -bounce x MAP")).starts_with("failed: "));
}

TEST_F(TrapsTest, BspStageSaysWhatItMade) {
    const Outcome outcome = RunWell("-meta " + Map(".map").string());
    for (const char *count : {" brushes\n", " draw surfaces\n", " vertices\n", " triangles\n", " nodes\n"})
        EXPECT_TRUE(outcome.Printed(count)) << count;
}

TEST_F(TrapsTest, InfoCountsLitPointsAsTheLightStage) {
    /// The number in the nine columns that end `gap` before the last occurrence of the words.
    const auto count = [](const Outcome &outcome, std::string_view words, std::size_t gap) {
        const std::size_t at = outcome.text.rfind(words);
        return at == std::string::npos || at < 9 + gap ? -1 : std::stoi(outcome.text.substr(at - gap - 9, 9));
    };
    const Outcome light = RunWell("-light -onlygrid -sh -gridsh 48 48 48 MAP"), info = RunWell("-info MAP");
    const std::string_view open = "points in the open"; // of the legacy grid first, then of the SH grid
    EXPECT_GT(count(light, open, 1), 0) << light.text;
    EXPECT_EQ(count(light, open, 1), count(info, "lit points", 3)) << light.text << info.text;
    EXPECT_FALSE(info.Printed(" -0 "));
}

TEST_F(TrapsTest, VisWithoutPortalsSaysWhy) {
    std::filesystem::remove(Map(".prt"));
    ExpectError("-vis MAP", "demo.prt is missing");
    ExpectError("-vis MAP", "-saveprt");
    folder_.Write("base/baseq3/maps/demo.lin", "0 0 0\n");
    ExpectError("-vis MAP", "the map leaked");
    ExpectError("-vis MAP", "demo.lin");
}

TEST_F(TrapsTest, VisPercentagesStayWithinAHundred) {
    RunWell("-meta " + Map(".map").string());
    const std::string text = RunWell("-vis MAP").text;
    std::size_t count = 0;
    for (std::size_t at = text.find("%/total"); at != std::string::npos; at = text.find("%/total", at + 1), ++count) {
        const std::size_t begin = text.rfind('(', at) + 1;
        EXPECT_LE(std::stod(text.substr(begin, at - begin)), 100) << text;
    }
    EXPECT_GE(count, 4u);
}

} // namespace

} // namespace q3::test
