// GPL-2.0-or-later. q3map2 -help.
#include "q3map2/cli/help.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/cli/completion.h"
#include "q3map2/cli/documentation.h"
#include "q3map2/cli/presets.h"
#include "q3map2/cli/reference_pages.h"
#include "q3map2/report/version.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace q3 {

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
