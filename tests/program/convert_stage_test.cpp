// GPL-2.0-or-later. q3map2 -convert as editors call it.
#include "common/files/files.h"
#include "tests/support/run_program.h"

namespace q3::test {

namespace {

class ConvertStageTest : public ProgramTest {
  protected:
    std::string Result() const { return ReadTextFile(maps_ / "demo_converted.map"); }
};

} // namespace

TEST_F(ConvertStageTest, EditorsOpenABsp) {
    RunWell("-v -game quake3 -convert -format map_bp MAP");
    EXPECT_NE(Result().find("brushDef"), std::string::npos);
    EXPECT_NE(Result().find("Made by q3map2-sh -convert -format map_bp"), std::string::npos);
}

TEST_F(ConvertStageTest, EditorsAskForAMapWithTwoBlanks) {
    const std::vector<std::string> words{
        "-fs_basepath",      (folder_.Root() / "base").string(), "-convert", "-format", "map_bp", "-readmap", "",
        Map(".map").string()};
    const Outcome outcome = RunProgramFile(words, folder_.Root());
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_NE(Result().find("brushDef"), std::string::npos);
    EXPECT_EQ(outcome.text.find("WARNING: Unknown"), std::string::npos) << outcome.text;
}

TEST_F(ConvertStageTest, TheNameOfTheFileSaysWhatToRead) {
    EXPECT_TRUE(RunWell("-convert -format map_220 " + Map(".map").string()).Printed("demo.map\n"));
    EXPECT_TRUE(RunWell("-convert -format map_220 -readbsp " + Map(".map").string()).Printed("demo.bsp\n"));
    EXPECT_TRUE(RunWell("-convert -format map_220 -readmap MAP").Printed("demo.map\n"));
}

TEST_F(ConvertStageTest, ResultCompiles) {
    RunWell("-convert -format map_220 MAP");
    const Outcome outcome = RunWell("-bsp -meta " + (maps_ / "demo_converted.map").string());
    EXPECT_FALSE(outcome.Printed("leaked")) << outcome.text;
}

TEST_F(ConvertStageTest, WritesAseUnlessTold) {
    RunWell("-convert MAP");
    EXPECT_TRUE(ReadTextFile(maps_ / "demo.ase").starts_with("*3DSMAX_ASCIIEXPORT"));
}

TEST_F(ConvertStageTest, ModelsOfAMapSourceAreCompiledFirst) {
    const std::string source = Map(".map").string();
    std::filesystem::remove(maps_ / "demo.bsp");
    RunWell("-convert -format obj -readmap -meta " + source);
    const std::string obj = ReadTextFile(maps_ / "demo.obj");
    EXPECT_NE(obj.find("mtllib demo.mtl"), std::string::npos);
    EXPECT_NE(obj.find("\nf "), std::string::npos);
    EXPECT_NE(ReadTextFile(maps_ / "demo.mtl").find("newmtl "), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(maps_ / "demo.bsp"));
}

TEST_F(ConvertStageTest, LightmapCoordinatesAndShaderNames) {
    RunWell("-convert -format obj -lightmapastexcoord MAP");
    EXPECT_NE(ReadTextFile(maps_ / "demo.mtl").find("no_lightmap"), std::string::npos);
    RunWell("-convert -format obj -shaderasbitmap MAP");
    EXPECT_EQ(ReadTextFile(maps_ / "demo.mtl").find("map_Kd ../"), std::string::npos);
}

TEST_F(ConvertStageTest, AnotherGameHasItsVersion) {
    RunWell("-convert -format wolf MAP");
    EXPECT_EQ(IntOf(ReadFile(maps_ / "demo_c.bsp"), 4), 47);
    RunWell("-game wolf -info " + (maps_ / "demo_c.bsp").string());
    ExpectError("-convert -format wolf -readmap " + Map(".map").string(), "compile the map with -game");
    ExpectError("-convert -format wolf -shadersasbitmap MAP", "there are no materials");
    ExpectError("-convert -format wolv MAP", "did you mean wolf");
}

TEST_F(ConvertStageTest, UnknownFormatNamesTheNearest) {
    ExpectError("-convert -format map_pb MAP", "did you mean map_bp");
    ExpectError("-convert -format nonsense MAP", "expected ase, obj, map, map_bp, map_220");
}

TEST_F(ConvertStageTest, OptionsThatWouldChangeNothingAreErrors) {
    const std::string source = Map(".map").string();
    for (const std::string_view option : {"-fast", "-wtf", "-modelclip", "-meta", "-patchmeta"})
        ExpectError(fmt::format("-convert -format map {} {}", option, source), fmt::format("{}: ", option));
    for (const std::string_view option : {"-shadersasbitmap", "-lightmapsastexcoord", "-deluxemapsastexcoord"})
        ExpectError(fmt::format("-convert -format map {} MAP", option), "there are no materials");
    ExpectError("-convert -format obj -fast MAP", "-fast: ");
    ExpectError("-convert -format map -meta MAP", "nothing is compiled");
    ExpectError("-convert -format map -ne 0.01 MAP", "-ne: ");
    ExpectError("-convert -readmap -readbsp MAP", "exclude each other");
}

TEST_F(ConvertStageTest, MissingInputIsNamed) {
    const std::string nowhere = (folder_ / "nowhere/at/all.map").string();
    ExpectError("-convert -format map " + nowhere, nowhere);
}

} // namespace q3::test
