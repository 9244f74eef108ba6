// GPL-2.0-or-later. q3map2 -help, and completion of the command line in shells.
#include "q3map2/cli/help.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/cli/documentation.h"
#include "q3map2/cli/presets.h"
#include "q3map2/cli/reference_pages.h"
#include "q3map2/report/version.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

namespace q3 {

// ---- Completion of the command line in shells ----

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

// ---- q3map2 -help ----

namespace {

/// Columns of -help: where the text after names begins, and where lines end.
constexpr std::size_t kNameColumn = 26, kLineWidth = 100;

/// Wraps words at the line width. The first line begins at `column`, the others at `indent`.
std::string Wrapped(std::string_view text, std::size_t indent, std::size_t column) {
    std::string result;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find(' ', at), text.size());
        if (column + (end - at) > kLineWidth && column > indent) {
            if (result.ends_with(' '))
                result.pop_back();
            result += "\n" + std::string(indent, ' ');
            column = indent;
        }
        result += text.substr(at, end - at + 1);
        column += end - at + 1;
        at = end + 1;
    }
    return result;
}

/// "  -name VALUES          help (default, range)".
std::string EntryLine(const SettingEntry &entry, ShownRanges ranges = ShownRanges::Declared) {
    std::string name = "  " + std::string(entry.info.name);
    for (const std::string_view alias : entry.info.aliases)
        if (!alias.empty())
            name += fmt::format(", {}", alias);
    if (!entry.info.values.empty())
        name += fmt::format(" {}", entry.info.values);
    std::string line = name.size() < kNameColumn ? name + std::string(kNameColumn - name.size(), ' ')
                                                 : name + "\n" + std::string(kNameColumn, ' ');
    return line + Wrapped(WithoutMarkup(FullHelp(entry, ranges)), kNameColumn, kNameColumn) + "\n";
}

std::string SectionText(const SettingSection &section) {
    std::string text = fmt::format("\n{}\n", section.title);
    if (!section.intro.empty())
        text += Wrapped(WithoutMarkup(section.intro), 0, 0) + "\n";
    for (const SettingEntry &entry : section.entries)
        text += EntryLine(entry);
    return text;
}

std::string StageText(const Stage &stage) {
    std::string text = fmt::format("q3map2 {}\n{}.\n", stage.usage, stage.help);
    if (!stage.intro.empty())
        text += Wrapped(WithoutMarkup(stage.intro), 0, 0) + "\n";
    for (const SettingSection &section : SectionsOf(stage))
        text += section.topic.empty()
                    ? SectionText(section)
                    : fmt::format("\n{}: q3map2 -help {} lists them.\n", section.title, section.topic);
    return text;
}

std::string GlobalText() {
    std::string text;
    for (const SettingSection &section : GlobalSections())
        text += SectionText(section);
    return text;
}

std::string VradText() {
    return SectionText(VradSection());
}

std::string DirectivesText() {
    std::string text = Wrapped(WithoutMarkup(kDirectiveRules), 0, 0) + "\n";
    for (const SettingSection &section : DirectiveSections())
        text += SectionText(section);
    return text;
}

std::string KeysText() {
    std::string text = Wrapped(kKeyRules, 0, 0) + "\n";
    for (const SettingSection &section : EntitySections())
        text += SectionText(section);
    return text;
}

std::string Overview(StageList stages) {
    std::string text = fmt::format("{}\nq3map2 [global options] STAGE [options] FILE\n\nStages\n", kVersion);
    for (const Stage &stage : stages)
        text += fmt::format("  {}\n      {}\n", stage.usage, stage.help);
    text += "\nq3map2 -help light lists the options of the stage -light, and so on for each stage.\n"
            "q3map2 -help samples explains the option -samples; options, keys and directives have such an entry.\n"
            "q3map2 -help keys lists the keys of entities, q3map2 -help shader the directives of shaders.\n"
            "q3map2 -help all prints all lists.\n";
    return text + GlobalText();
}

std::string GamesText() {
    std::string text;
    for (const Game &game : Games())
        text += fmt::format("  {:<14}{:<11}{}\n", game.name, game.gameDir, game.title);
    return "  -game         folder     title\n" + text +
           "\nA mod is not a game: -game names the game that it runs on, -fs_game its folder. A game whose base\n"
           "folder has another name, such as OpenArena's baseoa, needs -fs_basegame: -game quake3 -fs_basegame "
           "baseoa.\n";
}

std::string AllText(StageList stages) {
    std::string text = Overview(stages);
    for (const Stage &stage : stages)
        text += fmt::format("\n{:-<80}\n{}", "", StageText(stage));
    for (const std::string &more : {GamesText(), VradText(), KeysText(), DirectivesText()})
        text += fmt::format("\n{:-<80}\n{}", "", more);
    return text;
}

/// Adds the help of each setting of that name or alias, with or without its dash. `owner`: what has the settings, such
/// as the word of a stage. `example(info)`: the example of a setting, or nothing.
template <typename Example>
void AddEntries(std::string_view owner, const std::vector<SettingSection> &sections, const Example &example,
                std::string_view topic, std::string &text) {
    for (const SettingSection &section : sections)
        for (const SettingEntry &entry : section.entries)
            if (entry.info.Names(topic) || entry.info.Names(fmt::format("-{}", topic))) {
                // Directives have no common default range.
                const ShownRanges ranges = entry.stage.empty() ? ShownRanges::All : ShownRanges::Declared;
                text += fmt::format("{}, {}\n{}", owner, section.title, EntryLine(entry, ranges));
                const auto addLine = [&](std::string_view line) {
                    text += fmt::format("{:{}}{}\n", "", kNameColumn, Wrapped(line, kNameColumn, kNameColumn));
                };
                if (!entry.info.details.empty())
                    addLine(WithoutMarkup(entry.info.details));
                addLine(fmt::format("Since: {}", SinceText(entry.info)));
                if (const std::string shown = example(entry.info); !shown.empty())
                    addLine(fmt::format("Example: {}", shown));
            }
}

/// Options of that name, wherever they occur.
std::string OptionHelp(StageList stages, std::string_view topic) {
    std::string text;
    const auto exampleOf = [](const Stage *stage) {
        return [stage](const SettingInfo &info) { return OptionExample(stage, info); };
    };
    AddEntries("every stage", GlobalSections(), exampleOf(nullptr), topic, text);
    for (const Stage &stage : stages)
        AddEntries(stage.word, SectionsOf(stage), exampleOf(&stage), topic, text);
    return text;
}

/// Keys of entities and directives of shaders of that name.
std::string MapWordHelp(std::string_view topic) {
    std::string text;
    AddEntries("entities", EntitySections(), KeyExample, topic, text);
    AddEntries("shaders", DirectiveSections(), DirectiveExample, topic, text);
    return text;
}

/// For the word of a stage: where its meanings as a key or a directive are explained. Empty: it has none.
std::string MapWordHint(std::string_view topic) {
    std::vector<std::string> meanings;
    const auto look = [&](const std::vector<SettingSection> &sections, std::string_view meaning) {
        bool isNamed = false;
        ForEntries(sections, [&](const SettingInfo &info) { isNamed |= info.Names(topic); });
        if (isNamed)
            meanings.emplace_back(meaning);
    };
    look(EntitySections(), "a key of entities (q3map2 -help keys)");
    look(DirectiveSections(), "a directive of shaders (q3map2 -help shader)");
    return meanings.empty() ? "" : fmt::format("\n{} is also {}.\n", topic, fmt::join(meanings, " and "));
}

[[noreturn]] void FailUnknown(StageList stages, std::string_view topic, const std::vector<std::string> &topics) {
    std::vector<std::string> names = topics;
    for (const Stage &stage : stages) {
        names.emplace_back(stage.word);
        for (std::string &name : stage.OptionNames())
            names.push_back(std::move(name));
    }
    for (const auto &sections : {EntitySections(), DirectiveSections()})
        for (const SettingSection &section : sections)
            for (const SettingEntry &entry : section.entries)
                names.emplace_back(entry.info.name);
    throw Error("-help {}: no such stage, option, key or directive{}", topic, DidYouMean(topic, names));
}

} // namespace

std::string ManualLine(const std::filesystem::path &program) {
    for (const char *const place : {"manual/index.html", "../share/doc/q3map2-sh/manual/index.html"}) {
        const std::filesystem::path page = (program.parent_path() / place).lexically_normal();
        std::error_code error;
        if (std::filesystem::exists(page, error))
            return fmt::format("The manual is {}\n", page.string());
    }
    return "The manual is docs/README.md of the sources; packages have it as manual/index.html.\n";
}

std::string HelpText(StageList stages, std::string_view topic) {
    std::string_view bare = topic;
    while (bare.starts_with('-'))
        bare.remove_prefix(1);
    if (bare.empty())
        return Overview(stages);
    std::map<std::string, std::string (*)(StageList)> pages = {{"common", [](StageList) { return GlobalText(); }},
                                                               {"keys", [](StageList) { return KeysText(); }},
                                                               {"game", [](StageList) { return GamesText(); }},
                                                               {"shader", [](StageList) { return DirectivesText(); }},
                                                               {"vrad", [](StageList) { return VradText(); }},
                                                               {"all", AllText},
                                                               {"man", ManualPage},
                                                               {"bash", BashCompletion},
                                                               {"zsh", ZshCompletion},
                                                               {"fish", FishCompletion}};
    for (const ReferencePage &page : ReferencePages())
        pages.emplace(page.file, page.text);
    if (const auto page = pages.find(LowerCase(bare)); page != pages.end())
        return page->second(stages);
    std::string text;
    for (const Stage &stage : stages)
        if (EqualNoCase(stage.word.substr(1), bare))
            text += StageText(stage);
    const std::string options = OptionHelp(stages, bare);
    if (text.empty())
        text = options + MapWordHelp(bare);
    else // the word of a stage may be an option of other stages, a key or a directive too
        text += (options.empty() ? "" : "\n" + options) + MapWordHint(bare);
    if (text.empty()) {
        std::vector<std::string> topics;
        for (const auto &[name, page] : pages)
            topics.push_back(name);
        FailUnknown(stages, topic, topics);
    }
    return text;
}

} // namespace q3
