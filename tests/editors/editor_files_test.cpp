// GPL-2.0-or-later. Menus keep the limits of the editors that read them.
#include "q3map2/editors/editor_files.h"

#include <gmock/gmock.h>

#include <set>
#include <sstream>

namespace q3::test {

namespace {

class EditorFiles : public testing::Test {
  protected:
    const std::vector<std::string_view> presets_{"draft", "normal", "final"};
    const std::vector<EditorBuild> builds_ = EditorBuilds(presets_);
    const Game &game_ = *FindGame("quake3");
};

std::string Replaced(std::string text, std::string_view what, std::string_view by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

std::vector<std::string> Lines(const std::string &text) {
    std::istringstream in(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
    return lines;
}

TEST_F(EditorFiles, BuildsHaveDifferentNames) {
    std::set<std::string> labels;
    for (const EditorBuild &build : builds_) {
        EXPECT_TRUE(labels.insert(build.label).second) << build.label;
        EXPECT_FALSE(build.steps.empty());
    }
}

TEST_F(EditorFiles, MapsOfMenusLoadInEveryEngine) {
    for (const EditorBuild &build : builds_)
        for (const std::string &step : build.steps)
            EXPECT_FALSE((step + " ").find(" -sh ") != std::string::npos) << "a version 47 file: " << step;
}

TEST_F(EditorFiles, TheBuildMenuUsesVariablesThatThereAre) {
    const std::set<std::string> known{"RadiantPath", "ExecutableType", "MonitorAddress", "EnginePath", "UserEnginePath",
                                      "GameName",    "MapFile",        "BspFile",        "q3map2"};
    const std::string menu = BuildMenu(builds_, game_);
    int variables = 0;
    for (std::size_t at = 0; (at = menu.find('[', at)) != std::string::npos; ++at, ++variables)
        EXPECT_EQ(known.count(menu.substr(at + 1, menu.find(']', at) - at - 1)), 1u) << menu.substr(at, 20);
    EXPECT_GT(variables, 40);
    // Nothing but the program: there the editor puts folders of its own.
    EXPECT_THAT(menu, testing::HasSubstr("<var name=\"q3map2\">\"[RadiantPath]q3map2.[ExecutableType]\"<cond "));
}

TEST_F(EditorFiles, ProjectValuesFitTheEditorsBuffer) {
    const std::string path(80, 'p');
    int builds = 0;
    for (const std::string &line : Lines(ProjectTemplate(builds_, game_, 7))) {
        if (!line.starts_with("<key name=\"bsp_"))
            continue;
        ++builds;
        std::string value = line.substr(line.find("value=\"") + 7);
        value = Replaced(value.substr(0, value.rfind('"')), "&quot;", "\"");
        value = Replaced(Replaced(value, "&amp;", "&"), "$TEMPLATEapppath", path);
        value = Replaced(Replaced(value, "$TEMPLATEenginepath", path), "$TEMPLATEq3map2", "x64/q3map2");
        value = Replaced(value, "$TEMPLATEbasedir", "baseq3/");
        EXPECT_EQ(value.find("TEMPLATE"), std::string::npos) << value;
        EXPECT_LT(value.size(), 1024u) << value;
        EXPECT_FALSE(value.ends_with("&&"));
        EXPECT_EQ(std::ranges::count(value, '#'), std::ranges::count(value, '$')) << "monitored in every step";
    }
    EXPECT_EQ(builds, int(builds_.size()));
}

TEST_F(EditorFiles, ProfilesHaveNoTrailingCommas) {
    for (const std::string &text : {CompilationProfiles(builds_, game_), EngineProfiles(), GameConfig(game_)}) {
        std::string dense;
        for (const char c : text)
            if (c != ' ' && c != '\n')
                dense += c;
        EXPECT_EQ(dense.find(",]"), std::string::npos);
        EXPECT_EQ(dense.find(",}"), std::string::npos);
        EXPECT_TRUE(dense.ends_with('}'));
    }
}

} // namespace

} // namespace q3::test
