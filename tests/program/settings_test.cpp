// GPL-2.0-or-later. Declared settings: generated files, help, and that every declared option is taken.
#include "q3map2/cli/completion.h"
#include "q3map2/cli/documentation.h"
#include "q3map2/cli/help.h"
#include "q3map2/cli/reference_pages.h"
#include "tests/support/run_program.h"

#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/report/version.h"
#include "q3map2/stages/stages.h"
#include "tests/support/kept_log.h"

#include <gmock/gmock.h>

#include <set>
#include <sstream>

namespace q3::test {

namespace {

using testing::HasSubstr;

std::string FileText(const std::string &path) {
    return ReadTextFile(std::filesystem::path(SOURCE) / path);
}

/// tools/scripts/generate writes them again.
TEST(GeneratedFiles, AreUpToDate) {
    for (const ReferencePage &page : ReferencePages())
        EXPECT_EQ(FileText(fmt::format("docs/reference/{}", page.file)), page.text(Stages())) << page.file;
    EXPECT_EQ(FileText("docs/q3map2.1"), ManualPage(Stages()));
    EXPECT_EQ(FileText("tools/generated/completions/q3map2.bash"), BashCompletion(Stages()));
    EXPECT_EQ(FileText("tools/generated/completions/_q3map2"), ZshCompletion(Stages()));
    EXPECT_EQ(FileText("tools/generated/completions/q3map2.fish"), FishCompletion(Stages()));
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
        EXPECT_FALSE(entry.info.since.empty()) << entry.info.name;
        EXPECT_LT(entry.info.help.size(), 120u) << entry.info.name << ": one line";
        EXPECT_FALSE(entry.info.help.ends_with('.')) << entry.info.name;
        EXPECT_EQ(entry.info.values.empty(), entry.info.kind == SettingKind::Flag) << entry.info.name;
        if (entry.info.kind == SettingKind::Integer || entry.info.kind == SettingKind::Number) {
            EXPECT_FALSE(entry.initial.empty()) << entry.info.name << " needs a default";
        }
    };
    ForOptions(check);
    ForOptions([](const SettingEntry &entry) { EXPECT_TRUE(entry.info.name.starts_with('-')) << entry.info.name; });
    for (const SettingSection &section : DirectiveSections())
        for (const SettingEntry &entry : section.entries) {
            EXPECT_FALSE(entry.info.since.empty()) << entry.info.name;
            EXPECT_FALSE(entry.info.help.empty() || entry.info.help.ends_with('.')) << entry.info.name;
            EXPECT_LT(entry.info.help.size(), 120u) << entry.info.name << ": one line";
            EXPECT_TRUE(entry.info.details.empty() || entry.info.details.ends_with('.')) << entry.info.name;
            EXPECT_FALSE(entry.stage.empty()) << entry.info.name;
        }
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

/// What is wrong with the example of a setting, as an option of a command line is taken: nothing, or a message.
std::string FaultOfExample(const SettingInfo &info, SettingKind kind) {
    if (info.example.empty())
        return info.MinValues() == 0 ? "" : "it has values, but no example";
    std::istringstream line(fmt::format("{} {}", info.name, info.example));
    std::vector<std::string> words;
    for (std::string word; line >> word;)
        words.push_back(word);
    Arguments arguments(words);
    KeptLog out;
    try {
        TakeOccurrence(info, kind, arguments, 0, out.log);
    } catch (const Error &error) {
        return error.what();
    }
    // Examples of options may go on with the option that they need.
    if (!arguments.Empty() && !arguments.Rest().front().starts_with('-'))
        return "left: " + arguments.Rest().front();
    return out.text;
}

/// The same for a key, in an entity.
std::string FaultOfKey(const SettingInfo &info) {
    if (info.example.empty())
        return info.values.empty() ? "" : "it has values, but no example";
    Entity entity;
    entity.Set(std::string(info.name), std::string(info.example));
    KeptLog out;
    WarnOfBadKeys(entity, 1, std::array{EntityKey{info}}, out.log);
    return out.text;
}

TEST(Declarations, HaveExamplesThatTheParserTakes) {
    int examples = 0;
    const auto check = [&](const SettingEntry &entry) {
        EXPECT_EQ(FaultOfExample(entry.info, entry.info.kind), "") << entry.info.name;
        examples += !entry.info.example.empty();
    };
    ForOptions(check);
    for (const SettingSection &section : EntitySections())
        for (const SettingEntry &entry : section.entries)
            EXPECT_EQ(entry.info.since.empty() ? "no origin" : FaultOfKey(entry.info), "") << entry.info.name;
    for (const SettingSection &section : DirectiveSections())
        for (const SettingEntry &entry : section.entries)
            EXPECT_EQ(entry.info.values.empty(), entry.info.example.empty()) << entry.info.name;
    EXPECT_GT(examples, 150);
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
    EXPECT_TRUE(outcome.Printed("over 0 up to 1000000 game"));
    EXPECT_FALSE(outcome.Printed("-gridscalesh F"));
    EXPECT_TRUE(RunWell("-help _deviance").Printed("_jitter"));
    EXPECT_TRUE(RunWell("-help -contrast").Printed("from -1000000 to 1000000")) << "also the range of all settings";
    EXPECT_TRUE(RunWell("-help q3map_surfacelight").Printed("Since: q3map2"));
    EXPECT_TRUE(RunWell("-help shader").Printed("q3map_backShader SHADER"));
    EXPECT_TRUE(RunWell("-help vrad").Printed("-chop N"));
}

TEST_F(ProgramTest, HelpFitsATerminal) {
    const std::string all = RunWell("-help all").text;
    EXPECT_EQ(all.find('`'), std::string::npos) << all.substr(all.find('`'), 80);
    std::istringstream overview(RunWell("-help").text);
    for (std::string line; std::getline(overview, line);)
        EXPECT_LE(line.size(), 104u) << line;
    const std::string light = RunWell("-help light").text;
    EXPECT_EQ(light.find("Does nothing"), std::string::npos) << "-help vrad has those";
    EXPECT_EQ(light.find("\n  _light"), std::string::npos) << "nor the key of that name";
    EXPECT_THAT(light, HasSubstr("-help vrad"));
    EXPECT_THAT(light, HasSubstr("light is also a key of entities (q3map2 -help keys)"));
}

#ifndef _WIN32 // where no bash is to be expected
/// What bash offers after these words, the last of which is being typed.
std::string Completed(const std::string &words) {
    const std::string script = fmt::format("source {}/tools/generated/completions/q3map2.bash; COMP_WORDS=({}); "
                                           "COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _q3map2; "
                                           "echo \"${{COMPREPLY[*]}}\"",
                                           SOURCE, words);
    std::string text;
    if (FILE *pipe = popen(fmt::format("bash -c '{}'", script).c_str(), "r")) {
        char buffer[4096];
        for (std::size_t got; (got = fread(buffer, 1, sizeof buffer, pipe)) > 0;)
            text.append(buffer, got);
        pclose(pipe);
    }
    return text;
}

TEST(Completion, OffersTheValuesOfOptions) {
    EXPECT_THAT(Completed(R"(q3map2 -game "")"), HasSubstr("quake3 quakelive nexuiz xonotic"));
    EXPECT_EQ(Completed("q3map2 -light -preset n"), "normal\n");
    EXPECT_EQ(Completed("q3map2 -light -gridformats sh,spa"), "sh,sparse\n");
    EXPECT_EQ(Completed("q3map2 -light -hdrfiles re"), "rend2\n");
    EXPECT_EQ(Completed("q3map2 -convert -format map_2"), "map_220\n");
    EXPECT_EQ(Completed("q3map2 -light -bouncecolor"), "-bouncecolorratio\n");
    EXPECT_EQ(Completed("q3map2 -light -super /"), "\n") << "a number";
    EXPECT_THAT(Completed("q3map2 -fs_basepath /us"), HasSubstr("/usr"));
}
#endif

TEST_F(ProgramTest, UnknownTopicIsAnErrorWithTheNearestName) {
    ExpectError("-help lihgt", "did you mean -light");
    ExpectError("-help -gridhs", "did you mean -gridsh?");
    ExpectError("-help foo", "no such stage, option, key or directive");
}

TEST_F(ProgramTest, HelpWritesTheGeneratedFiles) {
    for (const ReferencePage &page : ReferencePages())
        EXPECT_EQ(RunWell(fmt::format("-help {}", page.file)).text, page.text(Stages())) << page.file;
    EXPECT_EQ(RunWell("-help man").text, ManualPage(Stages()));
    EXPECT_EQ(RunWell("-help bash").text, BashCompletion(Stages()));
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
