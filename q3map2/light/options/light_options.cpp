// GPL-2.0-or-later. Settings of the light stage, declared once. Const after parsing.
#include "q3map2/light/options/light_options.h"

#include "common/error.h"
#include "q3map2/light/options/grid_settings.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>

namespace q3 {

// ---- Settings of the light stage ----

namespace {

/// Default of -shsamples under -fast and -fastgrid.
constexpr float kFastSamples = 1.0f / 16;

LightOptions GameDefaults(const Game &game) {
    LightOptions o;
    o.wolfLighting = game.wolfLighting;
    o.tone = {.gamma = game.gamma, .exposure = game.exposure, .compensate = game.compensate, .sRgb = game.sRgbLightmap};
    o.shader.sRgbColor = game.sRgbColor;
    o.sRgbTexture = game.sRgbTexture;
    o.gridScale = game.gridScale;
    o.gridAmbientScale = game.gridAmbientScale;
    o.noStyles = game.noStyles;
    o.styleSlots = game.styleSlots;
    o.patchShadows = game.patchShadows;
    o.noDrawSurfaceFlags = game.NoDrawSurfaceFlags();
    o.skip.coarse = true; // ApplyInclusions clears it without -fastgrid
    return o;
}

/// Sets options that other options include.
void ApplyInclusions(LightOptions &o) {
    o.fast |= o.faster;
    if (o.faster && o.areaShadows > 0) {
        o.areaShadows = 0;
        o.withoutEffect.emplace_back("-areashadows");
    }
    o.fastGrid |= o.fast;
    o.cheapGrid |= o.cheap;
    o.skip.coarse &= o.fastGrid;
    o.keepSH = o.sh || o.shBspx;
    o.sh = o.keepSH || (o.shRadiance && !o.shAdaptive) || !o.gridFormats.empty();
    o.ambientCubes |= o.cubesFromSH;
    if (o.tone.sRgb)
        o.tolerance = 255 * LinearFromSrgb(1.0f / 255); // what is stored as 1
    o.shSamples = o.givenSHSamples.value_or(o.fastGrid ? kFastSamples : 1);
    // Repeated factors multiply; keep the product within bounds.
    for (float *scale : {&o.pointScale, &o.spotScale, &o.areaScale, &o.skyScale, &o.gridScale, &o.gridAmbientScale})
        *scale = std::clamp(*scale, float(-kMaxSetting), float(kMaxSetting));
}

void CheckCombinations(const LightOptions &o) {
    if (!o.shFill && o.shFit > 0)
        throw Error("-shfit and -noshfill exclude each other");
    if (o.shRadiance && o.shLights)
        throw Error("-shradiance and -shlights exclude each other: a grid that names lights stores irradiance");
    const bool hasCoefficients = o.sh || (o.shAdaptive && !o.shLights); // a grid of nothing else
    struct Need {
        std::string_view name;
        bool given, worksWithLights;
    };
    const Need needs[] = {{"-shdering", o.shDering, false},
                          {"-sherror", o.shError, true},
                          {"-shfit", o.shFit > 0, false},
                          {"-ambientcubesfrom sh", o.cubesFromSH, false},
                          {"-shpreview", !o.previewFile.empty(), true}};
    for (const Need &need : needs)
        if (need.given && !hasCoefficients && !(o.shLights && need.worksWithLights))
            throw Error("{} needs -sh or -shadaptive{}", need.name,
                        need.worksWithLights ? " or -shlights"
                        : o.shLights         ? ", without -shlights"
                                             : "");
    if (o.textureShadows && !o.staticPropPolys)
        throw Error("-textureshadows needs -staticproppolys");
    if (o.staticPropFiles && !o.staticPropLighting)
        throw Error("-staticpropfiles needs -staticproplighting");
}

} // namespace

LightOptions ParseLightOptions(Arguments &arguments, const Game &game, Log &log) {
    LightOptions o = GameDefaults(game);
    TakeSettings(LightOptionSettings(), o, arguments, log);
    ApplyInclusions(o);
    CheckCombinations(o);
    WarnWithoutEffect(o.withoutEffect, log);
    return o;
}

// ---- The options of lights, declared; those of grids are in grid_settings.cpp ----

namespace {

using Group = SettingGroup<LightOptions>;
using Values = SettingValues;

/// Rays of -areashadows without a number, and its maximum.
constexpr int kDefaultAreaRays = 512, kMaxAreaRays = 4096;

/// An option of q3map2 with a factor, which `multiply` applies to the options. `info` lacks what all factors share.
template <typename Multiply> Setting<LightOptions> Factor(SettingInfo info, Multiply multiply) {
    info.values = "F";
    info.kind = SettingKind::Number;
    info.since = "q3map2";
    if (info.initial.empty())
        info.initial = "1";
    return {info, Do<LightOptions>([multiply](LightOptions &o, const Values &v) { multiply(o, float(v.numbers[0])); })};
}

Group Intensities() {
    const auto backsplash = [](LightOptions &o, const Values &v) {
        o.shader.backsplashScale *= float(v.numbers[0]);
        o.shader.backsplashDistance = float(v.numbers[1]);
    };
    return {
        "Light intensities",
        "These options are factors. An option that is repeated multiplies again.",
        {Factor(
             {.name = "-scale", .help = "Multiplies the light of all lights", .since = "0.1.0", .example = "1.5"},
             [](LightOptions &o, float f) { o.pointScale *= f, o.spotScale *= f, o.areaScale *= f, o.skyScale *= f; }),
         Factor({.name = "-point",
                 .aliases = {"-pointscale"},
                 .help = "Multiplies the light of point lights and spotlights",
                 .details = "F multiplies a built-in factor of 7500.",
                 .since = "0.1.0",
                 .example = "1.5"},
                [](LightOptions &o, float f) { o.pointScale *= f, o.spotScale *= f; }),
         Factor({.name = "-spherical",
                 .aliases = {"-sphericalscale"},
                 .help = "Multiplies the light of point lights, but not that of spotlights",
                 .details = "F multiplies a built-in factor of 7500.",
                 .since = "0.1.0",
                 .example = "1.5"},
                [](LightOptions &o, float f) { o.pointScale *= f; }),
         Factor({.name = "-spot",
                 .aliases = {"-spotscale"},
                 .help = "Multiplies the light of spotlights",
                 .details = "F multiplies a built-in factor of 7500.",
                 .since = "0.1.0",
                 .example = "2"},
                [](LightOptions &o, float f) { o.spotScale *= f; }),
         Factor({.name = "-area",
                 .aliases = {"-areascale"},
                 .help = "Multiplies the light of surface lights (q3map_surfaceLight)",
                 .details = "F multiplies a built-in factor of 0.25.",
                 .since = "0.1.0",
                 .example = "1.5"},
                [](LightOptions &o, float f) { o.areaScale *= f; }),
         Factor({.name = "-sky",
                 .aliases = {"-skyscale"},
                 .help = "Multiplies the light of suns and skies",
                 .since = "0.1.0",
                 .example = "0.8"},
                [](LightOptions &o, float f) { o.skyScale *= f; }),
         Factor(
             {.name = "-gridscale",
              .initial = "by game, usually 1",
              .help = "Multiplies the light of all light grids",
              .details = "Concerns the legacy grid, the SH grid and ambient cubes. A product of 0 or less counts as 1.",
              .since = "0.1.0",
              .example = "1.2"},
             [](LightOptions &o, float f) { o.gridScale *= f; }),
         Factor({.name = "-gridambientscale",
                 .initial = "by game, usually 1",
                 .help = "Multiplies the ambient part of the legacy grid",
                 .since = "0.1.0",
                 .example = "0.5"},
                [](LightOptions &o, float f) { o.gridAmbientScale *= f; }),
         {{.name = "-backsplash",
           .values = "F DIST",
           .kind = SettingKind::Number,
           .initial = "1 23",
           .help = "Sets how much light surface lights throw back on their own wall, and from what distance",
           .details = "F multiplies the default fraction of 5 %. DIST is the distance in game units, and a value below "
                      "-900 keeps the default. The shader directive `q3map_backsplash` overrides both.",
           .since = "q3map2",
           .example = "2 16"},
          Do<LightOptions>(backsplash)},
         Factor({.name = "-backsplasharea",
                 .help = "Multiplies the light that surface lights throw back on their own wall",
                 .details = "Is the factor of `-backsplash` without its distance.",
                 .since = "0.2.0",
                 .example = "2"},
                [](LightOptions &o, float f) { o.shader.backsplashScale *= f; }),
         {{.name = "-lights",
           .values = "FILE.rad",
           .initial = "none",
           .help = "Reads one more file of texlights, after lights.rad and before that of the map",
           .details = "FILE.rad is a path, or else a name among the files of the game. Such files say how much light "
                      "the materials of Source emit, see [Coming from Source](../guide/from_source_engine.md). Can be "
                      "repeated.",
           .since = "VRAD",
           .example = "extra.rad"},
          &LightOptions::texLightFiles},
         {{.name = "-recoverlights",
           .help = "First finds the lamps of a map whose source is lost, and lights it with them",
           .details = "Does what the stage [-recoverlights](other_stages.md#-recoverlights) does, with the options of "
                      "the light run that the map records, or with none. The other options of this run say how the "
                      "map is lit then. The lamps go to `x.lights.map` too.",
           .since = "0.2.0"},
          &LightOptions::recoverLamps}}};
}

Group Falloff() {
    const auto directed = [](LightOptions &o, const Values &v) {
        o.gridDirectionality = float(v.numbers[0]);
        o.gridAmbientDirectionality = std::min(o.gridAmbientDirectionality, o.gridDirectionality);
    };
    const auto ambient = [](LightOptions &o, const Values &v) {
        o.gridAmbientDirectionality = float(v.numbers[0]);
        o.gridDirectionality = std::max(o.gridDirectionality, o.gridAmbientDirectionality);
    };
    return {"Direction and falloff",
            "",
            {{{.name = "-griddirectionality",
               .values = "F",
               .kind = SettingKind::Number,
               .initial = "1",
               .range = {.high = 1},
               .outside = OutOfRange::Clamp,
               .help = "Sets the fraction of light from the main direction that the legacy grid stores as directed",
               .details = "Also lowers the fraction of `-gridambientdirectionality` to F if it is larger.",
               .since = "q3map2",
               .example = "0.5"},
              Do<LightOptions>(directed)},
             {{.name = "-gridambientdirectionality",
               .values = "F",
               .kind = SettingKind::Number,
               .initial = "0",
               .range = {.low = -1},
               .outside = OutOfRange::Clamp,
               .help = "Sets the fraction of light from the opposite side that the legacy grid stores as directed",
               .details = "Also raises the fraction of `-griddirectionality` to F if it is smaller.",
               .since = "q3map2",
               .example = "0.25"},
              Do<LightOptions>(ambient)},
             {{.name = "-extradist",
               .values = "F",
               .unit = "game units",
               .range = {.low = 0},
               .help = "Softens point lights and spotlights close to them, as if they were farther away",
               .details = "The distance d becomes √(d² + F²). The key `_extradist` of a light overrides it.",
               .since = "q3map2",
               .example = "50"},
              &LightOptions::extraDist},
             {{.name = "-wolf",
               .initial = "by game",
               .help = "Makes lights without spawnflags fall off linearly, as in the Wolfenstein games",
               .since = "q3map2"},
              &LightOptions::wolfLighting},
             {{.name = "-q3",
               .initial = "by game",
               .help = "Makes lights without spawnflags fall off with the square of the distance",
               .since = "q3map2"},
              Off(&LightOptions::wolfLighting)}}};
}

Group Tone() {
    const auto contrast = [](LightOptions &o, const Values &v) {
        // The usual factor of contrast correction: 0 at -255, 1 at 0, 129.5 at 255.
        const float c = float(v.numbers[0]);
        o.tone.contrast = 259 * (c + 255) / (255 * (259 - c));
    };
    const auto tone = [](float ToneOptions::*field) {
        return [field](auto &o) -> auto & {
            return o.tone.*field;
        };
    };
    return {
        "Tone of lightmaps, vertices and the legacy grid",
        "These options change how light becomes 8-bit levels. The SH grid stays linear and unlimited. Engines apply "
        "the tone to it by the worldspawn key `_q3map2_tone`, which the light stage writes, see "
        "[Tone](../engines/tone.md). The steps are applied in this order: scale, contrast, gamma, exposure, "
        "saturation, brightness and compensation, `_maxlight` (which keeps the hue), sRGB, and truncation to 8 bits.",
        {{{.name = "-contrast",
           .values = "F",
           .kind = SettingKind::Number,
           .initial = "0",
           .range = {-255, 255},
           .help = "Sets the contrast around the middle gray of 128",
           .details = "The distance from 128 is multiplied by 259 (F + 255) / (255 (259 - F)).",
           .since = "q3map2",
           .example = "20"},
          Do<LightOptions>(contrast)},
         {{.name = "-gamma",
           .values = "F",
           .initial = "by game, usually 1",
           .range = {.low = 0, .aboveLow = true},
           .outside = OutOfRange::UseDefault,
           .outsideValue = 1,
           .help = "Sets the gamma of stored light, where more than 1 brightens dark areas",
           .details = "The exponent is 1/F.",
           .since = "q3map2",
           .example = "1.5"},
          tone(&ToneOptions::gamma)},
         {{.name = "-exposure",
           .values = "F",
           .initial = "by game, usually 0",
           .help = "Limits bright light softly instead of cutting it off",
           .details = "If c is the largest channel of a color, it becomes 255 (1 − e^(−c / F)), and the others keep "
                      "their ratio to it. A value of 0 turns it off.",
           .since = "q3map2",
           .example = "200"},
          tone(&ToneOptions::exposure)},
         {{.name = "-saturation",
           .values = "F",
           .help = "Sets the color saturation, where 0 is gray and more than 1 is more vivid",
           .since = "q3map2",
           .example = "1.2"},
          tone(&ToneOptions::saturation)},
         {{.name = "-compensate",
           .values = "F",
           .initial = "by game, usually 1",
           .range = {.low = 0, .aboveLow = true},
           .outside = OutOfRange::UseDefault,
           .outsideValue = 1,
           .help = "Divides stored light by F, for engines that multiply it again",
           .since = "q3map2",
           .example = "4"},
          tone(&ToneOptions::compensate)}}};
}

Group ColorSpaces() {
    enum class Transfer { SRgb, Linear };
    using Apply = void (*)(LightOptions &, bool sRgb);
    constexpr Apply kStoredLight = [](LightOptions &o, bool sRgb) { o.tone.sRgb = sRgb; };
    constexpr Apply kGivenColors = [](LightOptions &o, bool sRgb) { o.shader.sRgbColor = sRgb; };
    constexpr Apply kTextures = [](LightOptions &o, bool sRgb) { o.sRgbTexture = sRgb; };
    constexpr Apply kAll = [](LightOptions &o, bool sRgb) { o.tone.sRgb = o.shader.sRgbColor = o.sRgbTexture = sRgb; };
    const auto encode = [](Apply apply, Transfer transfer) {
        return Do<LightOptions>([=](LightOptions &o, const Values &) { apply(o, transfer == Transfer::SRgb); });
    };
    return {"Color spaces",
            "These options override the color spaces that `-game` selects.",
            {{{.name = "-sRGBlight",
               .initial = "by game, usually off",
               .help = "Stores light in sRGB",
               .details = "Also lowers the falloff tolerance, at which lights end, from one 8-bit level to 0.077.",
               .since = "q3map2"},
              encode(kStoredLight, Transfer::SRgb)},
             {{.name = "-nosRGBlight", .help = "Stores light linearly", .since = "q3map2"},
              encode(kStoredLight, Transfer::Linear)},
             {{.name = "-sRGBcolor",
               .initial = "by game, usually off",
               .help = "Takes the colors of entities, suns and q3map_lightRGB as sRGB",
               .details = "Concerns the light grids too.",
               .since = "q3map2"},
              encode(kGivenColors, Transfer::SRgb)},
             {{.name = "-nosRGBcolor",
               .help = "Takes the colors of entities, suns and q3map_lightRGB as linear",
               .since = "q3map2"},
              encode(kGivenColors, Transfer::Linear)},
             {{.name = "-sRGBtex",
               .initial = "by game, usually off",
               .help = "Takes images as sRGB where they tint bounced light",
               .since = "q3map2"},
              encode(kTextures, Transfer::SRgb)},
             {{.name = "-nosRGBtex", .help = "Takes images as linear where they tint bounced light", .since = "q3map2"},
              encode(kTextures, Transfer::Linear)},
             {{.name = "-sRGB", .help = "Stands for -sRGBlight, -sRGBcolor and -sRGBtex", .since = "q3map2"},
              encode(kAll, Transfer::SRgb)},
             {{.name = "-nosRGB", .help = "Stands for -nosRGBlight, -nosRGBcolor and -nosRGBtex", .since = "q3map2"},
              encode(kAll, Transfer::Linear)}}};
}

Group Speed() {
    return {
        "Speed and quality",
        "",
        {{{.name = "-fast",
           .help = "Makes a quick draft, with fewer rays and with lights that end where they get faint",
           .details =
               "Implies `-fastgrid`. Surface lights give nothing where they would give at most one 8-bit level. For "
               "a surface light that solids cover in part, this tolerance is proportional to the area of the open "
               "part. Bounced light ends in the same way on surfaces, and `-bouncerays` is 24 by default.",
           .since = "q3map2"},
          &LightOptions::fast},
         {{.name = "-fastgrid",
           .help = "Makes a quick draft of the light grids only",
           .details = "Lights end in the legacy grid where they get faint. The SH grid takes fewer rays and samples, "
                      "as with `-shsamples` 1/16.",
           .since = "q3map2"},
          &LightOptions::fastGrid},
         {{.name = "-faster",
           .help = "Makes an even quicker draft than -fast, by treating surface lights as points",
           .details = "Implies `-fast`, and turns off `-areashadows`. The SH grid keeps exact surface lights. In the "
                      "legacy grid, surface lights then emit to all sides.",
           .since = "q3map2"},
          &LightOptions::faster},
         {{.name = "-cheap",
           .help = "Adds no more light to vertices and legacy grid points that are white already",
           .details = "Implies `-cheapgrid`.",
           .since = "q3map2"},
          &LightOptions::cheap},
         {{.name = "-cheapgrid",
           .help = "Adds no more light to legacy grid points that are white already",
           .since = "q3map2"},
          &LightOptions::cheapGrid},
         {{.name = "-nogrid", .help = "Leaves the legacy light grid as it is", .since = "q3map2"},
          &LightOptions::noGrid}}};
}

Group Rays() {
    const auto customInfoParms = [](auto &o) -> auto & {
        return o.shader.customInfoParms;
    };
    const auto areaShadows = [](LightOptions &o, const Values &v) {
        o.areaShadows = v.numbers.empty() ? kDefaultAreaRays : int(v.numbers[0]);
    };
    return {
        "Lights and shadows",
        "",
        {{{.name = "-notrace",
           .help = "Lights the map without shadows",
           .details =
               "Suns then light everything that faces them. Floodlight, dirt and bounced light are traced as usual.",
           .since = "q3map2"},
          &LightOptions::noTrace},
         {{.name = "-areashadows",
           .values = "[N]",
           .kind = SettingKind::Integer,
           .unit = "rays",
           .initial = "off; 512 without N",
           .range = {1, kMaxAreaRays},
           .help = "Gives surface lights soft shadows, with at most N rays from each luxel to each light",
           .details =
               "A luxel that sees a part of a surface light gets the light of that part, instead of all or nothing "
               "by one ray to its middle. Most rays go to penumbrae, where N limits the noise. Suns with a deviance, "
               "skies, and lights with `_samples` take all of their samples only where some of them are hidden, and "
               "2 to 63 samples become 64. Concerns lightmaps, vertices and static props, and the light that they "
               "reflect. The SH grid always has soft shadows. Shadows of these lights are not refined by `-samples`, "
               "because they have no hard edges. Turned off by `-faster`. [Lighting](../guide/lighting.md) shows the "
               "difference.",
           .since = "0.2.0",
           .example = "64"},
          Do<LightOptions>(areaShadows)},
         {{.name = "-nosurf", .help = "Makes only structural brushes cast shadows", .since = "q3map2"},
          &LightOptions::structuralShadowsOnly},
         {{.name = "-patchshadows",
           .initial = "by game, usually off",
           .help = "Makes curved surfaces cast shadows",
           .details = "Has no effect on the legacy grid.",
           .since = "q3map2"},
          &LightOptions::patchShadows},
         {{.name = "-sunonly", .help = "Lights the map with suns and sky light only", .since = "q3map2"},
          &LightOptions::sunOnly},
         {{.name = "-onesky",
           .help = "Lets suns reach surfaces through every sky, not only through the sky of their shader",
           .since = "q3map2"},
          &LightOptions::oneSky},
         {{.name = "-style",
           .aliases = {"-styles"},
           .initial = "by game, usually on",
           .help = "Keeps light styles, which are flickering and switchable lights",
           .details =
               "In lightmaps, each style needs a shader stage, which the light stage generates. Vertices, the "
               "legacy grid and the SH grid hold style 0 only, except that RBSP and FBSP files hold other styles "
               "at vertices and in the legacy grid too. Lights with a style can be named by `-shlights`.",
           .since = "q3map2"},
          Off(&LightOptions::noStyles)},
         {{.name = "-nostyle",
           .aliases = {"-nostyles"},
           .help = "Bakes lights with a style as constant lights",
           .since = "q3map2"},
          &LightOptions::noStyles},
         {{.name = "-switchable",
           .help = "Gives lights with a targetname light styles of their own, which the game can switch",
           .details = "Has the same effect as the worldspawn key `_switchable`. Writes keys `_switchN` to worldspawn, "
                      "see [Coming from Source](../guide/from_source_engine.md).",
           .since = "0.2.0"},
          &LightOptions::switchable},
         {{.name = "-floodlight",
           .help = "Adds soft light wherever there is open space around",
           .details = "Takes its values from the worldspawn key `_floodlight`, which turns it on by itself. Without "
                      "the key, the color is 0.94 0.94 1, the distance 1024 and the intensity 128.",
           .since = "q3map2"},
          &LightOptions::floodlight},
         {{.name = "-lowquality",
           .help = "Traces floodlight with 32 rays per hemisphere instead of 64",
           .since = "q3map2"},
          &LightOptions::lowQuality},
         {{.name = "-custinfoparms",
           .help = "Reads more surfaceparms from custinfoparms.txt in the folder of the shader scripts",
           .since = "q3map2"},
          customInfoParms}}};
}

Group StaticProps() {
    return {"Static props",
            "Static props are models that stay entities in the `.bsp`. [Static props](../guide/static_props.md) "
            "explains them.",
            {{{.name = "-staticproplighting",
               .help = "Lights static props at their vertices and stores that in the BSPX lump STATIC_PROP_LIGHT",
               .details = "Lit props also cast shadows, which are those of their boxes without `-staticproppolys`.",
               .since = "VRAD"},
              &LightOptions::staticPropLighting},
             {{.name = "-staticproppolys",
               .help = "Makes static props cast the shadows of their triangles",
               .since = "VRAD"},
              &LightOptions::staticPropPolys},
             {{.name = "-textureshadows",
               .help = "Lets light through the masked textures of static props",
               .details = "Needs `-staticproppolys`.",
               .since = "VRAD"},
              &LightOptions::textureShadows},
             {{.name = "-staticpropfiles",
               .help = "Also writes the light of static props to files next to the map",
               .details = "Needs `-staticproplighting`.",
               .since = "0.2.0"},
              &LightOptions::staticPropFiles}}};
}

Group BotFiles() {
    return {"Bot file",
            "",
            {{{.name = "-fixaas",
               .help = "Makes the bot files next to the map valid for the lit map",
               .details = "Bot files hold a checksum of all bytes of the map, so engines refuse them once the map is "
                          "lit. Without this option, a warning says so. The stage "
                          "[-fixaas](other_stages.md#-fixaas) does the same for a finished map.",
               .since = "0.2.0"},
              &LightOptions::fixBotFiles}}};
}

Group Explanations() {
    const auto point = [](LightOptions &o, const Values &v) {
        o.explain.push_back({float(v.numbers[0]), float(v.numbers[1]), float(v.numbers[2])});
    };
    return {"Explanations",
            "This option prints why a place is lit as it is, see [Explanations](../guide/explain.md). Nothing is baked "
            "and no file changes.",
            {{{.name = "-explain",
               .values = "X Y Z",
               .kind = SettingKind::Number,
               .unit = "game units",
               .initial = "none",
               .help = "Prints which lights reach a point of a lit map, and what blocks the others",
               .details = "Give the same options that the map was lit with. The nearest luxel is printed too, and the "
                          "points of both light grids around the position, with where they take their light from. "
                          "Repeat the option for more positions.",
               .since = "0.2.0",
               .example = "0 0 64"},
              Do<LightOptions>(point)}}};
}

Group Ignored() {
    const auto nothing = [](std::string_view name, std::string_view help) {
        Setting<LightOptions> setting = WithoutEffect(&LightOptions::withoutEffect, name, help);
        setting.info.since = "q3map2";
        return setting;
    };
    return {"Accepted without effect",
            "These options of q3map2 select what this program always does. A warning names them.",
            {nothing("-lomem", "Memory is always saved"),
             nothing("-fastallocate", "Lightmaps are packed quickly unless -slowallocate is given"),
             nothing("-fastbounce", "Bounced light is not made of area lights that could end early; use -fast"),
             nothing("-nobouncestore", "The .bsp is always written once, after the last bounce"),
             nothing("-dump", "Bounced light is not made of area lights that could be written to a .map")}};
}

} // namespace

std::vector<SettingGroup<LightOptions>> LightOptionSettings() {
    std::vector<Group> groups = GridSettings();
    for (const Group &group : {Intensities(), Falloff(), Tone(), ColorSpaces(), Speed(), Rays(), StaticProps(),
                               BotFiles(), Explanations(), Ignored()})
        groups.push_back(group);
    return groups;
}

} // namespace q3
