// GPL-2.0-or-later. Files that are generated: documentation of settings, keys and directives, and menus of level
// editors.
#include "q3map2/cli/documentation.h"

#include "common/error.h"
#include "common/files/files.h"
#include "common/text/text.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/cli/presets.h"
#include "q3map2/cli/program.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/editors/editor_files.h"
#include "q3map2/report/version.h"
#include "q3map2/shader/shader_directive.h"

#include <algorithm>
#include <charconv>
#include <sstream>

namespace q3 {

// ---- Documentation of the keys of entities ----

namespace {

std::vector<SettingSection> OwnKeySections() {
    return {DescribeKeys("Worldspawn: light",
                         "The light stage writes `_q3map2_cmdline`, `_q3map2_version`, `_q3map2_sh` with the value "
                         "`radiance` after `-shradiance`, `_q3map2_tone`, the tone of the lightmaps unless it is "
                         "plain, and `_q3map2_rnm`, `raw` or `rescaled`, after `-rnm`.",
                         keys::kWorldLightKeys),
            DescribeKeys("Worldspawn: switchable lights", "", keys::kStyleWorldKeys),
            DescribeKeys("Worldspawn: macro texture", "", keys::kMacroKeys),
            DescribeKeys("Lights",
                         "Every entity whose class name starts with `light`. A point light of intensity I gives "
                         "7500 I / d² of 255 at distance d, at least 16; a linear one 0.9375 I − d `fade`. Entities of "
                         "the class `lightJunior` shine on the grids only. `_anglescale`, `_filterradius` and "
                         "spawnflag 2 have no meaning for grids.",
                         keys::kLightKeys),
            DescribeKeys("Lights: patterns and switches",
                         "The light stage numbers the styles that these need and writes to worldspawn: "
                         "`_styleNpattern`, the pattern of style N; `_switchN`, the targetnames of the lights of style "
                         "N; `_switchNdark`, 1 if they are dark at first. Lights that stay in the `.bsp` get `style`.",
                         keys::kStyleLightKeys),
            DescribeKeys("Lights: falloff",
                         "Curves other than those of the established program; the first of "
                         "`_fifty_percent_distance`, the three of `_constant_attn`, `_radius` and `delay` counts. The "
                         "page [from_source.md](from_source.md) has the formulas.",
                         keys::kFalloffKeys),
            DescribeKeys("Lights: cones",
                         "The cone of a `light_spot`, and of other lights with one of the first three keys, in place "
                         "of the one that `radius` describes. The light is also multiplied by the cosine to the axis.",
                         keys::kConeKeys),
            DescribeKeys("light_environment",
                         "The sun and the sky light of a map, through any sky: `_light` is the light of the sun on a "
                         "surface that faces it, `pitch`, `angles` and `angle` are where it shines, as for cones. The "
                         "last one of a map counts.",
                         keys::kEnvironmentKeys),
            DescribeKeys("Lights: HDR", "", keys::kHdrLightKeys),
            DescribeKeys("Worldspawn: bsp and vis", "", keys::kWorldKeys),
            DescribeKeys("Entities with brushes or patches, and the world",
                         "The bsp stage writes what these keys say to the `.srf`. The light stage reads the keys of a "
                         "map without one; with a `.srf`, its `castShadows` counts where it is not 0.",
                         keys::kSurfaceKeys),
            DescribeKeys("misc_model", "", keys::kModelKeys),
            DescribeKeys("Static props",
                         "Entities of the classes `misc_model_static` and `prop_static`, and each `misc_model` with "
                         "`_staticprop`, which the light stage lights at their vertices with `-staticproplighting`: "
                         "[static_props.md](static_props.md). They have the keys of misc_model for model, skin, size "
                         "and place too, and `_castShadows` and `_receiveShadows`, whose default is 1.",
                         keys::kPropKeys),
            DescribeKeys("Terrain", "Entities whose surfaces blend layers by a picture.", keys::kTerrainKeys),
            DescribeKeys("Decals", "Entities of the class `_decal`, whose patches are projected onto surfaces.",
                         keys::kDecalKeys),
            DescribeKeys("Sky boxes",
                         "Entities of the class `_skybox`: their area is drawn a second time, enlarged, where sky is.",
                         keys::kSkyBoxKeys),
            DescribeKeys("Flares", "Keys of lights for the bsp stage.", keys::kFlareKeys),
            DescribeKeys("Names and instances", "", keys::kNameKeys)};
}

} // namespace

std::vector<SettingSection> EntitySections() {
    std::vector<SettingSection> sections = OwnKeySections();
    for (SettingSection &section : ForeignKeySections())
        sections.push_back(std::move(section));
    return sections;
}

// ---- Documentation of the directives of shader scripts ----

std::vector<SettingSection> DirectiveSections() {
    std::vector<SettingSection> sections;
    for (const DirectiveGroup &group : DirectiveGroups()) {
        SettingSection &section = sections.emplace_back(SettingSection{group.title, group.intro, {}});
        for (const ShaderDirective &directive : group.directives)
            section.entries.push_back({directive.info, std::string(directive.info.initial), directive.stage});
    }
    SettingSection &stages = sections.emplace_back(SettingSection{
        "Inside stages",
        "Of a stage, a block in braces within a shader, the compiler reads images only. What the engine does with them "
        "(blending, alpha tests, movement) does not change light: shadows through textures need `surfaceparm "
        "alphashadow` or `lightfilter`. A generated shader repeats the stages, and its images replace `$lightmap`.",
        {}});
    for (const StageWordEntry &word : StageWords())
        stages.entries.push_back({word.info, {}, "both"});
    return sections;
}

// ---- Pages that are generated from the declared settings ----

namespace {

constexpr std::string_view kOptionRules =
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
    if (HasRange(entry) && (ranges == ShownRanges::All || !info.range.IsDefault()))
        text = RangeInWords(info.range);
    const bool shown = !text.empty();
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
std::string_view DirectiveStageText(std::string_view stage) {
    return stage == "both" ? "bsp, light" : stage == "none" ? "" : stage;
}

/// The text as it stands in a cell of a Markdown table.
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
    if (const std::string limits = Limits(entry, ShownRanges::Declared); !limits.empty())
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

/// MarkdownTable with a column for the stage of each directive.
std::string DirectiveTable(const SettingSection &section) {
    std::string text = fmt::format("\n## {}\n\n", section.title);
    if (!section.intro.empty())
        text += fmt::format("{}\n\n", section.intro);
    text += "| directive | stage | default | effect |\n|---|---|---|---|\n";
    for (const SettingEntry &entry : section.entries)
        text += fmt::format("| {} | {} | {} | {} |\n", NamesCell(entry.info), DirectiveStageText(entry.stage),
                            Cell(entry.initial), Cell(EffectText(entry)));
    return text;
}

/// The text without Markdown, as it stands in a manual page.
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
        text += fmt::format("\n{}\n", Roff(FullHelp(entry, ShownRanges::Declared)));
        if (!entry.info.details.empty())
            text += Roff(entry.info.details) + "\n";
    }
    return text;
}

} // namespace

std::vector<SettingSection> SectionsOf(const Stage &stage) {
    return stage.settings ? stage.settings() : std::vector<SettingSection>();
}

std::string FullHelp(const SettingEntry &entry, ShownRanges ranges) {
    std::string extra = Limits(entry, ranges);
    const auto addExtra = [&](const std::string &more) { extra += (extra.empty() ? "" : "; ") + more; };
    if (!entry.initial.empty() && !(entry.info.kind == SettingKind::Flag && entry.initial == "off"))
        addExtra(fmt::format("default: {}", entry.initial));
    if (const std::string_view stage = DirectiveStageText(entry.stage); !stage.empty())
        addExtra(fmt::format("stage: {}", stage));
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

std::string MarkdownPage(StageList stages) {
    std::string text = fmt::format("<!-- Generated: q3map2 -help markdown > docs/options.md -->\n# Options\n\n"
                                   "    q3map2 [global options] STAGE [options] FILE\n\n{}\n\n"
                                   "| stage | does |\n|---|---|\n",
                                   kOptionRules);
    for (const Stage &stage : stages)
        text += fmt::format("| `{}` | {} |\n", Cell(stage.usage), Cell(stage.help));
    text += "\n## Global options\n";
    for (const SettingSection &section : GlobalSections())
        text += MarkdownTable(section, "###", "option");
    for (const Stage &stage : stages) {
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

std::string ManualPage(StageList stages) {
    std::string text = fmt::format(".\\\" Generated: q3map2 \\-help man > docs/q3map2.1\n"
                                   ".TH Q3MAP2 1 \"\" \"q3map2\\-sh {}\"\n.SH NAME\nq3map2 \\- compile maps for games "
                                   "of the Quake III family\n.SH SYNOPSIS\n.B q3map2\n[global options] stage "
                                   "[options] file\n.SH DESCRIPTION\n{}\n.SH STAGES\n",
                                   kVersionNumber, Roff(kOptionRules));
    for (const Stage &stage : stages)
        text += fmt::format(".TP\n.B q3map2 {}\n{}.\n", Roff(stage.usage), Roff(stage.help));
    text += ".SH GLOBAL OPTIONS\n";
    for (const SettingSection &section : GlobalSections())
        text += RoffSection(section);
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

// ---- q3map2 -editorfiles: menus and profiles for level editors ----

namespace {

namespace fs = std::filesystem;

/// Words of a step, without quotes.
std::vector<std::string> WordsOfStep(const std::string &step) {
    std::istringstream text(step);
    std::vector<std::string> words;
    for (std::string word; text >> word;) {
        std::erase(word, '"');
        words.push_back(word);
    }
    return words;
}

/// The version as a number that grows with it: two decimal digits for each part, so 1.2.3 is 10203.
int VersionAsNumber() {
    int number = 0;
    for (std::string_view rest = kVersionNumber; !rest.empty();) {
        int part = 0;
        const char *const end = std::from_chars(rest.data(), rest.data() + rest.size(), part).ptr;
        number = number * 100 + part;
        rest.remove_prefix(std::min(std::size_t(end - rest.data()) + 1, rest.size()));
    }
    return number;
}

} // namespace

void CheckBuildStep(StageList stages, const std::string &step) {
    Log quiet(Log::Nowhere());
    Arguments arguments(WordsOfStep(step));
    const ChosenStage chosen = TakeStage(stages, arguments);
    ExpandPreset(chosen.stage, arguments, quiet);
    for (const SettingSection &section : SectionsOf(chosen.stage))
        for (const SettingEntry &entry : section.entries)
            for (std::size_t at = 0; at < arguments.Rest().size();)
                if (entry.info.Names(arguments.Rest()[at]))
                    TakeOccurrence(entry.info, entry.info.kind, arguments, at, quiet);
                else
                    ++at;
    if (!chosen.isNamed || !arguments.Empty())
        throw Error("\"{}\" in the menus of editors: there is no {}", step,
                    arguments.Empty() ? "stage" : arguments.Rest().front());
}

int EditorFilesStage(const StageContext &context, Arguments arguments) {
    const std::vector<std::string> folders = TakeFiles(context, arguments);
    if (folders.size() != 1)
        throw Error("usage: q3map2 {}", context.stage.usage);
    FileGuard(context).WritesInto(folders.front());
    std::vector<std::string_view> presets;
    for (const Preset &preset : Presets())
        presets.push_back(preset.name);
    const std::vector<EditorBuild> builds = EditorBuilds(presets);
    for (const EditorBuild &build : builds)
        for (const std::string &step : build.steps)
            CheckBuildStep(context.stages, step);
    for (const std::string_view option : kEditorOptions)
        if (!context.stage.HasOption(option))
            throw Error("{} in the menus of editors: there is no such option", option);
    for (const EditorFile &file : EditorFiles(builds, *context.options.game, VersionAsNumber())) {
        const fs::path path = fs::absolute(folders.front()) / file.path;
        context.log.Print("Writing {}\n", path.string());
        MakeFolder(path.parent_path());
        ReplaceTextFile(path, file.text);
    }
    return 0;
}

} // namespace q3
