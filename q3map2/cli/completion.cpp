// GPL-2.0-or-later. Completion of the command line in shells.
#include "q3map2/cli/completion.h"

#include "q3map2/cli/documentation.h"
#include "q3map2/cli/reference_pages.h"
#include "q3map2/shader/games.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

namespace q3 {

namespace {

/// What can follow an option.
struct CompletionValues {
    enum class Kind {
        Any,   ///< a number or a name: nothing to propose
        Words, ///< one of `words`
        List,  ///< some of `words`, separated by commas
        Files,
        Folders
    };
    Kind kind = Kind::Any;
    std::vector<std::string> words{};
};

std::vector<std::string> GameNames() {
    std::vector<std::string> names;
    for (const Game &game : Games())
        names.emplace_back(game.name);
    return names;
}

/// The surfaceparms of quake3, but for "default": the flags that every shader starts with, which no option names.
std::vector<std::string> SurfaceParmNames() {
    std::vector<std::string> names;
    for (const SurfaceParm &parm : Games().front().surfaceParms)
        if (parm.name != "default")
            names.emplace_back(parm.name);
    return names;
}

std::vector<std::string> HelpTopics(StageList stages) {
    std::vector<std::string> topics{"all", "game", "keys", "shader", "vrad"};
    for (const Stage &stage : stages)
        topics.emplace_back(stage.word.substr(1));
    return topics;
}

/// The words of a value such as "draft|normal|final" that can be typed: of "N|inf" only inf, since capitals stand for a
/// number or a name.
std::vector<std::string> ChoiceWords(std::string_view value) {
    std::vector<std::string> words;
    for (std::size_t at = 0; at <= value.size();) {
        const std::size_t end = std::min(value.find('|', at), value.size());
        const std::string_view word = value.substr(at, end - at);
        if (std::ranges::none_of(word, [](char c) { return c >= 'A' && c <= 'Z'; }))
            words.emplace_back(word);
        at = end + 1;
    }
    return words;
}

CompletionValues ValuesOf(StageList stages, const SettingInfo &info) {
    using enum CompletionValues::Kind;
    if (info.name == "-game")
        return {Words, GameNames()};
    if (info.name == "-globalflag")
        return {Words, SurfaceParmNames()};
    if (info.name == "-help")
        return {Words, HelpTopics(stages)};
    for (const Stage &stage : stages)
        if (stage.choices)
            if (std::vector<std::string> words = stage.choices(info.name); !words.empty())
                return {info.values == "LIST" ? List : Words, std::move(words)};
    const std::string_view first = info.values.substr(0, info.values.find(' '));
    if (first.find('|') != std::string_view::npos)
        return {Words, ChoiceWords(first)};
    if (first == "DIR")
        return {Folders};
    if (first.starts_with("FILE") || first == "IMAGE")
        return {Files};
    return {};
}

/// The names of options as one string, each followed by a blank.
std::string NamesOf(const std::vector<SettingSection> &sections) {
    std::string names;
    ForEntries(sections, [&](const SettingInfo &info) { names += fmt::format("{} ", info.name); });
    return names;
}

std::string StageWordList(StageList stages) {
    std::string words;
    for (const Stage &stage : stages)
        words += fmt::format("{} ", stage.word);
    return words;
}

/// Text inside single quotes of a shell.
std::string Quoted(std::string_view text) {
    std::string result;
    for (const char c : WithoutMarkup(text))
        result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result;
}

/// The same inside the brackets of a zsh specification.
std::string ZshText(std::string_view text) {
    std::string result;
    for (const char c : Quoted(text))
        result += c == '[' || c == ']' || c == ':' ? std::string("\\") + c : std::string(1, c);
    return result;
}

/// Branches of the `case` in BashCompletion, which tests the word before the cursor. Each sets what to propose after
/// that option; options with the same values share a branch.
std::string BashValueCases(StageList stages) {
    std::map<std::string, std::string> patterns; // option names joined by |, by the commands of their branch
    std::set<std::string_view> known;
    using Kind = CompletionValues::Kind;
    const auto add = [&](const SettingInfo &info) {
        if (info.MinValues() == 0 && info.name != "-help")
            return;
        const CompletionValues values = ValuesOf(stages, info);
        std::string action = "return";
        if (values.kind == Kind::Words || values.kind == Kind::List)
            action = fmt::format("values=\"{}\"{}", fmt::join(values.words, " "),
                                 values.kind == Kind::List ? " list=1" : "");
        else if (values.kind != Kind::Any)
            action = values.kind == Kind::Files ? "paths=-f" : "paths=-d";
        const auto addName = [&](std::string_view name) {
            if (name.empty() || !known.insert(name).second)
                return;
            std::string &pattern = patterns[action];
            pattern += fmt::format("{}{}", pattern.empty() ? "" : "|", name);
        };
        addName(info.name);
        std::ranges::for_each(info.aliases, addName);
    };
    ForEntries(GlobalSections(), add);
    for (const Stage &stage : stages)
        ForEntries(SectionsOf(stage), add);
    std::string cases;
    for (const auto &[action, pattern] : patterns)
        cases += fmt::format("        {}) {} ;;\n", pattern, action);
    return cases;
}

/// The values of an option in a specification of zsh's _arguments: ":NAME:ACTION" for each value that must follow,
/// "::NAME:ACTION" for one that may. Only the first one has proposals.
std::string ZshValues(StageList stages, const SettingInfo &info) {
    using Kind = CompletionValues::Kind;
    const CompletionValues values = ValuesOf(stages, info);
    std::string action = " ";
    switch (values.kind) {
    case Kind::Words:
        action = fmt::format("({})", fmt::join(values.words, " "));
        break;
    case Kind::List:
        action = fmt::format("_sequence compadd - {}", fmt::join(values.words, " "));
        break;
    case Kind::Files:
        action = "_files";
        break;
    case Kind::Folders:
        action = "_files -/";
        break;
    case Kind::Any:
        break;
    }
    std::string text;
    for (std::size_t at = 0, number = 0; at < info.values.size(); ++number) {
        const std::size_t end = std::min(info.values.find(' ', at), info.values.size());
        const std::string_view name = info.values.substr(at, end - at);
        text += fmt::format("{}{}:{}", number < info.MinValues() ? ":" : "::", ZshText(name), number ? " " : action);
        at = end + 1;
    }
    return text;
}

/// The values of an option as switches of fish's `complete`: -x takes a value that is no file, -r -F takes a file, and
/// -a lists proposals or, in parentheses, the command that prints them.
std::string FishValues(StageList stages, const SettingInfo &info) {
    using Kind = CompletionValues::Kind;
    const CompletionValues values = ValuesOf(stages, info);
    if (info.MinValues() == 0 && values.kind == Kind::Any)
        return "";
    switch (values.kind) {
    case Kind::Words:
        return fmt::format("-x -a '{}' ", fmt::join(values.words, " "));
    case Kind::List:
        // Fish halves backslashes in single quotes and again in double quotes: of these four, printf gets one.
        return fmt::format(R"(-x -a '(__fish_complete_list , "printf %s\\\\n {}")' )", fmt::join(values.words, " "));
    case Kind::Files:
        return "-r -F ";
    case Kind::Folders:
        return "-x -a '(__fish_complete_directories)' ";
    case Kind::Any:
        break;
    }
    return "-x ";
}

} // namespace

/// The script proposes the values of the option before the cursor; else, for a word that begins with -, the options of
/// the stage that the line names, or the stage words and the options of -bsp; else files.
std::string BashCompletion(StageList stages) {
    std::string stageCases; // branches that set the options of a stage
    for (const Stage &stage : stages)
        stageCases += fmt::format("            {}) options=\"{}\" ;;\n", stage.word, NamesOf(SectionsOf(stage)));
    const Stage &unnamedStage = stages.front(); // runs without a stage word
    return fmt::format(R"(# Generated: q3map2 -help bash > tools/generated/completions/q3map2.bash
_q3map2() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}}
    local options="" values="" list="" paths="" before="" word
    COMPREPLY=()
    case $previous in
{}    esac
    if [[ -n $values ]]; then
        [[ -n $list && $current == *,* ]] && before=${{current%,*}},
        mapfile -t COMPREPLY < <(compgen -P "$before" -W "$values" -- "${{current#"$before"}}")
        return
    fi
    for word in "${{COMP_WORDS[@]:1}}"; do
        case $word in
{}        esac
    done
    if [[ -z $paths && $current == -* ]]; then
        [[ -z $options ]] && options="{}{}"
        mapfile -t COMPREPLY < <(compgen -W "$options{}" -- "$current")
    else
        compopt -o filenames 2>/dev/null
        mapfile -t COMPREPLY < <(compgen "${{paths:--f}}" -- "$current")
    fi
}}
complete -F _q3map2 q3map2
)",
                       BashValueCases(stages), stageCases, StageWordList(stages), NamesOf(SectionsOf(unnamedStage)),
                       " " + NamesOf(GlobalSections()));
}

std::string ZshCompletion(StageList stages) {
    const auto specifications = [&](const std::vector<SettingSection> &sections) {
        std::string text;
        ForEntries(sections, [&](const SettingInfo &info) {
            text += fmt::format("        '*{}[{}]{}'\n", info.name, ZshText(info.help), ZshValues(stages, info));
        });
        return text;
    };
    std::string stageWords, stageCases, stageHelp; // joined by |; branches that add options; proposals without a stage
    for (const Stage &stage : stages) {
        stageWords += fmt::format("{}{}", stageWords.empty() ? "" : "|", stage.word);
        stageHelp += fmt::format("        '{}[{}]'\n", stage.word, ZshText(stage.help));
        stageCases += fmt::format("    {})\n        arguments+=(\n{}        ) ;;\n", stage.word,
                                  specifications(SectionsOf(stage)));
    }
    return fmt::format(R"(#compdef q3map2
# Generated: q3map2 -help zsh > tools/generated/completions/_q3map2
local -a arguments
local word stage
arguments=(
{}        '*:file:_files'
)
for word in $words; do
    case $word in
    {}) [[ -z $stage ]] && stage=$word ;;
    esac
done
case $stage in
{}    '')
        arguments+=(
{}        ) ;;
esac
_arguments $arguments
)",
                       specifications(GlobalSections()), stageWords, stageCases, stageHelp);
}

std::string FishCompletion(StageList stages) {
    std::string text = "# Generated: q3map2 -help fish > tools/generated/completions/q3map2.fish\n";
    const auto add = [&](const std::vector<SettingSection> &sections, std::string_view condition) {
        ForEntries(sections, [&](const SettingInfo &info) {
            text += fmt::format("complete -c q3map2{} -o {} {}-d '{}'\n", condition, info.name.substr(1),
                                FishValues(stages, info), Quoted(info.help));
        });
    };
    for (const Stage &stage : stages)
        text += fmt::format("complete -c q3map2 -o {} -d '{}'\n", stage.word.substr(1), Quoted(stage.help));
    add(GlobalSections(), "");
    for (const Stage &stage : stages)
        add(SectionsOf(stage), fmt::format(" -n 'string match -q -- \"* {} *\" (commandline)\" \"'", stage.word));
    return text;
}

} // namespace q3
