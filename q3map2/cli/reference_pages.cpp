// GPL-2.0-or-later. The reference of the manual, which is generated from the declared settings.
#include "q3map2/cli/reference_pages.h"

#include "common/text/text.h"
#include "q3map2/cli/documentation.h"
#include "q3map2/report/version.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

namespace q3 {

// ---- A setting in words ----

namespace {

constexpr std::string_view kOptionRules =
    "Option names are whole words and case-insensitive. Options, the stage and the file may be given in any order. The "
    "program replaces the extension of the file by the one that the stage needs. A value must be a whole word and a "
    "number within the range, or the program stops with an error. Where another value is used instead, with a warning, "
    "the range says so. Numbers without a range may be from -1000000 to 1000000. An unknown option after the stage is "
    "a "
    "warning, which is repeated at the end of the run. An unknown option before the stage is an error, and so are an "
    "unknown option without a stage and a second map. Exit status 0 means that the run succeeded, and 1 that it "
    "failed, "
    "with one line that says why. The last line of a run tells how it ended, how many warnings there were, and how "
    "much "
    "time and memory it took.";

constexpr std::string_view kSinceRules =
    "\"Since\" names the program that introduced an entry; NetRadiant's q3map2 has the entries of q3map2 too.";

bool IsNumber(const SettingEntry &entry) {
    return entry.info.kind == SettingKind::Integer || entry.info.kind == SettingKind::Number;
}

/// The range in words. Limits of one billion or more only keep numbers computable, so they are not named.
std::string RangeInWords(const SettingRange &range) {
    constexpr double kBillion = 1e9;
    if (range.high < kBillion)
        return range.Text();
    if (range.low <= -kBillion)
        return "";
    return range.aboveLow ? fmt::format("over {:.12g}", range.low) : fmt::format("{:.12g} or more", range.low);
}

/// Range and unit, and what becomes of values outside: "from 1 to 8 luxels".
std::string Limits(const SettingEntry &entry, ShownRanges ranges) {
    const SettingInfo &info = entry.info;
    std::string text;
    if (IsNumber(entry) && (ranges == ShownRanges::All || !info.range.IsDefault()))
        text = RangeInWords(info.range);
    const bool shown = !text.empty();
    if (!info.unit.empty())
        text += (text.empty() ? "in " : " ") + std::string(info.unit);
    if (shown && info.outside == OutOfRange::Clamp)
        text += "; values beyond it are clamped";
    if (shown && info.outside == OutOfRange::UseDefault)
        text += fmt::format("; values beyond it become {:g}", info.outsideValue);
    if (shown && info.floor > -kMaxSetting)
        text += fmt::format("; lower values become {:g}", info.floor);
    return text;
}

/// The stages that a directive is for, in words.
std::string_view DirectiveStageText(std::string_view stage) {
    return stage == "both" ? "bsp, light" : stage == "none" ? "" : stage;
}

bool HasDefault(const SettingEntry &entry) {
    return !entry.initial.empty() && !(entry.info.kind == SettingKind::Flag && entry.initial == "off");
}

/// Each name with the values: "-a N", "-b N".
std::vector<std::string> Usages(const SettingInfo &info) {
    const std::string values = info.values.empty() ? "" : fmt::format(" {}", info.values);
    std::vector<std::string> usages{fmt::format("{}{}", info.name, values)};
    for (const std::string_view alias : info.aliases)
        if (!alias.empty())
            usages.push_back(fmt::format("{}{}", alias, values));
    return usages;
}

} // namespace

std::string FullHelp(const SettingEntry &entry, ShownRanges ranges) {
    std::string extra = Limits(entry, ranges);
    const auto addExtra = [&](const std::string &more) { extra += (extra.empty() ? "" : "; ") + more; };
    if (HasDefault(entry))
        addExtra(fmt::format("default: {}", entry.initial));
    if (const std::string_view stage = DirectiveStageText(entry.stage); !stage.empty())
        addExtra(fmt::format("stage: {}", stage));
    return fmt::format("{}{}", entry.info.help, extra.empty() ? "" : fmt::format(" ({})", extra));
}

std::string SinceText(const SettingInfo &info) {
    const bool isVersion = !info.since.empty() && info.since[0] >= '0' && info.since[0] <= '9';
    return fmt::format("{}{}", isVersion ? "q3map2-sh " : "", info.since);
}

std::string WithoutMarkup(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const std::size_t close = text[i] == '[' ? text.find(']', i) : std::string_view::npos;
        const bool beginsLink = close != std::string_view::npos && text.substr(close).starts_with("](");
        if (text[i] == '`' || beginsLink)
            continue;
        if (text.substr(i).starts_with("](")) {
            i = std::min(text.find(')', i), text.size() - 1);
            continue;
        }
        result += text[i];
    }
    return result;
}

// ---- Examples ----

namespace {

std::string WithExample(const SettingInfo &info) {
    return info.example.empty() ? std::string(info.name) : fmt::format("{} {}", info.name, info.example);
}

} // namespace

std::string OptionExample(const Stage *stage, const SettingInfo &info) {
    if (info.name == "-help" || info.name == "-version")
        return fmt::format("q3map2 {}", WithExample(info));
    if (!stage)
        return fmt::format("q3map2 {} -light maps/mymap.bsp", WithExample(info));
    const bool isInFiles = stage->exampleFiles.find(info.name) != std::string_view::npos;
    return fmt::format("q3map2 {} {}{}{}", stage->word, isInFiles ? "" : WithExample(info), isInFiles ? "" : " ",
                       stage->exampleFiles);
}

std::string KeyExample(const SettingInfo &info) {
    std::string name(info.name); // or a pattern of names, such as _styleNrgbgen and _remap*
    if (const std::size_t at = name.find_first_of("*N"); at != std::string::npos)
        name[at] = '1';
    return info.example.empty() ? std::string() : fmt::format("\"{}\" \"{}\"", name, info.example);
}

std::string DirectiveExample(const SettingInfo &info) {
    return WithExample(info);
}

// ---- Pages of docs/reference ----

namespace {

/// Puts each sentence on a line: a new line follows ". " if what comes next can begin a sentence.
std::string SentencePerLine(std::string_view text) {
    std::string lines;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool ends = text[i] == ' ' && i > 0 && i + 1 < text.size() && text[i - 1] == '.';
        const char next = i + 1 < text.size() ? text[i + 1] : ' ';
        const bool begins = std::isupper(static_cast<unsigned char>(next)) || next == '`' || next == '[' || next == '-';
        lines += ends && begins ? '\n' : text[i];
    }
    return lines;
}

/// The text in a cell of a Markdown table.
std::string Cell(std::string_view text) {
    std::string cell;
    for (const char c : text)
        cell += c == '|' ? std::string("\\|") : std::string(1, c);
    return cell;
}

/// An entry with its heading, which is its anchor: names, purpose, details, facts. `example` is shown as code.
std::string Entry(const SettingEntry &entry, std::string_view heading, std::string_view example) {
    const SettingInfo &info = entry.info;
    std::string text = fmt::format("\n{} {}\n\n", heading, info.name);
    if (const std::vector<std::string> usages = Usages(info); usages.size() > 1 || usages.front() != info.name)
        text += fmt::format("`{}`\n\n", fmt::join(usages, "`, `"));
    text += SentencePerLine(info.help) + ".\n";
    if (!info.details.empty())
        text += SentencePerLine(info.details) + "\n";
    text += "\n";
    if (const std::string_view stage = DirectiveStageText(entry.stage); !stage.empty())
        text += fmt::format("- Stage: {}\n", stage);
    if (const std::string limits = Limits(entry, ShownRanges::Declared); !limits.empty())
        text += fmt::format("- {}: {}\n", limits.starts_with("in ") ? "Unit" : "Range",
                            limits.starts_with("in ") ? limits.substr(3) : limits);
    if (HasDefault(entry))
        text += fmt::format("- Default: {}\n", entry.initial);
    text += fmt::format("- Since: {}\n", SinceText(info));
    if (!example.empty())
        text += fmt::format("- Example: `{}`\n", example);
    return text;
}

/// The heading of a section and its introduction.
std::string SectionHead(const SettingSection &section, std::string_view heading) {
    std::string text = fmt::format("\n{} {}\n", heading, section.title);
    if (!section.intro.empty())
        text += fmt::format("\n{}\n", SentencePerLine(section.intro));
    return text;
}

/// The sections of a stage, or the global ones if `stage` is null. `depth`: of the headings of sections.
std::string OptionSections(const Stage *stage, const std::vector<SettingSection> &sections, std::size_t depth) {
    const std::string heading(depth, '#');
    std::string text;
    for (const SettingSection &section : sections) {
        text += SectionHead(section, heading);
        for (const SettingEntry &entry : section.entries)
            text += Entry(entry, heading + "#", OptionExample(stage, entry.info));
    }
    return text;
}

std::string PageHead(std::string_view file, std::string_view title) {
    return fmt::format("<!-- Generated by tools/scripts/generate: q3map2 -help {} -->\n# {}\n", file, title);
}

std::string CommandLinePage(StageList stages) {
    std::string text = PageHead("command_line.md", "Command line and global options");
    text += fmt::format("\n    q3map2 [global options] STAGE [options] FILE\n\n{}\n\n{}\n`q3map2 -help samples` prints "
                        "the entry of one option, and so on for every option, key and directive.\n\n## Stages\n\n"
                        "| stage | what it does |\n|---|---|\n",
                        SentencePerLine(kOptionRules), SentencePerLine(kSinceRules));
    for (const Stage &stage : stages) {
        const bool hasPage = stage.word == "-bsp" || stage.word == "-vis" || stage.word == "-light";
        const std::string page =
            hasPage ? fmt::format("{}.md", stage.word.substr(1)) : fmt::format("other_stages.md#{}", stage.word);
        text += fmt::format("| [{}]({}) | {} |\n", stage.word, page, Cell(stage.help));
    }
    return text + OptionSections(nullptr, GlobalSections(), 2);
}

/// The usage of a stage, what it does, and its options.
std::string StageReference(const Stage &stage, std::size_t depth) {
    std::string text = fmt::format("\n    q3map2 {}\n\n{}.\n", stage.usage, stage.help);
    if (!stage.intro.empty())
        text += SentencePerLine(stage.intro) + "\n";
    return text + OptionSections(&stage, SectionsOf(stage), depth);
}

const Stage &StageOf(StageList stages, std::string_view word) {
    return *std::ranges::find(stages, word, &Stage::word);
}

std::string BspPage(StageList stages) {
    return PageHead("bsp.md", "-bsp: compile a map") + StageReference(StageOf(stages, "-bsp"), 2);
}

std::string VisPage(StageList stages) {
    return PageHead("vis.md", "-vis: compute visibility") + StageReference(StageOf(stages, "-vis"), 2);
}

std::string LightPage(StageList stages) {
    return PageHead("light.md", "-light: light a map") + StageReference(StageOf(stages, "-light"), 2);
}

std::string OtherStagesPage(StageList stages) {
    std::string text = PageHead("other_stages.md", "Other stages");
    text += "\nThese stages convert, pack, edit and show maps.\n[Command line and global options](command_line.md) has "
            "the options that every stage takes.\n";
    for (const Stage &stage : stages)
        if (stage.word != "-bsp" && stage.word != "-vis" && stage.word != "-light")
            text += fmt::format("\n## {}\n", stage.word) + StageReference(stage, 3);
    return text;
}

std::string EntityKeysPage(StageList) {
    std::string text = PageHead("entity_keys.md", "Keys of entities");
    text += fmt::format("\n{}\n{}\n", SentencePerLine(kKeyRules), SentencePerLine(kSinceRules));
    for (const SettingSection &section : EntitySections()) {
        text += SectionHead(section, "##");
        for (const SettingEntry &entry : section.entries)
            text += Entry(entry, "###", KeyExample(entry.info));
    }
    return text;
}

std::string DirectivesPage(StageList) {
    std::string text = PageHead("shader_directives.md", "Directives of shaders");
    text +=
        fmt::format("\n{}\n{}\nThe names that `surfaceparm` takes depend on `-game`.\n[Lighting](../guide/lighting.md) "
                    "shows each kind of light.\n",
                    SentencePerLine(kDirectiveRules), SentencePerLine(kSinceRules));
    for (const SettingSection &section : DirectiveSections()) {
        text += SectionHead(section, "##");
        for (const SettingEntry &entry : section.entries)
            text += Entry(entry, "###", DirectiveExample(entry.info));
    }
    return text;
}

} // namespace

std::vector<ReferencePage> ReferencePages() {
    return {{"command_line.md", CommandLinePage},
            {"bsp.md", BspPage},
            {"vis.md", VisPage},
            {"light.md", LightPage},
            {"other_stages.md", OtherStagesPage},
            {"entity_keys.md", EntityKeysPage},
            {"shader_directives.md", DirectivesPage}};
}

// ---- The man page ----

namespace {

/// The text without Markdown, for the macros of man pages.
std::string Roff(std::string_view text) {
    std::string result;
    for (const char c : WithoutMarkup(text)) {
        if (c == '\\')
            result += "\\e";
        else if (c == '-')
            result += "\\-";
        else
            result += c;
    }
    return result.starts_with('.') || result.starts_with('\'') ? "\\&" + result : result;
}

/// `example`: the example of an entry, or nothing.
template <typename Example> std::string RoffSection(const SettingSection &section, const Example &example) {
    std::string text = fmt::format(".SS {}\n", Roff(section.title));
    if (!section.intro.empty())
        text += Roff(section.intro) + "\n";
    for (const SettingEntry &entry : section.entries) {
        text += fmt::format(".TP\n.B {}\n{}.\n", Roff(fmt::format("{}", fmt::join(Usages(entry.info), ", "))),
                            Roff(FullHelp(entry, ShownRanges::Declared)));
        if (!entry.info.details.empty())
            text += Roff(entry.info.details) + "\n";
        text += fmt::format("Since: {}.\n", Roff(SinceText(entry.info)));
        if (const std::string shown = example(entry.info); !shown.empty())
            text += fmt::format("Example: {}\n", Roff(shown));
    }
    return text;
}

} // namespace

std::string ManualPage(StageList stages) {
    std::string text = fmt::format(".\\\" Generated by tools/scripts/generate: q3map2 \\-help man\n"
                                   ".TH Q3MAP2 1 \"\" \"q3map2\\-sh {}\"\n.SH NAME\nq3map2 \\- compile maps for games "
                                   "of the Quake III family\n.SH SYNOPSIS\n.B q3map2\n[global options] stage "
                                   "[options] file\n.SH DESCRIPTION\n{}\n{}\n.SH STAGES\n",
                                   kVersionNumber, Roff(kOptionRules), Roff(kSinceRules));
    for (const Stage &stage : stages)
        text += fmt::format(".TP\n.B q3map2 {}\n{}.\n", Roff(stage.usage), Roff(stage.help));
    const auto optionsOf = [](const Stage *stage) {
        return [stage](const SettingInfo &info) { return OptionExample(stage, info); };
    };
    text += ".SH GLOBAL OPTIONS\n";
    for (const SettingSection &section : GlobalSections())
        text += RoffSection(section, optionsOf(nullptr));
    for (const Stage &stage : stages) {
        if (!stage.settings && stage.intro.empty())
            continue;
        std::string title(Roff(stage.word));
        std::ranges::transform(title, title.begin(),
                               [](char c) { return c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c; });
        text += fmt::format(".SH {}\n", title);
        if (!stage.intro.empty())
            text += Roff(stage.intro) + "\n";
        for (const SettingSection &section : SectionsOf(stage))
            text += RoffSection(section, optionsOf(&stage));
    }
    text += fmt::format(".SH KEYS OF ENTITIES\n{}\n", Roff(kKeyRules));
    for (const SettingSection &section : EntitySections())
        text += RoffSection(section, KeyExample);
    text += fmt::format(".SH DIRECTIVES OF SHADERS\n{}\n", Roff(kDirectiveRules));
    for (const SettingSection &section : DirectiveSections())
        text += RoffSection(section, DirectiveExample);
    return text + ".SH EXIT STATUS\n0: the run succeeded. 1: it failed. 255: \\-info without files.\n";
}

} // namespace q3
