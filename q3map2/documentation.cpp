// GPL-2.0-or-later. Files that are generated from the declared settings.
#include "q3map2/documentation.h"

#include "common/text/text.h"
#include "q3map2/entity_sections.h"
#include "q3map2/stages.h"
#include "q3map2/version.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::string_view kRules =
    "Option names are whole words, case-insensitive. Their order does not matter; options, the stage word and the file "
    "may "
    "stand anywhere on the line. The extension of the file is replaced by the one that the stage needs. A number must "
    "be a whole word, finite and in range, or the program stops. An unknown option after the stage word is a warning, "
    "which the end of the run repeats; before it, or when no stage is named, it is an error. Exit status 0: done; 1: "
    "failed, with one line that says why. The last line of a run says how it ended, what it warned of, and what time "
    "and memory it took.";

bool HasRange(const SettingEntry &entry) {
    return entry.info.kind != SettingKind::Text && !entry.info.range.Text().empty();
}

/// Range and unit: "from 1 to 8 luxels".
std::string Limits(const SettingEntry &entry) {
    std::string text = HasRange(entry) ? entry.info.range.Text() : "";
    if (text.starts_with("of "))
        text.erase(0, 3);
    if (!entry.info.unit.empty())
        text += (text.empty() ? "in " : " ") + std::string(entry.info.unit);
    return text;
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

std::string MarkdownTable(const SettingSection &section, std::string_view heading, std::string_view column) {
    std::string text = fmt::format("\n{} {}\n\n", heading, section.title);
    if (!section.intro.empty())
        text += fmt::format("{}\n\n", section.intro);
    text += fmt::format("| {} | default | effect |\n|---|---|---|\n", column);
    for (const SettingEntry &entry : section.entries) {
        std::string effect = std::string(entry.info.help);
        if (const std::string limits = Limits(entry); !limits.empty())
            effect += fmt::format(" ({})", limits);
        effect += ".";
        if (!entry.info.details.empty())
            effect += fmt::format(" {}", entry.info.details);
        text += fmt::format("| {} | {} | {} |\n", NamesCell(entry.info), Cell(entry.initial), Cell(effect));
    }
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
        text += fmt::format("\n{}\n", Roff(FullHelp(entry)));
        if (!entry.info.details.empty())
            text += Roff(entry.info.details) + "\n";
    }
    return text;
}

std::vector<SettingSection> SectionsOf(const Stage &stage) {
    return stage.settings ? stage.settings() : std::vector<SettingSection>();
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

std::string StageWords() {
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

} // namespace

std::string FullHelp(const SettingEntry &entry) {
    std::string extra = Limits(entry);
    if (!entry.initial.empty() && !(entry.info.kind == SettingKind::Flag && entry.initial == "off"))
        extra += fmt::format("{}default: {}", extra.empty() ? "" : "; ", entry.initial);
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
    return text + ".SH EXIT STATUS\n0: done. 1: failed. 255: \\-info without files.\n";
}

std::string BashCompletion() {
    std::string cases;
    for (const Stage &stage : Stages())
        cases += fmt::format("            {}) options=\"{}\" ;;\n", stage.word, NamesOf(SectionsOf(stage)));
    return fmt::format(R"(# Generated: q3map2 -help bash > tools/completions/q3map2.bash
_q3map2() {{
    local current=${{COMP_WORDS[COMP_CWORD]}} options="" word
    for word in "${{COMP_WORDS[@]:1}}"; do
        case $word in
{}        esac
    done
    COMPREPLY=()
    if [[ $current == -* ]]; then
        [[ -z $options ]] && options="{}{}"
        mapfile -t COMPREPLY < <(compgen -W "$options{}" -- "$current")
    else
        compopt -o filenames
        mapfile -t COMPREPLY < <(compgen -f -- "$current")
    fi
}}
complete -F _q3map2 q3map2
)",
                       cases, StageWords(), NamesOf(SectionsOf(Stages().front())), " " + NamesOf(GlobalSections()));
}

std::string ZshCompletion() {
    const auto specifications = [](const std::vector<SettingSection> &sections) {
        std::string text;
        ForEntries(sections, [&](const SettingInfo &info) {
            text += fmt::format("        '*{}[{}]", info.name, ZshText(info.help));
            if (info.MinValues() == 1)
                text += fmt::format(":{}:{}", ZshText(info.values), info.kind == SettingKind::Text ? "_files" : "");
            text += "'\n";
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
                                info.MinValues() > 0 ? "-r " : "", Quoted(info.help));
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
