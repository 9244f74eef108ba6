// GPL-2.0-or-later. Settings of the light stage, declared once. Const after parsing.
#include "q3map2/light/options/light_options.h"

#include "common/error.h"
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

// ---- The options of lights and light grids, declared ----

namespace {

using Group = SettingGroup<LightOptions>;
using Values = SettingValues;

/// -shfit without a number, and its maximum.
constexpr int kDefaultFit = 6, kMaxFit = 64;

/// Rays of -areashadows without a number, and its maximum.
constexpr int kDefaultAreaRays = 512, kMaxAreaRays = 4096;

/// An option with a factor, which `multiply` applies to the options.
template <typename Multiply>
Setting<LightOptions> Factor(std::string_view name, std::string_view alias, std::string_view initial,
                             std::string_view help, Multiply multiply) {
    return {{.name = name,
             .aliases = {alias},
             .values = "F",
             .kind = SettingKind::Number,
             .initial = initial,
             .help = help},
            Do<LightOptions>([multiply](LightOptions &o, const Values &v) { multiply(o, float(v.numbers[0])); })};
}

Group GridSH() {
    const auto cell = [](LightOptions &o, const Values &v) {
        o.gridSizeSH = Vec3f{float(v.numbers[0]), float(v.numbers[1]), float(v.numbers[2])};
    };
    const auto small = [](LightOptions &o, const Values &) {
        o.sh = true;
        o.gridSizeSH = Vec3f{kSmallCellSH, kSmallCellSH, kSmallCellSH};
        o.shFit = kDefaultFit;
    };
    return {
        "SH light grid",
        "",
        {{{.name = "-sh",
           .help = "Bake the SH light grid into lump 18 of a version 47 file",
           .details = "Without it a relight drops an SH grid that the file had, with a warning. RBSP and FBSP files "
                      "have it in a BSPX lump, as with `-shbspx`."},
          &LightOptions::sh},
         {{.name = "-shbspx",
           .help = "Bake it into a BSPX lump, so that unmodified engines load the file; includes -sh"},
          &LightOptions::shBspx},
         {{.name = "-shradiance",
           .help = "Store radiance instead of irradiance, for engines that convolve themselves; includes -sh",
           .details = "Where `-shadaptive`, or `sh`, `shbspx` or `sparse` in `-gridformats`, name the grids to "
                      "store, it adds none."},
          &LightOptions::shRadiance},
         {{.name = "-gridformats",
           .values = "LIST",
           .initial = "none",
           .help = "Make other light grids of the SH grid, for other engines: LIST of formats",
           .details = "As the stage `-convertgrid` does with a lit map, where the words are explained. The SH grid "
                      "is baked but stays in the map only with `sh` or `shbspx` in LIST or with an option that "
                      "includes `-sh`. A legacy grid made of it is not traced."},
          &LightOptions::gridFormats},
         {{.name = "-shsmall",
           .help = "A grid of about a quarter of the bytes: -gridsh 64 64 64 -shfit; includes -sh",
           .details = "[ship_sh.md](ship_sh.md) compares sizes and errors. `-gridsh` and `-shfit N` override it."},
          Do<LightOptions>(small)},
         {{.name = "-gridscalesh",
           .values = "F",
           .range = {.low = 0, .aboveLow = true},
           .help = "Points per axis relative to the legacy grid: 2 halves the cell of gridsize"},
          &LightOptions::gridScaleSH},
         {{.name = "-gridsh",
           .values = "X Y Z",
           .kind = SettingKind::Number,
           .unit = "game units",
           .initial = "gridsize divided by -gridscalesh",
           .range = {.low = 0, .aboveLow = true},
           .floor = double(kMinCell),
           .help = "Size of a cell",
           .details = "The smallest cell is 8; a smaller value becomes 8, with a warning."},
          Do<LightOptions>(cell)}}};
}

Group SparseGridSH() {
    const auto goal = [](LightOptions &o) -> SparseGoal & {
        o.shAdaptive = o.sparseGoal.isGiven = true;
        return o.sparseGoal;
    };
    return {
        "Sparse SH light grid",
        "Cells down to 4 units where the light needs them, large ones elsewhere: "
        "[light_grid_sh.md](light_grid_sh.md#the-sparse-grid).",
        {{{.name = "-shadaptive",
           .help = "Bake the SH light as a sparse grid into a BSPX lump, which unmodified engines ignore",
           .details = "Beside it, `-sh` or `-shbspx` store the uniform grid too. Without it a relight drops a "
                      "sparse grid that the file had, with a warning."},
          &LightOptions::shAdaptive},
         {{.name = "-shlights",
           .help = "Bake the SH light as a grid that names its strongest lights, into a BSPX lump",
           .details = "Points hold which share of each named light arrives there, and SH coefficients of all other "
                      "light; engines work named lights out at the place of the model: "
                      "[light_grid_sh.md](light_grid_sh.md#a-grid-that-names-lights). Cells are those of `-gridsh`. "
                      "With `-shadaptive` cells are split and joined instead, as `-sherrortarget` or `-shbudget` "
                      "say, from first cells of twice that edge, and there is no other sparse grid; without those "
                      "two, splitting ends where it would take longer than the uniform grid. Lights with a style are "
                      "named wherever they shine, so engines can switch them. Excludes `-shradiance`."},
          &LightOptions::shLights},
         {{.name = "-shnames",
           .values = "N",
           .kind = SettingKind::Integer,
           .unit = "lights",
           .range = {1, 16},
           .help = "Most lights without a style that a cell names, of -shlights"},
          &LightOptions::shNames},
         ErrorTargetSetting<LightOptions>(
             "Error that the sparse grid may have on a screen at random positions of players: RMS; includes "
             "-shadaptive",
             "It is measured and printed. Cells are split while it is above this, smaller cells reduce it, and the "
             "grid has "
             "at most half of the bytes of the uniform one, or 0.08 MB: "
             "[accuracy.md](accuracy.md#error-against-bytes).",
             goal),
         BudgetSetting<LightOptions>("Size of the sparse grid, in place of an error target; includes -shadaptive",
                                     "The least error that fits.", goal)}};
}

Group QualityOfGridSH() {
    const auto fit = [](LightOptions &o, const Values &v) {
        o.shFit = v.numbers.empty() ? kDefaultFit : int(v.numbers[0]);
    };
    return {
        "SH light grid: quality",
        "",
        {{{.name = "-shdering",
           .help = "Remove negative lobes, the dark side that a strong light leaves",
           .details =
               "Where a channel of a point is below zero in some direction, its bands 1 and 2 are scaled by the least "
               "window that leaves no negative value (Sloan 2008); the mean and all other points stay. Interpolated "
               "values are then nowhere negative either; a sparse grid rounds its values, so a little is left. Needs "
               "`-sh`, `-shbspx`, `-shradiance` or `-shadaptive`."},
          &LightOptions::shDering},
         {{.name = "-sherror",
           .help = "Compare the grid with exact light and print its error, after baking",
           .details = "At 2000 random positions that a player can reach: the error of displayed light, the share of "
                      "light leaks, and, of the uniform grid, the cell size that would halve the error. Needs `-sh`, "
                      "`-shbspx`, `-shradiance` or `-shadaptive`."},
          &LightOptions::shError},
         {{.name = "-shfit",
           .values = "[N]",
           .kind = SettingKind::Integer,
           .unit = "samples a cell",
           .initial = "off; 6 without N",
           .range = {1, kMaxFit},
           .help = "Fit the points to N light samples in each cell by least squares: slower, more exact",
           .details = "Samples are taken where players can be, more of them beside lamps. Takes about N times as long; "
                      "[accuracy.md](accuracy.md) says what it gains. Needs `-sh`, `-shbspx` or `-shradiance`, and "
                      "excludes `-noshfill`."},
          Do<LightOptions>(fit)},
         {{.name = "-noshfill", .help = "Fill points inside walls from their neighbors, without fitting them"},
          Off(&LightOptions::shFill)},
         {{.name = "-shsamples",
           .values = "F",
           .initial = "1; 1/16 with -fast",
           .range = {1.0 / 64, 64},
           .help = "Factor for the number of rays and samples"},
          &LightOptions::givenSHSamples},
         {{.name = "-shpreview",
           .values = "FILE.png",
           .initial = "none",
           .help = "Draw both light grids to a picture; needs -sh"},
          &LightOptions::previewFile}}};
}

Group AmbientCubes() {
    const auto from = [](LightOptions &o, const Values &v) {
        o.ambientCubes = true;
        o.cubesFromSH = v.words[0] == "sh";
    };
    return {"Ambient cubes",
            "Light on surfaces that face the six axes, at up to 16 places in each leaf of the tree: "
            "[ambient_cubes.md](ambient_cubes.md).",
            {{{.name = "-ambientcubes",
               .help = "Bake ambient cubes into a BSPX lump, which unmodified engines ignore",
               .details = "Without it a relight drops those that the file had, with a warning."},
              &LightOptions::ambientCubes},
             {{.name = "-ambientcubesfrom",
               .values = "light|sh",
               .kind = SettingKind::Choice,
               .initial = "light",
               .help = "Trace the light of cubes, or take it from the SH grid; includes -ambientcubes",
               .details = "`sh` costs next to nothing, has the errors of the grid, and needs `-sh`."},
              Do<LightOptions>(from)},
             {{.name = "-cubesperleaf",
               .values = "N",
               .kind = SettingKind::Integer,
               .range = {1, 32},
               .help = "Keep at most N cubes of a leaf",
               .details = "Engines blend all of them at every model; more than 16 hardly make the blend better."},
              &LightOptions::cubesPerLeaf},
             {{.name = "-cubetolerance",
               .values = "F",
               .unit = "255ths on a screen of gamma 2.2",
               .range = {.low = 0, .high = 255},
               .help = "Leave out cubes that the others of their leaf reproduce within this"},
              &LightOptions::cubeTolerance}}};
}

Group Skips() {
    const auto skip = [](bool SkipOptions::*field) {
        return Do<LightOptions>([field](LightOptions &o, const Values &) { o.skip.*field = false; });
    };
    const auto none = [](LightOptions &o, const Values &) {
        o.skip = {.reach = false,
                  .pvs = false,
                  .faint = false,
                  .moments = false,
                  .probes = false,
                  .smooth = false,
                  .coarse = false};
    };
    return {
        "Accelerations to switch off",
        "Light that cannot matter is not computed. These switches compute it all the same, to measure what is "
        "lost.",
        {{{.name = "-noskip", .help = "Trace every light at every point: all of the following"},
          Do<LightOptions>(none)},
         {{.name = "-noskipreach", .help = "Trace lights that are out of reach or face away too"},
          skip(&SkipOptions::reach)},
         {{.name = "-noskippvs", .help = "Trace lights that visibility data hides too"}, skip(&SkipOptions::pvs)},
         {{.name = "-noskipfaint",
           .help = "Trace all faint lights instead of a random few",
           .details = "Of both grids, and of surface lights in lightmaps."},
          skip(&SkipOptions::faint)},
         {{.name = "-noskipmoments", .help = "Integrate far surface lights exactly too (both grids)"},
          skip(&SkipOptions::moments)},
         {{.name = "-noskipprobes", .help = "Cast several rays to faint surface lights too"},
          skip(&SkipOptions::probes)},
         {{.name = "-noskipsmooth", .help = "Trace weak light at every point of the SH grid, also where it is smooth"},
          skip(&SkipOptions::smooth)},
         {{.name = "-noskipcoarse", .help = "With -fast or -fastgrid: cast rays to dim lights at every point"},
          skip(&SkipOptions::coarse)}}};
}

Group Intensities() {
    const auto backsplash = [](LightOptions &o, const Values &v) {
        o.shader.backsplashScale *= float(v.numbers[0]);
        o.shader.backsplashDistance = float(v.numbers[1]);
    };
    return {
        "Light intensities",
        "Each factor multiplies, and multiplies again when it is repeated.",
        {Factor(
             "-scale", "", "1", "Factor of all lights",
             [](LightOptions &o, float f) { o.pointScale *= f, o.spotScale *= f, o.areaScale *= f, o.skyScale *= f; }),
         Factor("-point", "-pointscale", "1 (times 7500)", "Factor of point lights and spotlights",
                [](LightOptions &o, float f) { o.pointScale *= f, o.spotScale *= f; }),
         Factor("-spherical", "-sphericalscale", "1 (times 7500)", "Factor of point lights only",
                [](LightOptions &o, float f) { o.pointScale *= f; }),
         Factor("-spot", "-spotscale", "1 (times 7500)", "Factor of spotlights only",
                [](LightOptions &o, float f) { o.spotScale *= f; }),
         Factor("-area", "-areascale", "1 (times 0.25)", "Factor of surface lights (q3map_surfaceLight)",
                [](LightOptions &o, float f) { o.areaScale *= f; }),
         Factor("-sky", "-skyscale", "1", "Factor of suns and sky light",
                [](LightOptions &o, float f) { o.skyScale *= f; }),
         Factor("-gridscale", "", "by game, usually 1",
                "Factor of both light grids; a product of 0 or less counts as 1",
                [](LightOptions &o, float f) { o.gridScale *= f; }),
         Factor("-gridambientscale", "", "by game, usually 1", "Factor of the ambient part of the legacy grid",
                [](LightOptions &o, float f) { o.gridAmbientScale *= f; }),
         {{.name = "-backsplash",
           .values = "F DIST",
           .kind = SettingKind::Number,
           .initial = "1 23",
           .help = "Light that surface lights throw back on their own wall: factor, distance in game units",
           .details = "The factor is of the default 5 %. A distance under −900 keeps the default. A shader's "
                      "`q3map_backsplash` wins."},
          Do<LightOptions>(backsplash)},
         Factor("-backsplasharea", "", "1", "Factor as the first of -backsplash, which leaves the distance as it is",
                [](LightOptions &o, float f) { o.shader.backsplashScale *= f; }),
         {{.name = "-lights",
           .values = "FILE.rad",
           .initial = "none",
           .help = "Read one more file of texlights, between lights.rad and that of the map",
           .details = "A path, or else a name among the game's files. Such files say what light the textures of "
                      "Source emit: [from_source.md](from_source.md#texlights)."},
          &LightOptions::texLightFiles}}};
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
               .help = "Legacy grid: share of light from the main direction that stays directed"},
              Do<LightOptions>(directed)},
             {{.name = "-gridambientdirectionality",
               .values = "F",
               .kind = SettingKind::Number,
               .initial = "0",
               .range = {.low = -1},
               .outside = OutOfRange::Clamp,
               .help = "Legacy grid: the same share of light from the opposite side"},
              Do<LightOptions>(ambient)},
             {{.name = "-extradist",
               .values = "F",
               .unit = "game units",
               .range = {.low = 0},
               .help = "Soften point lights and spotlights nearby: distance d becomes √(d² + F²)",
               .details = "The key `_extradist` of a light wins."},
              &LightOptions::extraDist},
             {{.name = "-wolf",
               .initial = "by game",
               .help = "Lights without spawnflags fall off linearly, as in the Wolfenstein games"},
              &LightOptions::wolfLighting},
             {{.name = "-q3", .initial = "by game", .help = "Lights without spawnflags fall off with the square"},
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
    return {"Tone of lightmaps, vertices and the legacy grid",
            "The SH grid is linear and unclamped and takes none of these; the worldspawn key `_q3map2_tone` tells "
            "engines, which apply them. The order is: scale, contrast, gamma, "
            "exposure, saturation, brightness and compensate, `_maxlight` (the color keeps its hue), sRGB, cut to a "
            "byte.",
            {{{.name = "-contrast",
               .values = "F",
               .kind = SettingKind::Number,
               .initial = "0",
               .range = {-255, 255},
               .help = "Contrast around the middle gray 128"},
              Do<LightOptions>(contrast)},
             {{.name = "-gamma",
               .values = "F",
               .initial = "by game, usually 1",
               .range = {.low = 0, .aboveLow = true},
               .outside = OutOfRange::UseDefault,
               .outsideValue = 1,
               .help = "Gamma: the exponent is 1/F, so more than 1 brightens dark areas"},
              tone(&ToneOptions::gamma)},
             {{.name = "-exposure",
               .values = "F",
               .initial = "by game, usually 0 = off",
               .help = "Soft limit of bright light: 255 (1 − e^(−c / F)) of the largest channel"},
              tone(&ToneOptions::exposure)},
             {{.name = "-saturation", .values = "F", .help = "Color saturation; 0 is gray, more than 1 is vivid"},
              tone(&ToneOptions::saturation)},
             {{.name = "-compensate",
               .values = "F",
               .initial = "by game, usually 1",
               .range = {.low = 0, .aboveLow = true},
               .outside = OutOfRange::UseDefault,
               .outsideValue = 1,
               .help = "Divisor of stored light, for engines that multiply it again"},
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
    return {
        "Color spaces",
        "",
        {{{.name = "-sRGBlight",
           .initial = "by game, usually off",
           .help = "Store light in sRGB",
           .details = "The falloff tolerance becomes 0.077."},
          encode(kStoredLight, Transfer::SRgb)},
         {{.name = "-nosRGBlight", .help = "Store light linearly"}, encode(kStoredLight, Transfer::Linear)},
         {{.name = "-sRGBcolor",
           .initial = "by game, usually off",
           .help = "Colors of entities, suns and q3map_lightRGB are sRGB",
           .details = "Concerns both grids too."},
          encode(kGivenColors, Transfer::SRgb)},
         {{.name = "-nosRGBcolor", .help = "These colors are linear"}, encode(kGivenColors, Transfer::Linear)},
         {{.name = "-sRGBtex",
           .initial = "by game, usually off",
           .help = "Colors of images are sRGB where they tint bounced light"},
          encode(kTextures, Transfer::SRgb)},
         {{.name = "-nosRGBtex", .help = "These colors are linear"}, encode(kTextures, Transfer::Linear)},
         {{.name = "-sRGB", .help = "-sRGBlight, -sRGBcolor and -sRGBtex"}, encode(kAll, Transfer::SRgb)},
         {{.name = "-nosRGB", .help = "-nosRGBlight, -nosRGBcolor and -nosRGBtex"}, encode(kAll, Transfer::Linear)}}};
}

Group Speed() {
    return {"Speed and quality",
            "",
            {{{.name = "-fast",
               .help = "Quick draft: lights end where they get faint, and the SH grid takes few samples",
               .details =
                   "Area lights give nothing where they would give at most 1 of 255; for a part of a light that solids "
                   "cut, this tolerance is in proportion to its area. SH grid: `-shsamples` of 1/16. Bounced light "
                   "ends in the same way, on surfaces."},
              &LightOptions::fast},
             {{.name = "-fastgrid", .help = "-fast for both light grids only"}, &LightOptions::fastGrid},
             {{.name = "-faster",
               .help = "-fast, and area lights count as points",
               .details = "Not for the SH grid. In the legacy grid they then shine to all sides."},
              &LightOptions::faster},
             {{.name = "-cheap", .help = "Add no more light to vertices and legacy grid points that are white already"},
              &LightOptions::cheap},
             {{.name = "-cheapgrid", .help = "-cheap for the legacy grid only"}, &LightOptions::cheapGrid},
             {{.name = "-nogrid", .help = "Leave the legacy light grid as it is"}, &LightOptions::noGrid}}};
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
           .help = "No shadows",
           .details = "Suns shine everywhere. Floodlight, dirt and bounces still look around."},
          &LightOptions::noTrace},
         {{.name = "-areashadows",
           .values = "[N]",
           .kind = SettingKind::Integer,
           .unit = "rays",
           .initial = "off; 512 without N",
           .range = {1, kMaxAreaRays},
           .help = "Soft shadows of area lights on surfaces, by at most N rays from each luxel to each light",
           .details = "A lamp that is partly hidden gives a surface the light of the part that is seen, instead of all "
                      "or nothing by one ray to its middle. Most rays go to penumbrae, where N bounds the noise. Suns "
                      "with a deviance, skies, and lights with `_samples` take all of their samples only where some "
                      "are hidden; 2 to 63 samples become 64. Concerns lightmaps, vertices and static props, and what "
                      "they reflect; the SH grid always does so. `-samples` leaves such lights alone, since their "
                      "shadows have no hard edges. `-faster` turns it off. [lightmaps.md](lightmaps.md#soft-shadows)"},
          Do<LightOptions>(areaShadows)},
         {{.name = "-nosurf", .help = "Shadows of structural brushes only"}, &LightOptions::structuralShadowsOnly},
         {{.name = "-patchshadows",
           .initial = "by game, usually off",
           .help = "Curved surfaces cast shadows",
           .details = "Not in the legacy grid."},
          &LightOptions::patchShadows},
         {{.name = "-sunonly", .help = "Only suns and sky light shine"}, &LightOptions::sunOnly},
         {{.name = "-onesky", .help = "Suns shine through every sky, not only through that of their shader"},
          &LightOptions::oneSky},
         {{.name = "-style",
           .aliases = {"-styles"},
           .initial = "by game, usually on",
           .help = "Light styles (flickering and switchable lights) count",
           .details = "In lightmaps styled light needs a stage of its own, see "
                      "[lightmaps.md](lightmaps.md); vertices and grids cannot store it."},
          Off(&LightOptions::noStyles)},
         {{.name = "-nostyle", .aliases = {"-nostyles"}, .help = "Light styles do not count"}, &LightOptions::noStyles},
         {{.name = "-switchable",
           .help = "Lights with a targetname get light styles of their own, which the game can switch",
           .details = "As with the worldspawn key `_switchable`: "
                      "[from_source.md](from_source.md#switchable-and-animated-lights)."},
          &LightOptions::switchable},
         {{.name = "-floodlight",
           .help = "Add soft light wherever there is open space around",
           .details = "With the values of the worldspawn key `_floodlight`, or the color 0.94 0.94 1, distance "
                      "1024 and intensity 128."},
          &LightOptions::floodlight},
         {{.name = "-lowquality", .help = "Floodlight with 32 rays a hemisphere instead of 64"},
          &LightOptions::lowQuality},
         {{.name = "-custinfoparms",
           .help = "Read more surfaceparms from custinfoparms.txt, beside the shader scripts"},
          customInfoParms}}};
}

Group StaticProps() {
    return {"Static props",
            "Models that stay entities: [static_props.md](static_props.md).",
            {{{.name = "-staticproplighting",
               .help = "Light the vertices of static props, into the BSPX lump STATIC_PROP_LIGHT",
               .details = "Lit props also cast shadows, those of their boxes without `-staticproppolys`."},
              &LightOptions::staticPropLighting},
             {{.name = "-staticproppolys", .help = "Static props cast the shadows of their triangles"},
              &LightOptions::staticPropPolys},
             {{.name = "-textureshadows",
               .help = "Such triangles with masked textures let light through; needs -staticproppolys"},
              &LightOptions::textureShadows},
             {{.name = "-staticpropfiles",
               .help = "Write the light of static props to files beside the map too; needs -staticproplighting"},
              &LightOptions::staticPropFiles}}};
}

Group BotFiles() {
    return {
        "Bot file",
        "",
        {{{.name = "-fixaas",
           .help = "Make bot files beside the map fit the lit map",
           .details = "They name the map by a checksum of all bytes, so engines refuse them once it is lit. Without "
                      "this a warning tells so. See the stage of that name."},
          &LightOptions::fixBotFiles}}};
}

Group Explanations() {
    const auto point = [](LightOptions &o, const Values &v) {
        o.explain.push_back({float(v.numbers[0]), float(v.numbers[1]), float(v.numbers[2])});
    };
    return {
        "Explanations",
        "Why a place is lit as it is: [explain.md](explain.md). Nothing is baked and no file changes.",
        {{{.name = "-explain",
           .values = "X Y Z",
           .kind = SettingKind::Number,
           .unit = "game units",
           .initial = "none",
           .help = "Say which lights reach this point of a lit map, and what is in the way of the others",
           .details = "Give the options that the map was lit with. Also printed: the points of both light grids around "
                      "the point, where they take their light from, and the nearest luxel. More points if it is "
                      "repeated."},
          Do<LightOptions>(point)}}};
}

Group Ignored() {
    const auto nothing = [](std::string_view name, std::string_view help) {
        return WithoutEffect(&LightOptions::withoutEffect, name, help);
    };
    return {"Accepted without effect",
            "Options of the original q3map2 that choose what is always so here. A warning names them.",
            {nothing("-lomem", "Memory is always saved"),
             nothing("-fastallocate", "Lightmaps are always packed quickly; see -slowallocate"),
             nothing("-fastbounce", "Bounced light has no lamps that could end early; see -fast"),
             nothing("-nobouncestore", "The .bsp is always written once, after the last bounce"),
             nothing("-dump", "Bounced light has no lamps that could be written to a .map")}};
}

} // namespace

std::vector<SettingGroup<LightOptions>> LightOptionSettings() {
    return {GridSH(),   SparseGridSH(), QualityOfGridSH(), AmbientCubes(), Skips(), Intensities(),
            Falloff(),  Tone(),         ColorSpaces(),     Speed(),        Rays(),  StaticProps(),
            BotFiles(), Explanations(), Ignored()};
}

} // namespace q3
