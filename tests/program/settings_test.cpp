// GPL-2.0-or-later. Declared settings: generated files, help, and that every declared option is taken.
#include "q3map2/documentation.h"
#include "q3map2/entity_sections.h"
#include "tests/program/run_program.h"

#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/stages.h"
#include "q3map2/version.h"

#include <gmock/gmock.h>

#include <set>
#include <sstream>

namespace q3::test {

namespace {

using testing::HasSubstr;

std::string FileText(const std::string &path) {
    return ReadTextFile(std::filesystem::path(SOURCE) / path);
}

/// To write them again: q3map2 -help markdown > docs/options.md, and so on.
TEST(GeneratedFiles, AreUpToDate) {
    EXPECT_EQ(FileText("docs/options.md"), MarkdownPage()) << "q3map2 -help markdown > docs/options.md";
    EXPECT_EQ(FileText("docs/q3map2.1"), ManualPage()) << "q3map2 -help man > docs/q3map2.1";
    EXPECT_EQ(FileText("tools/completions/q3map2.bash"), BashCompletion());
    EXPECT_EQ(FileText("tools/completions/_q3map2"), ZshCompletion());
    EXPECT_EQ(FileText("tools/completions/q3map2.fish"), FishCompletion());
}

/// Calls use(entry) for every option of the program.
template <typename Use> void ForOptions(const Use &use) {
    std::vector<std::vector<SettingSection>> all{GlobalSections()};
    for (const Stage &stage : Stages())
        if (stage.settings)
            all.push_back(stage.settings());
    for (const auto &sections : all)
        for (const SettingSection &section : sections)
            for (const SettingEntry &entry : section.entries)
                use(entry);
}

TEST(Declarations, AreComplete) {
    const auto check = [](const SettingEntry &entry) {
        EXPECT_FALSE(entry.info.help.empty()) << entry.info.name;
        EXPECT_LT(entry.info.help.size(), 110u) << entry.info.name << ": one line";
        EXPECT_FALSE(entry.info.help.ends_with('.')) << entry.info.name;
        EXPECT_EQ(entry.info.values.empty(), entry.info.kind == SettingKind::Flag) << entry.info.name;
        if (entry.info.kind == SettingKind::Integer || entry.info.kind == SettingKind::Number) {
            EXPECT_FALSE(entry.initial.empty()) << entry.info.name << " needs a default";
        }
    };
    ForOptions(check);
    ForOptions([](const SettingEntry &entry) { EXPECT_TRUE(entry.info.name.starts_with('-')) << entry.info.name; });
}

TEST(Declarations, HaveDefaultsThatTheOptionWouldAccept) {
    int numbers = 0;
    ForOptions([&](const SettingEntry &entry) {
        const bool isNumber = entry.info.kind == SettingKind::Integer || entry.info.kind == SettingKind::Number;
        std::istringstream words(isNumber ? entry.initial : "");
        for (double number = 0; words >> number; ++numbers)
            EXPECT_TRUE(entry.info.range.Contains(number)) << entry.info.name << ": default " << number;
    });
    EXPECT_GT(numbers, 50);
}

TEST(Declarations, NameEveryOptionOnceAStage) {
    for (const Stage &stage : Stages()) {
        std::set<std::string> names;
        for (const std::string &name : stage.OptionNames()) {
            const bool first = names.insert(LowerCase(name)).second;
            EXPECT_TRUE(first || name == "-v") << stage.word << " has two " << name; // vis takes a second -v
        }
    }
}

TEST_F(ProgramTest, HelpListsTheStages) {
    const Outcome outcome = RunWell("-help");
    for (const char *stage : {"-bsp", "-vis", "-light", "-export", "-import", "-json", "-info", "-shpreview"})
        EXPECT_TRUE(outcome.Printed(stage)) << stage;
    EXPECT_TRUE(RunWell("-help light").Printed("-gridscalesh"));
    EXPECT_TRUE(RunWell("-help -light").Printed("-gridscalesh"));
    EXPECT_TRUE(RunWell("-help game").Printed("quake3"));
    EXPECT_TRUE(RunWell("-help keys").Printed("_minlight"));
}

TEST_F(ProgramTest, HelpExplainsOneOption) {
    const Outcome outcome = RunWell("-help -gridsh");
    EXPECT_TRUE(outcome.Printed("-gridsh X Y Z"));
    EXPECT_TRUE(outcome.Printed("game units"));
    EXPECT_FALSE(outcome.Printed("-gridscalesh F"));
    EXPECT_TRUE(RunWell("-help _deviance").Printed("_jitter"));
}

TEST_F(ProgramTest, UnknownTopicIsAnErrorWithTheNearestName) {
    ExpectError("-help lihgt", "did you mean -light?");
    ExpectError("-help -gridhs", "did you mean -gridsh?");
    ExpectError("-help foo", "no such stage, option or key");
}

TEST_F(ProgramTest, HelpWritesTheGeneratedFiles) {
    EXPECT_EQ(RunWell("-help -markdown").text, MarkdownPage());
    EXPECT_EQ(RunWell("-help man").text, ManualPage());
    EXPECT_EQ(RunWell("-help bash").text, BashCompletion());
}

TEST_F(ProgramTest, VersionSaysWhatTheProgramIs) {
    const std::string text = RunWell("-version").text;
    EXPECT_TRUE(text.starts_with(std::string(kVersion) + "\n"));
    for (const char *part : {"commit ", "compiler ", "Embree ", "SIMD "})
        EXPECT_THAT(text, HasSubstr(part));
}

TEST_F(ProgramTest, SettingsThatDifferAreListedWithTheirSource) {
    std::string map = folder_.ReadBack("base/baseq3/maps/demo.map");
    const std::size_t at = map.find("\"classname\" \"worldspawn\"");
    ASSERT_NE(at, std::string::npos);
    folder_.Write("base/baseq3/maps/demo.map", map.insert(at, "\"_maxlight\" \"200\"\n\"_minlight\" \"0\"\n"));
    const Outcome bsp = RunWell("-bsp -meta -samplesize 16 -np 20 MAP");
    EXPECT_TRUE(bsp.Printed("  -meta (command line; default off)")) << bsp.text;
    EXPECT_TRUE(bsp.Printed("  -np 20 (command line; default 0)"));
    EXPECT_FALSE(bsp.Printed("  -samplesize")) << "that is the default";
    const Outcome light = RunWell("-light -fast -bounce 2 MAP");
    EXPECT_TRUE(light.Printed("  -bounce 2 (command line; default 0)")) << light.text;
    EXPECT_TRUE(light.Printed("  _maxlight 200 (worldspawn; default 255)"));
    EXPECT_FALSE(light.Printed("  _minlight"));
}

} // namespace

} // namespace q3::test
