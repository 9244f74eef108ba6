// GPL-2.0-or-later. -log, -report, and color on terminals.
#include "tests/support/run_program.h"
#include "tests/support/this_system.h"

#include "common/files/files.h"

#include <glib.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace q3::test {

namespace {

using testing::HasSubstr;
using testing::Not;

class ReportTest : public ProgramTest {
  protected:
    std::string File(std::string_view name) const { return ReadTextFile(maps_ / name); }
    std::string Path(std::string_view name) const { return (maps_ / name).string(); }
};

TEST_F(ReportTest, HoldsSettingsPassesCountsAndWarnings) {
    RunWell("-light -sh -gridsh 64 64 64 -nonsense -report " + Path("r.json") + " MAP");
    const auto report = nlohmann::json::parse(File("r.json"));
    EXPECT_EQ(report["status"], "done");
    EXPECT_EQ(report["commandLine"][2], "-light");
    EXPECT_GT(report["peakMemoryBytes"], 1e6);
    bool cell = false, traced = false;
    for (const auto &setting : report["settings"])
        cell |= setting["name"] == "-gridsh" && setting["value"] == "64 64 64" && setting["from"] == "command line";
    double cpu = 0;
    for (const auto &pass : report["passes"]) {
        cpu += double(pass["cpuSeconds"]);
        if (pass["name"] == "TraceGridSH") {
            traced = true;
            EXPECT_GT(pass["counts"]["rays"], 0);
            EXPECT_TRUE(pass["counts"].contains("pairs of point and light")) << "a count of -v";
        }
    }
    EXPECT_TRUE(cell && traced);
    EXPECT_LE(cpu, double(report["cpuSeconds"]) + 1e-9);
    ASSERT_EQ(report["warnings"].size(), 1u);
    EXPECT_EQ(report["warnings"][0]["kind"], "unknown option");
}

TEST_F(ReportTest, FailedRunsWriteOneWithTheError) {
    EXPECT_EQ(Run("-light -bounce x -report " + Path("r.json") + " MAP").status, 1);
    const auto report = nlohmann::json::parse(File("r.json"));
    EXPECT_EQ(report["status"], "failed");
    EXPECT_THAT(std::string(report["error"]), HasSubstr("-bounce"));
}

TEST_F(ReportTest, AFolderThatIsNotThereIsAnError) {
    const Outcome run = Run("-info -report /nowhere/r.json MAP");
    EXPECT_EQ(run.status, 1);
    EXPECT_THAT(run.text, HasSubstr("-report: /nowhere/r.json"));
    ExpectError("-light -log /nowhere/x.log MAP", "-log /nowhere/x.log: the file cannot be written");
}

TEST_F(ReportTest, TheLogFileHoldsWhatIsPrinted) {
    const Outcome run = RunWell("-light -log " + Path("x.log") + " MAP");
    EXPECT_THAT(run.text, HasSubstr(File("x.log").substr(0, 200)));
    EXPECT_THAT(File("x.log"), HasSubstr("\ndone: "));
}

TEST_F(ReportTest, WarningsAreColoredOnTerminalsAlone) {
    if (kIsWindows)
        GTEST_SKIP() << kNoTerminals;
    const std::vector<std::string> words{"-fs_basepath", folder_.Root().string(), "-light", "-nonsense",
                                         Map(".bsp").string()};
    g_unsetenv("NO_COLOR");
    g_setenv("TERM", "xterm", TRUE);
    EXPECT_THAT(RunOnTerminal(words, folder_.Root()).text, HasSubstr("\x1b[33mWARNING: "));
    EXPECT_THAT(RunProgramFile(words, folder_.Root()).text, Not(HasSubstr("\x1b[33m")));
    g_setenv("NO_COLOR", "1", TRUE);
    EXPECT_THAT(RunOnTerminal(words, folder_.Root()).text, Not(HasSubstr("\x1b[33m")));
    g_unsetenv("NO_COLOR");
}

/// What build tools and editors read: no live line, which begins with a carriage return, and no colors.
TEST_F(ReportTest, APipeGetsWholePlainLines) {
    for (const std::string stage : {"-bsp -meta", "-vis", "-light -sh -nonsense"}) {
        const std::string text = RunWell(stage + " " + Map(".map").string()).text;
        EXPECT_EQ(text.find('\r'), text.npos) << text;
        EXPECT_EQ(text.find('\x1b'), text.npos) << text;
        EXPECT_THAT(text, testing::EndsWith("\n"));
    }
    const std::string error = Run("-light -bounce x MAP").text;
    EXPECT_EQ(error.find_first_of("\r\x1b"), error.npos) << error;
}

} // namespace

} // namespace q3::test
