// GPL-2.0-or-later. q3map2 -convert as editors call it.
#include "common/files/files.h"
#include "tests/program/run_program.h"

namespace q3::test {

namespace {

class ConvertStageTest : public ProgramTest {
  protected:
    std::string Result() const {
        const auto bytes = ReadFile(maps_ / "demo_converted.map");
        return {reinterpret_cast<const char *>(bytes.data()), bytes.size()};
    }
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

TEST_F(ConvertStageTest, UnknownFormatNamesTheNearest) {
    ExpectError("-convert -format map_pb MAP", "did you mean map_bp");
    ExpectError("-convert -format nonsense MAP", "expected map, map_bp, map_220");
}

TEST_F(ConvertStageTest, OptionsThatWouldChangeNothingAreErrors) {
    const std::string source = Map(".map").string();
    for (const std::string_view option : {"-fast", "-wtf", "-modelclip", "-meta", "-patchmeta"})
        ExpectError(fmt::format("-convert -format map {} {}", option, source), fmt::format("{}: ", option));
    ExpectError("-convert -format map -meta MAP", "nothing is compiled");
    ExpectError("-convert -format map -ne 0.01 MAP", "-ne: ");
    ExpectError("-convert -readmap -readbsp MAP", "exclude each other");
}

TEST_F(ConvertStageTest, MissingInputIsNamed) {
    ExpectError("-convert -format map /nowhere/at/all.map", "/nowhere/at/all.map");
}

} // namespace q3::test
