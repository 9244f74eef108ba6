// GPL-2.0-or-later. Completion of the command line in shells: options, and the values that can follow them.
#include "q3map2/completions.h"

#include "q3map2/documentation.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/stages.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>

namespace q3 {

namespace {

/// What can follow an option.
struct Values {
    enum class Kind { Any, Words, List, Files, Folders };
    Kind kind = Kind::Any; ///< Any: a number or a name that nothing lists. List: words separated by commas
    std::vector<std::string> words{};
};

std::vector<std::string> GameNames() {
    std::vector<std::string> names;
    for (const Game &game : Games())
        names.emplace_back(game.name);
    return names;
}

std::vector<std::string> GridFormatNames() {
    std::vector<std::string> names;
    for (const GridFormat &format : AllGridFormats())
        names.emplace_back(format.word);
    return names;
}

std::vector<std::string> ParmNames() {
    std::vector<std::string> names;
    for (const SurfaceParm &parm : Games().front().surfaceParms)
        if (!parm.name.starts_with('*') && parm.name != "default")
            names.emplace_back(parm.name);
    return names;
}

std::vector<std::string> HelpTopics() {
    std::vector<std::string> topics{"all", "game", "keys", "shader", "vrad"};
    for (const Stage &stage : Stages())
        topics.emplace_back(stage.word.substr(1));
    return topics;
}

/// Words of a value such as "draft|normal|final" or "N|inf", without those that stand for something.
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

Values ValuesOf(const SettingInfo &info) {
    using enum Values::Kind;
    static constexpr struct {
        std::string_view option;
        Values::Kind kind;
        std::vector<std::string> (*words)();
    } kNamed[] = {{"-game", Words, GameNames},
                  {"-gridformats", List, GridFormatNames},
                  {"-format", Words, ConvertFormatNames},
                  {"-globalflag", Words, ParmNames},
                  {"-help", Words, HelpTopics}};
    for (const auto &named : kNamed)
        if (named.option == info.name)
            return {named.kind, named.words()};
    const std::string_view first = info.values.substr(0, info.values.find(' '));
    if (first.find('|') != std::string_view::npos)
        return {Words, ChoiceWords(first)};
    if (first == "DIR")
        return {Folders};
    if (first.starts_with("FILE") || first == "IMAGE")
        return {Files};
    return {};
}

/// Calls use(info) for every setting of the sections.
template <typename Use> void ForEntries(const std::vector<SettingSection> &sections, const Use &use) {
    for (const SettingSection &section : sections)
        for (const SettingEntry &entry : section.entries)
            use(entry.info);
}

/// The names of options as one string, each followed by a blank.
std::string NamesOf(const std::vector<SettingSection> &sections) {
    std::string names;
    ForEntries(sections, [&](const SettingInfo &info) { names += fmt::format("{} ", info.name); });
    return names;
}

std::string StageWordList() {
    std::string words;
    for (const Stage &stage : Stages())
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

/// Branches of `case` by the word before the cursor: options with the same values share one.
std::string BashValueCases() {
    std::map<std::string, std::string> patterns; // by action
    std::map<std::string, bool> known;
    const auto add = [&](const SettingInfo &info) {
        if (info.MinValues() == 0 && info.name != "-help")
            return;
        const Values values = ValuesOf(info);
        std::string action = "return";
        if (values.kind == Values::Kind::Words || values.kind == Values::Kind::List)
            action = fmt::format("values=\"{}\"{}", fmt::join(values.words, " "),
                                 values.kind == Values::Kind::List ? " list=1" : "");
        else if (values.kind != Values::Kind::Any)
            action = values.kind == Values::Kind::Files ? "paths=-f" : "paths=-d";
        for (const std::string_view name : {info.name, info.aliases[0], info.aliases[1]})
            if (!name.empty() && known.emplace(name, true).second) {
                std::string &pattern = patterns[action];
                pattern += fmt::format("{}{}", pattern.empty() ? "" : "|", name);
            }
    };
    ForEntries(GlobalSections(), add);
    for (const Stage &stage : Stages())
        ForEntries(SectionsOf(stage), add);
    std::string cases;
    for (const auto &[action, pattern] : patterns)
        cases += fmt::format("        {}) {} ;;\n", pattern, action);
    return cases;
}

/// The values of an option in a specification of zsh.
std::string ZshValues(const SettingInfo &info) {
    const Values values = ValuesOf(info);
    std::string action = " ";
    switch (values.kind) {
    case Values::Kind::Words:
        action = fmt::format("({})", fmt::join(values.words, " "));
        break;
    case Values::Kind::List:
        action = fmt::format("_sequence compadd - {}", fmt::join(values.words, " "));
        break;
    case Values::Kind::Files:
        action = "_files";
        break;
    case Values::Kind::Folders:
        action = "_files -/";
        break;
    case Values::Kind::Any:
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

std::string FishValues(const SettingInfo &info) {
    const Values values = ValuesOf(info);
    if (info.MinValues() == 0 && values.kind == Values::Kind::Any)
        return "";
    switch (values.kind) {
    case Values::Kind::Words:
        return fmt::format("-x -a '{}' ", fmt::join(values.words, " "));
    case Values::Kind::List:
        return fmt::format("-x -a '(__fish_complete_list , \"printf %s\\\\\\\\n {}\")' ", fmt::join(values.words, " "));
    case Values::Kind::Files:
        return "-r -F ";
    case Values::Kind::Folders:
        return "-x -a '(__fish_complete_directories)' ";
    case Values::Kind::Any:
        break;
    }
    return "-x ";
}

} // namespace

std::string BashCompletion() {
    std::string cases;
    for (const Stage &stage : Stages())
        cases += fmt::format("            {}) options=\"{}\" ;;\n", stage.word, NamesOf(SectionsOf(stage)));
    return fmt::format(R"(# Generated: q3map2 -help bash > tools/completions/q3map2.bash
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
                       BashValueCases(), cases, StageWordList(), NamesOf(SectionsOf(Stages().front())),
                       " " + NamesOf(GlobalSections()));
}

std::string ZshCompletion() {
    const auto specifications = [](const std::vector<SettingSection> &sections) {
        std::string text;
        ForEntries(sections, [&](const SettingInfo &info) {
            text += fmt::format("        '*{}[{}]{}'\n", info.name, ZshText(info.help), ZshValues(info));
        });
        return text;
    };
    std::string stages, cases, words;
    for (const Stage &stage : Stages()) {
        words += fmt::format("{}{}", words.empty() ? "" : "|", stage.word);
        stages += fmt::format("        '{}[{}]'\n", stage.word, ZshText(stage.help));
        cases += fmt::format("    {})\n        arguments+=(\n{}        ) ;;\n", stage.word,
                             specifications(SectionsOf(stage)));
    }
    return fmt::format(R"(#compdef q3map2
# Generated: q3map2 -help zsh > tools/completions/_q3map2
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
                       specifications(GlobalSections()), words, cases, stages);
}

std::string FishCompletion() {
    std::string text = "# Generated: q3map2 -help fish > tools/completions/q3map2.fish\n";
    const auto add = [&](const std::vector<SettingSection> &sections, std::string_view condition) {
        ForEntries(sections, [&](const SettingInfo &info) {
            text += fmt::format("complete -c q3map2{} -o {} {}-d '{}'\n", condition, info.name.substr(1),
                                FishValues(info), Quoted(info.help));
        });
    };
    for (const Stage &stage : Stages())
        text += fmt::format("complete -c q3map2 -o {} -d '{}'\n", stage.word.substr(1), Quoted(stage.help));
    add(GlobalSections(), "");
    for (const Stage &stage : Stages())
        add(SectionsOf(stage), fmt::format(" -n 'string match -q -- \"* {} *\" (commandline)\" \"'", stage.word));
    return text;
}

} // namespace q3
