// GPL-2.0-or-later. What the documentation lists: sections of keys and directives. The menus of level editors.
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
    return {DescribeKeys(
                "Worldspawn: light",
                "The light stage writes keys too: `_q3map2_cmdline`, `_q3map2_version`, `_q3map2_sh`, `_q3map2_tone` "
                "and `_q3map2_rnm`. `_q3map2_sh` is `radiance` after `-shradiance`. `_q3map2_tone` is the "
                "tone of the lightmaps, unless it is the default. `_q3map2_rnm` is `raw` or `rescaled`, after "
                "`-rnm`.",
                keys::kWorldLightKeys),
            DescribeKeys("Worldspawn: switchable lights", "", keys::kStyleWorldKeys),
            DescribeKeys("Worldspawn: macro texture", "", keys::kMacroKeys),
            DescribeKeys("Lights",
                         "These keys belong to every entity whose class name starts with `light`. A point light of "
                         "intensity I gives 7500 I / d² levels at distance d, where d counts as at least 16. A linear "
                         "light gives 0.9375 I − d `fade` levels. Entities of the class `lightJunior` light only the "
                         "grids. `_anglescale`, `_filterradius` and spawnflag 2 have no effect on grids.",
                         keys::kLightKeys),
            DescribeKeys("Lights: patterns and switches",
                         "The light stage numbers the styles that these keys need. It writes three keys to worldspawn: "
                         "`_styleNpattern`, the pattern of style N; `_switchN`, the targetnames of the lights of style "
                         "N; and `_switchNdark`, 1 if they start dark. Lights that stay in the `.bsp` get the key "
                         "`style`.",
                         keys::kStyleLightKeys),
            DescribeKeys("Lights: falloff",
                         "These curves come from Source and ericw-tools. If a light has several, the first of these "
                         "counts: `_fifty_percent_distance`, any of the three `_constant_attn` keys, `_radius`, "
                         "`delay`. [From Source or ericw-tools](../guide/from_source_engine.md) has the formulas.",
                         keys::kFalloffKeys),
            DescribeKeys("Lights: cones",
                         "The cone of a `light_spot`, and of any light with one of the first three keys. It replaces "
                         "the cone that `radius` describes. The light is also multiplied by the cosine of the angle to "
                         "the axis.",
                         keys::kConeKeys),
            DescribeKeys("light_environment",
                         "This entity is the sun and the sky light of a map, through any sky. `_light` is the light of "
                         "the sun on a surface that faces it. `pitch`, `angles` and `angle` give the direction in "
                         "which it emits, as for cones. If a map has several, the last one counts.",
                         keys::kEnvironmentKeys),
            DescribeKeys("Lights: HDR", "", keys::kHdrLightKeys),
            DescribeKeys("Worldspawn: bsp and vis", "", keys::kWorldKeys),
            DescribeKeys("Entities with brushes or patches, and the world",
                         "The bsp stage writes these values to the `.srf`. The light stage reads the keys from a map "
                         "that has no `.srf`. If there is one, its `castShadows` counts unless it is 0.",
                         keys::kSurfaceKeys),
            DescribeKeys("misc_model", "", keys::kModelKeys),
            DescribeKeys("Static props",
                         "Static props are entities of the classes `misc_model_static` and `prop_static`, and each "
                         "`misc_model` with `_staticprop`. The light stage lights their vertices with "
                         "`-staticproplighting`. [Static props](../guide/static_props.md) explains them. They also "
                         "have the keys of misc_model for model, skin, size and place, and `_castShadows` and "
                         "`_receiveShadows`, whose default is 1.",
                         keys::kPropKeys),
            DescribeKeys("Terrain", "Entities whose surfaces blend layers as a picture says.", keys::kTerrainKeys),
            DescribeKeys("Decals", "Entities of the class `_decal`, whose patches are projected onto surfaces.",
                         keys::kDecalKeys),
            DescribeKeys("Sky boxes",
                         "Entities of the class `_skybox`. Their area is drawn a second time, enlarged, behind the "
                         "sky surfaces.",
                         keys::kSkyBoxKeys),
            DescribeKeys("Flares", "Keys of lights that the bsp stage reads.", keys::kFlareKeys),
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
        "A stage is a block in braces within a shader. The compiler reads only its images. What the engine does with "
        "them, such as blending, alpha tests and movement, does not change the light. Shadows through textures need "
        "`surfaceparm alphashadow` or `lightfilter`. A generated shader repeats the stages, and its images replace "
        "`$lightmap`.",
        {}});
    for (const StageWordEntry &word : StageWords())
        stages.entries.push_back({word.info, std::string(word.info.initial), "both"});
    return sections;
}

std::vector<SettingSection> SectionsOf(const Stage &stage) {
    return stage.settings ? stage.settings() : std::vector<SettingSection>();
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
