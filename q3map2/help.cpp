// GPL-2.0-or-later. q3map2 -help.
#include "q3map2/help.h"

#include "common/error.h"
#include "common/nearest_names.h"
#include "common/text/text.h"
#include "q3map2/completions.h"
#include "q3map2/directive_sections.h"
#include "q3map2/documentation.h"
#include "q3map2/entity_sections.h"
#include "q3map2/stages.h"
#include "q3map2/version.h"
#include "q3map2/vrad_options.h"

#include <algorithm>
#include <map>

namespace q3 {

namespace {

constexpr std::size_t kNameColumn = 26, kLineWidth = 100;

/// Wraps words at the line width; every line but the first is indented.
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
std::string EntryLine(const SettingEntry &entry, bool complete = false) {
    std::string name = "  " + std::string(entry.info.name);
    for (const std::string_view alias : entry.info.aliases)
        if (!alias.empty())
            name += fmt::format(", {}", alias);
    if (!entry.info.values.empty())
        name += fmt::format(" {}", entry.info.values);
    std::string line = name.size() < kNameColumn ? name + std::string(kNameColumn - name.size(), ' ')
                                                 : name + "\n" + std::string(kNameColumn, ' ');
    return line + Wrapped(WithoutMarkup(FullHelp(entry, complete)), kNameColumn, kNameColumn) + "\n";
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
    if (stage.settings)
        for (const SettingSection &section : stage.settings())
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
    std::string text;
    for (const SettingSection &section : EntitySections())
        text += SectionText(section);
    return text;
}

std::string Overview() {
    std::string text = fmt::format("{}\nq3map2 [global options] STAGE [options] FILE\n\nStages\n", kVersion);
    for (const Stage &stage : Stages())
        text += fmt::format("  {}\n      {}\n", stage.usage, stage.help);
    text += "\nq3map2 -help STAGE lists the options of a stage, such as -help light; -help OPTION explains one.\n"
            "-help keys lists the keys of entities, -help shader the directives of shaders; -help all prints all.\n";
    return text + GlobalText();
}

std::string AllText() {
    std::string text = Overview();
    for (const Stage &stage : Stages())
        text += fmt::format("\n{:-<80}\n{}", "", StageText(stage));
    for (const std::string &more : {VradText(), KeysText(), DirectivesText()})
        text += fmt::format("\n{:-<80}\n{}", "", more);
    return text;
}

/// Adds what these sections have under that name, with or without its dash.
void AddEntries(std::string_view owner, const std::vector<SettingSection> &sections, std::string_view topic,
                std::string &text) {
    for (const SettingSection &section : sections)
        for (const SettingEntry &entry : section.entries)
            if (entry.info.Names(topic) || entry.info.Names(fmt::format("-{}", topic))) {
                text += fmt::format("{}, {}\n{}", owner, section.title, EntryLine(entry, entry.stage.empty()));
                if (!entry.info.details.empty())
                    text += fmt::format("{:{}}{}\n", "", kNameColumn,
                                        Wrapped(WithoutMarkup(entry.info.details), kNameColumn, kNameColumn));
            }
}

/// Options of that name, wherever they occur.
std::string OptionHelp(std::string_view topic) {
    std::string text;
    AddEntries("every stage", GlobalSections(), topic, text);
    for (const Stage &stage : Stages())
        if (stage.settings)
            AddEntries(stage.word, stage.settings(), topic, text);
    return text;
}

/// Keys of entities and directives of shaders of that name.
std::string MapWordHelp(std::string_view topic) {
    std::string text;
    AddEntries("entities", EntitySections(), topic, text);
    AddEntries("shaders", DirectiveSections(), topic, text);
    return text;
}

/// Full title of a game, for -help game; empty: unknown.
std::string_view TitleOf(std::string_view game) {
    constexpr std::pair<std::string_view, std::string_view> kTitles[] = {
        {"quake3", "Quake III Arena, Team Arena; OpenArena, Urban Terror and others"},
        {"quakelive", "Quake Live"},
        {"nexuiz", "Nexuiz"},
        {"xonotic", "Xonotic"},
        {"tremulous", "Tremulous"},
        {"unvanquished", "Unvanquished"},
        {"tenebrae", "Tenebrae"},
        {"wolf", "Return to Castle Wolfenstein"},
        {"et", "Wolfenstein: Enemy Territory"},
        {"etut", "Urban Terror on Enemy Territory's engine"},
        {"ef", "Star Trek: Voyager - Elite Force"},
        {"reaction", "Reaction"},
        {"darkplaces", "DarkPlaces, for Quake"},
        {"dq", "DeluxeQuake"},
        {"prophecy", "Prophecy"}};
    const auto found = std::ranges::find(kTitles, game, [](const auto &title) { return title.first; });
    return found == std::end(kTitles) ? "" : found->second;
}

std::string GamesText() {
    std::string text;
    for (const Game &game : Games())
        text += fmt::format("  {:<14}{:<11}{}\n", game.name, game.gameDir, TitleOf(game.name));
    return "  -game         folder     title\n" + text +
           "\nA mod is not a game: -game names the game that it runs on, -fs_game its folder. A game whose base\n"
           "folder has another name, such as OpenArena's baseoa, needs -fs_basegame: -game quake3 -fs_basegame "
           "baseoa.\n";
}

[[noreturn]] void FailUnknown(std::string_view topic, const std::vector<std::string> &topics) {
    std::vector<std::string> names = topics;
    for (const Stage &stage : Stages()) {
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

std::string HelpText(std::string_view topic) {
    std::string_view bare = topic;
    while (bare.starts_with('-'))
        bare.remove_prefix(1);
    if (bare.empty())
        return Overview();
    const std::map<std::string, std::string (*)()> pages = {
        {"common", GlobalText},     {"keys", KeysText},         {"game", GamesText},
        {"all", AllText},           {"markdown", MarkdownPage}, {"man", ManualPage},
        {"bash", BashCompletion},   {"zsh", ZshCompletion},     {"fish", FishCompletion},
        {"shader", DirectivesText}, {"vrad", VradText},         {"shadermarkdown", DirectivesPage}};
    if (const auto page = pages.find(LowerCase(bare)); page != pages.end())
        return page->second();
    std::string text;
    for (const Stage &stage : Stages())
        if (EqualNoCase(stage.word.substr(1), bare))
            text += StageText(stage);
    const std::string options = OptionHelp(bare), words = MapWordHelp(bare);
    if (text.empty())
        text = options + words;
    else if (!options.empty()) // the word is an option of other stages too
        text += "\n" + options;
    if (text.empty()) {
        std::vector<std::string> topics;
        for (const auto &[name, page] : pages)
            topics.push_back(name);
        FailUnknown(topic, topics);
    }
    return text;
}

} // namespace q3
