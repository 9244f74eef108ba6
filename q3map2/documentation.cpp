// GPL-2.0-or-later. Files that are generated from the declared settings.
#include "q3map2/documentation.h"

#include "common/text/text.h"
#include "q3map2/directive_sections.h"
#include "q3map2/entity_sections.h"
#include "q3map2/stages.h"
#include "q3map2/version.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::string_view kRules =
    "Option names are whole words, case-insensitive. Their order does not matter; options, the stage word and the file "
    "may stand anywhere on the line. The extension of the file is replaced by the one that the stage needs. A value "
    "must be a whole word and a number of the range given, or the program stops with an error; where another value is "
    "used instead, with a warning, the range says so. Numbers without a range may be from -1000000 to 1000000. An "
    "unknown option after the stage word is a warning, which the end of the run repeats; before it, or when no stage "
    "is named, it is an error, and so is a second map. Exit status 0: done; 1: failed, with one line that says why. "
    "The last line of a run says how it ended, what it warned of, and what time and memory it took.";

bool HasRange(const SettingEntry &entry) {
    return entry.info.kind == SettingKind::Integer || entry.info.kind == SettingKind::Number;
}

/// Range and unit, and what becomes of values outside: "from 1 to 8 luxels". The default range is shown only if
/// `complete`.
std::string Limits(const SettingEntry &entry, bool complete) {
    const SettingInfo &info = entry.info;
    const bool shown = HasRange(entry) && (complete || !info.range.IsDefault());
    std::string text = shown ? info.range.Text() : "";
    if (!info.unit.empty())
        text += (text.empty() ? "in " : " ") + std::string(info.unit);
    if (shown && info.outside == OutOfRange::Clamp)
        text += "; beyond it the nearest is used";
    if (shown && info.outside == OutOfRange::UseDefault)
        text += fmt::format("; beyond it {:g} is used", info.outsideValue);
    if (shown && info.floor > -kMaxSetting)
        text += fmt::format("; at least {:g} is used", info.floor);
    return text;
}

/// The stages that a directive is for, in words.
std::string_view StageText(std::string_view stage) {
    return stage == "both" ? "bsp, light" : stage == "none" ? "" : stage;
}

/// A cell of a table.
std::string Cell(std::string_view text) {
    std::string cell;
    for (const char c : text)
        cell += c == '|' ? std::string("\\|") : std::string(1, c);
    return cell;
}

std::string NamesCell(const SettingInfo &info) {
    const std::string values = info.values.empty() ? "" : " " + Cell(info.values);
    std::string names = fmt::format("`{}{}`", info.name, values);
    for (const std::string_view alias : info.aliases)
        if (!alias.empty())
            names += fmt::format(", `{}{}`", alias, values);
    return names;
}

/// Help, limits and details as sentences.
std::string EffectText(const SettingEntry &entry) {
    std::string effect(entry.info.help);
    if (const std::string limits = Limits(entry, false); !limits.empty())
        effect += fmt::format(" ({})", limits);
    effect += ".";
    if (!entry.info.details.empty())
        effect += fmt::format(" {}", entry.info.details);
    return effect;
}

std::string MarkdownTable(const SettingSection &section, std::string_view heading, std::string_view column) {
    std::string text = fmt::format("\n{} {}\n\n", heading, section.title);
    if (!section.intro.empty())
        text += fmt::format("{}\n\n", section.intro);
    text += fmt::format("| {} | default | effect |\n|---|---|---|\n", column);
    for (const SettingEntry &entry : section.entries)
        text += fmt::format("| {} | {} | {} |\n", NamesCell(entry.info), Cell(entry.initial), Cell(EffectText(entry)));
    return text;
}

/// The same with the stage of each entry.
std::string DirectiveTable(const SettingSection &section) {
    std::string text = fmt::format("\n## {}\n\n", section.title);
    if (!section.intro.empty())
        text += fmt::format("{}\n\n", section.intro);
    text += "| directive | stage | default | effect |\n|---|---|---|---|\n";
    for (const SettingEntry &entry : section.entries)
        text += fmt::format("| {} | {} | {} | {} |\n", NamesCell(entry.info), StageText(entry.stage),
                            Cell(entry.initial), Cell(EffectText(entry)));
    return text;
}

std::string Roff(std::string_view text) {
    std::string result;
    for (const char c : WithoutMarkup(text)) {
        if (c == '\\' || c == '-')
            result += '\\';
        result += c;
    }
    return result.starts_with('.') || result.starts_with('\'') ? "\\&" + result : result;
}

std::string RoffSection(const SettingSection &section) {
    std::string text = fmt::format(".SS {}\n", Roff(section.title));
    if (!section.intro.empty())
        text += Roff(section.intro) + "\n";
    for (const SettingEntry &entry : section.entries) {
        text += fmt::format(".TP\n.B {}", Roff(entry.info.name));
        if (!entry.info.values.empty())
            text += fmt::format(" {}", Roff(entry.info.values));
        text += fmt::format("\n{}\n", Roff(FullHelp(entry, false)));
        if (!entry.info.details.empty())
            text += Roff(entry.info.details) + "\n";
    }
    return text;
}

} // namespace

std::vector<SettingSection> SectionsOf(const Stage &stage) {
    return stage.settings ? stage.settings() : std::vector<SettingSection>();
}

std::string FullHelp(const SettingEntry &entry, bool complete) {
    std::string extra = Limits(entry, complete);
    const auto add = [&](const std::string &more) { extra += (extra.empty() ? "" : "; ") + more; };
    if (!entry.initial.empty() && !(entry.info.kind == SettingKind::Flag && entry.initial == "off"))
        add(fmt::format("default: {}", entry.initial));
    if (const std::string_view stage = StageText(entry.stage); !stage.empty())
        add(fmt::format("stage: {}", stage));
    return fmt::format("{}{}", entry.info.help, extra.empty() ? "" : fmt::format(" ({})", extra));
}

std::string WithoutMarkup(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '`' || (text[i] == '[' && text.find("](", i) != std::string_view::npos))
            continue;
        if (text.substr(i).starts_with("](")) {
            i = std::min(text.find(')', i), text.size() - 1);
            continue;
        }
        result += text[i];
    }
    return result;
}

std::string MarkdownPage() {
    std::string text = fmt::format("<!-- Generated: q3map2 -help markdown > docs/options.md -->\n# Options\n\n"
                                   "    q3map2 [global options] STAGE [options] FILE\n\n{}\n\n"
                                   "| stage | does |\n|---|---|\n",
                                   kRules);
    for (const Stage &stage : Stages())
        text += fmt::format("| `{}` | {} |\n", Cell(stage.usage), Cell(stage.help));
    text += "\n## Global options\n";
    for (const SettingSection &section : GlobalSections())
        text += MarkdownTable(section, "###", "option");
    for (const Stage &stage : Stages()) {
        if (!stage.settings && stage.intro.empty())
            continue;
        text +=
            fmt::format("\n## {}\n\n{}.{}{}\n", stage.word, stage.help, stage.intro.empty() ? "" : " ", stage.intro);
        for (const SettingSection &section : SectionsOf(stage))
            text += MarkdownTable(section, "###", "option");
    }
    text += fmt::format("\n## Keys of entities\n\n{}\n", kKeyRules);
    for (const SettingSection &section : EntitySections())
        text += MarkdownTable(section, "###", "key");
    return text;
}

std::string DirectivesPage() {
    std::string text = fmt::format("<!-- Generated: q3map2 -help shadermarkdown > docs/shader_directives.md -->\n"
                                   "# Directives of shaders\n\n{}\n\nWhich names `surfaceparm` takes depends on "
                                   "`-game`. [lights.md](lights.md) shows kinds of light, "
                                   "[lightmaps.md](lightmaps.md) how lightmaps are made. `q3map2 -help "
                                   "q3map_surfaceLight` prints one of these entries, `q3map2 -help shader` all.\n",
                                   kDirectiveRules);
    for (const SettingSection &section : DirectiveSections())
        text += DirectiveTable(section);
    return text;
}

std::string ManualPage() {
    std::string text = fmt::format(".\\\" Generated: q3map2 \\-help man > docs/q3map2.1\n"
                                   ".TH Q3MAP2 1 \"\" \"q3map2\\-sh {}\"\n.SH NAME\nq3map2 \\- compile maps for games "
                                   "of the Quake III family\n.SH SYNOPSIS\n.B q3map2\n[global options] stage "
                                   "[options] file\n.SH DESCRIPTION\n{}\n.SH STAGES\n",
                                   kVersionNumber, Roff(kRules));
    for (const Stage &stage : Stages())
        text += fmt::format(".TP\n.B q3map2 {}\n{}.\n", Roff(stage.usage), Roff(stage.help));
    text += ".SH GLOBAL OPTIONS\n";
    for (const SettingSection &section : GlobalSections())
        text += RoffSection(section);
    for (const Stage &stage : Stages()) {
        if (!stage.settings && stage.intro.empty())
            continue;
        std::string title(Roff(stage.word));
        std::ranges::transform(title, title.begin(), [](char c) { return c >= 'a' && c <= 'z' ? char(c - 32) : c; });
        text += fmt::format(".SH {}\n", title);
        if (!stage.intro.empty())
            text += Roff(stage.intro) + "\n";
        for (const SettingSection &section : SectionsOf(stage))
            text += RoffSection(section);
    }
    text += fmt::format(".SH KEYS OF ENTITIES\n{}\n", Roff(kKeyRules));
    for (const SettingSection &section : EntitySections())
        text += RoffSection(section);
    text += fmt::format(".SH DIRECTIVES OF SHADERS\n{}\n", Roff(kDirectiveRules));
    for (const SettingSection &section : DirectiveSections())
        text += RoffSection(section);
    return text + ".SH EXIT STATUS\n0: done. 1: failed. 255: \\-info without files.\n";
}

} // namespace q3
