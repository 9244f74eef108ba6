// GPL-2.0-or-later. Maps in folders with long names and foreign letters, and maps that another program has open.
#include "common/files/files.h"
#include "tests/support/run_program.h"
#include "tests/support/this_system.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

namespace q3::test {

namespace {

namespace fs = std::filesystem;

using testing::HasSubstr;

class FileNamesTest : public ProgramTest {
  protected:
    /// Compiles the demo in that folder of games, with a report and a log beside the map, and expects all files.
    void ExpectCompiled(const fs::path &base, const std::string &name) {
        const fs::path maps = base / "baseq3/maps";
        fs::create_directories(base);
        fs::copy(game_, base / "baseq3", fs::copy_options::recursive);
        fs::copy_file(maps / "demo.map", maps / (name + ".map"));
        const std::string map = (maps / name).string();
        const std::vector<std::vector<std::string>> stages{
            {"-bsp", "-meta"}, {"-vis", "-saveprt"}, {"-light", "-fast"}};
        for (const auto &stage : stages) {
            std::vector<std::string> words{"-fs_basepath", base.string()};
            words.insert(words.end(), stage.begin(), stage.end());
            words.insert(words.end(), {"-report", map + ".json", "-log", map + ".log", map + ".map"});
            const Outcome outcome = RunProgramFile(words, folder_.Root());
            EXPECT_EQ(outcome.status, 0) << outcome.text;
            EXPECT_TRUE(outcome.Printed(name)) << outcome.text;
        }
        for (const std::string_view end : {".bsp", ".srf", ".prt", ".json", ".log"})
            EXPECT_TRUE(fs::is_regular_file(map + std::string(end))) << map << end;
        EXPECT_THAT(ReadTextFile(map + ".log"), HasSubstr(name));
        EXPECT_THAT(ReadTextFile(map + ".json"), HasSubstr(name));
    }
};

TEST_F(FileNamesTest, MayHoldLettersOfAllLanguagesAndBlanks) {
    ExpectCompiled(folder_ / "\u00c4pfel und B\u00e4ume \u65e5\u672c \U0001f600", "gr\u00f6\u00dfe eins");
}

TEST_F(FileNamesTest, MayBeLongerThan260Characters) {
    fs::path base = folder_.Root();
    for (int i = 0; i < 6; i++)
        base /= std::string(50, char('a' + i));
    ExpectCompiled(base, "deep");
}

TEST_F(FileNamesTest, OfWindowsMayHaveDriveLettersAndBackslashes) {
    if (!kIsWindows)
        GTEST_SKIP() << "only Windows has drive letters";
    std::string name = Map(".bsp").string(), base = (folder_ / "base").string();
    EXPECT_EQ(name.at(1), ':');
    for (const char from : {'/', '\\'}) {
        for (std::string *each : {&name, &base})
            std::replace(each->begin(), each->end(), from, char('/' + '\\' - from));
        for (int i = 0; i < 2; ++i) {
            name[0] = char(name[0] ^ ' '); // a drive letter of either case
            const Outcome outcome = RunProgramFile({"-fs_basepath", base, "-light", "-fast", name}, folder_.Root());
            EXPECT_EQ(outcome.status, 0) << outcome.text;
        }
    }
}

/// Without the second in which the program tries again, since no test can know when it begins.
TEST_F(FileNamesTest, OfAMapThatAnotherProgramHasOpen) {
    std::ifstream reader(Map(".bsp"), std::ios::binary);
    ASSERT_TRUE(reader.is_open());
    if (kIsWindows)
        ExpectError("-light -fast MAP", "demo.bsp: cannot write: Permission denied");
    else
        RunWell("-light -fast MAP");
    reader.close();
    RunWell("-light -fast MAP");
}

} // namespace

} // namespace q3::test
