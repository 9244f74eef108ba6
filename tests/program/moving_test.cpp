// GPL-2.0-or-later. Every option, key and directive of NetRadiant's q3map2 is known, or the guide says why not.
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/cli/documentation.h"
#include "q3map2/cli/reference_pages.h"
#include "q3map2/shader/shader_library.h"
#include "q3map2/stages/stages.h"
#include "tests/support/game_folder.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace q3::test {

namespace {

using WordSet = std::set<std::string>;

/// Lines of a file of tests/data/established but comments.
std::vector<std::string> EstablishedLines(std::string_view name) {
    std::istringstream in(ReadTextFile(std::filesystem::path(TEST_DATA) / "established" / name));
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);)
        if (!line.empty() && line[0] != '#')
            lines.push_back(line);
    return lines;
}

/// Words by section.
std::map<std::string, WordSet> EstablishedWords() {
    std::map<std::string, WordSet> words;
    for (const std::string &line : EstablishedLines("words.txt")) {
        const std::size_t colon = line.find(':');
        WordSet &section = words[line.substr(0, colon)];
        std::istringstream rest(line.substr(colon + 1));
        for (std::string word; rest >> word;)
            section.insert(word);
    }
    return words;
}

class MovingTest : public testing::Test {
  protected:
    /// All words in `code` of the lines from this heading to the next of its level.
    static WordSet CodeWords(std::string_view text) {
        static const std::regex kCode("`([^`]*)`");
        WordSet words;
        const std::string copy(text);
        for (std::sregex_iterator at(copy.begin(), copy.end(), kCode), end; at != end; ++at)
            words.insert((*at)[1]);
        return words;
    }
    std::string Section(std::string_view heading) const {
        const std::size_t begin = page_.find(fmt::format("\n## {}\n", heading));
        if (begin == std::string::npos)
            return {};
        return page_.substr(begin, page_.find("\n## ", begin + 1) - begin);
    }
    /// The words of the table "Missing" that the row of `section` excuses; each row has a reason.
    WordSet Missing(const std::string &section) const {
        WordSet words;
        std::istringstream lines(Section("Missing"));
        for (std::string line; std::getline(lines, line);) {
            const bool isRow = line.starts_with("| " + section + " |") || line.starts_with("| `" + section + "` |");
            if (!isRow)
                continue;
            const std::size_t second = line.find('|', 2), third = line.find('|', second + 1);
            words.merge(CodeWords(line.substr(second, third - second)));
            EXPECT_GT(line.size() - third, 20u) << "no reason: " << line;
        }
        return words;
    }
    /// Expects that each of `words` is known or excused, not both.
    void ExpectKnownOrExcused(const std::string &section, const WordSet &words, const WordSet &known) const {
        const WordSet missing = Missing(section);
        for (const std::string &word : words)
            EXPECT_NE(known.contains(LowerCase(word)), missing.contains(word)) << section << ": " << word;
        for (const std::string &word : missing)
            EXPECT_TRUE(words.contains(word)) << section << ": " << word << " is no word of NetRadiant's q3map2";
    }

    const std::string page_ = ReadTextFile(std::filesystem::path(SOURCE) / "docs/guide/from_q3map2.md");
    const std::map<std::string, WordSet> words_ = EstablishedWords();
};

WordSet OptionNames(const std::vector<SettingSection> &sections) {
    WordSet names;
    for (const SettingSection &section : sections)
        for (const SettingEntry &entry : section.entries) {
            names.insert(LowerCase(entry.info.name));
            for (const std::string_view alias : entry.info.aliases)
                names.insert(LowerCase(alias));
        }
    return names;
}

TEST_F(MovingTest, EveryOptionIsKnownOrExcused) {
    ExpectKnownOrExcused("global", words_.at("global"), OptionNames(GlobalSections()));
    const std::vector<Stage> stages = Stages();
    for (const auto &[section, words] : words_) {
        if (!section.starts_with('-'))
            continue;
        const auto stage = std::ranges::find(stages, section, &Stage::word);
        if (Missing("stages").contains(section)) {
            EXPECT_EQ(stage, stages.end()) << section;
            continue;
        }
        ASSERT_NE(stage, stages.end()) << section;
        ExpectKnownOrExcused(section, words, OptionNames(SectionsOf(*stage)));
    }
}

TEST_F(MovingTest, ThePageNamesEveryOptionInItsSection) {
    for (const auto &[section, words] : words_) {
        if (section != "global" && !section.starts_with('-'))
            continue;
        std::string text = Section(section == "global" ? "Global options" : section);
        if (text.empty()) { // a row of the table of small stages
            static const std::regex kRow("\n\\| `[^\n]*");
            const std::string others = Section("Other stages");
            for (std::sregex_iterator at(others.begin(), others.end(), kRow), end; at != end; ++at)
                if (const std::string row = at->str();
                    row.substr(0, row.find('|', 3)).find("`" + section + "`") != row.npos)
                    text = row;
        }
        EXPECT_FALSE(text.empty()) << section;
        const WordSet named = CodeWords(text);
        for (const std::string &word : words)
            EXPECT_TRUE(named.contains(word) || Missing(section).contains(word)) << section << ": " << word;
    }
}

TEST_F(MovingTest, EveryGameIsKnownOrExcused) {
    WordSet known;
    for (const Game &game : Games())
        known.insert(std::string(game.name));
    ExpectKnownOrExcused("games", words_.at("games"), known);
}

TEST_F(MovingTest, EveryKeyIsKnownOrExcused) {
    ExpectKnownOrExcused("keys", words_.at("keys"), OptionNames(EntitySections()));
}

/// Runs a shader with this line through the parser. Number of warnings about it.
int WarningsOf(const std::string &line) {
    const GameFolder folder;
    // Other shaders that examples name come first.
    folder.Write("scripts/test.shader",
                 "textures/test/wall\n{\n}\ntextures/mymap/terrain_base\n{\n}\ntextures/test/s\n{\n\t" + line +
                     "\n}\n");
    KeptLog out;
    VirtualFileSystem vfs(out.log);
    vfs.Mount(folder.Root(), "pk3");
    // Materials are of one game alone.
    const char *game = line.starts_with("q3map_material") ? "etut" : "quake3";
    ShaderLibrary library(vfs, *FindGame(game), {}, out.log);
    library.Get("textures/test/s");
    return out.log.WarningCount("unknown shader directive") + out.log.WarningCount("incomplete shader directive") +
           out.log.WarningCount("shader directive");
}

TEST_F(MovingTest, EveryDirectiveAndExampleIsReadWithoutAWarning) {
    for (const std::string &line : EstablishedLines("directives.txt"))
        EXPECT_EQ(WarningsOf(line), 0) << line;
    const WordSet known = OptionNames(DirectiveSections());
    for (const std::string &line : EstablishedLines("directives.txt")) {
        const std::string name = LowerCase(line.substr(0, line.find(' ')));
        EXPECT_TRUE(known.contains(name)) << name << " is not declared";
    }
    for (const SettingSection &section : DirectiveSections())
        for (const SettingEntry &entry : section.entries)
            if (section.title != "Inside stages") {
                EXPECT_EQ(WarningsOf(DirectiveExample(entry.info)), 0) << DirectiveExample(entry.info);
            }
    EXPECT_EQ(WarningsOf("q3map_nosuchthing 1"), 1);
    EXPECT_EQ(WarningsOf("q3map_sun 1 1"), 1);
    EXPECT_EQ(WarningsOf("q3map_tcMod twist 2"), 1);
}

} // namespace

} // namespace q3::test
