// GPL-2.0-or-later. Settings of lightmaps, vertex light and bounces, declared once. Const after parsing.
#include "q3map2/lightmap/options/lightmap_options.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

constexpr int kMinPageSide = 2; ///< texels

/// The page size given by an option; none, with a warning, unless both sides are powers of two in range.
std::optional<std::array<int, 2>> PageSize(const std::vector<int> &given, std::string_view name, Log &log) {
    if (given.empty())
        return std::nullopt;
    const int w = given.front(), h = given.back();
    const auto fits = [](int side) {
        return side >= kMinPageSide && side <= kMaxPageSide && std::has_single_bit(unsigned(side));
    };
    if (fits(w) && fits(h))
        return std::array{w, h};
    log.Warn("page size", "{} {} {}: expected powers of two from {} to {}; the option is ignored", name, w, h,
             kMinPageSide, kMaxPageSide);
    return std::nullopt;
}

void ApplyPageSizes(LightmapOptions &o, Log &log) {
    bool external = false;
    if (const auto size = PageSize(o.lightmapSize, "-lightmapsize", log)) {
        o.pageSize = *size;
        external = o.pageSize != o.gamePageSize;
    }
    if (const auto size = PageSize(o.hackSize, "-extlmhacksize", log); size && !external)
        o.pageSize = *size;
    o.external |= external || !o.externalFolder.empty();
    if (o.searchPower) {
        const double ratio = o.gamePageSize[0] * std::exp2(*o.searchPower) / o.pageSize[0];
        o.searchBlock = int(std::clamp(ratio * ratio, 1.0, double(1 << 20)));
    }
    if (o.noSearch)
        o.searchBlock = 1;
}

} // namespace

void LightmapOptions::UsePageSize(int side) {
    const std::array<int, 2> size{side, side};
    if (pageSize == gamePageSize)
        pageSize = size;
    gamePageSize = size;
}

LightmapOptions ParseLightmapOptions(Arguments &arguments, const LightOptions &light, const Game &game, Log &log) {
    LightmapOptions o;
    o.fast = light.fast;
    o.faster = light.faster;
    o.cheap = light.cheap;
    o.sRgbTexture = light.sRgbTexture;
    o.halfLambert = game.halfLambert;
    o.deluxe = game.deluxe;
    o.deluxeTangent = game.deluxeTangent;
    o.pageSize = o.gamePageSize = {game.lightmapSize, game.lightmapSize};
    TakeSettings(LightmapSettings(), o, arguments, log);
    ApplyPageSizes(o, log);
    if (o.show != DebugView::Light || o.debugNormals)
        o.rnm = o.rnmAll = o.lightmass = false;
    const bool forEngines = o.hdrFiles == HdrFiles::Rend2 || o.hdrFiles == HdrFiles::Ioquake3;
    if (forEngines && !o.ldr) {
        log.Warn("HDR files", "engines load HDR files only together with 8-bit lightmaps, which are stored too");
        o.ldr = true;
    }
    o.shade |= o.shadeAngle > 0;
    o.deluxe |= o.debugDeluxe;
    if (o.deluxe && !o.ldr) {
        log.Warn("light directions", "pages of light directions belong to 8-bit lightmaps, which -hdr leaves out");
        o.deluxe = false;
    }
    o.dirty |= o.show == DebugView::Dirt;
    return o;
}

// ---- The options, their ranges and their help ----

namespace {

using Group = SettingGroup<LightmapOptions>;
using Values = SettingValues;

// Largest values of the options: limits of this program, chosen.
constexpr int kMaxSuper = 8, kMaxSamples = 64, kMaxExactSamples = 65536, kMaxBounces = 1000, kMaxBounceRays = 16384;
constexpr int kMaxSampleSize = 16384, kMaxSearchBlock = 1 << 20, kMaxSearchPower = 20;
constexpr SettingRange kPositive{.low = 0, .aboveLow = true}, kFraction{0, 1};

void TakeSamples(LightmapOptions &o, const Values &v) {
    const std::string &word = v.words.front();
    o.samplesExact = word.starts_with('+');
    const std::optional<int> samples = StrictInteger(word);
    if (!samples || *samples < 1 || *samples > (o.samplesExact ? kMaxExactSamples : kMaxSamples))
        throw Error("-samples {}: expected a whole number from 1 to {}, or + and a number of samples", word,
                    kMaxSamples);
    o.samples = *samples;
}

void TakeBounces(LightmapOptions &o, const Values &v) {
    const std::string &word = v.words.front();
    const std::optional<int> bounces = EqualNoCase(word, "inf") ? kEndlessBounces : StrictInteger(word);
    if (!bounces || *bounces < 0 || (*bounces > kMaxBounces && *bounces != kEndlessBounces))
        throw Error("-bounce {}: expected a whole number from 0 to {}, or inf", word, kMaxBounces);
    o.bounces = *bounces;
}

/// "W" or "W H" as two numbers.
SettingTarget<LightmapOptions> PageSize(std::vector<int> LightmapOptions::*field) {
    return Do<LightmapOptions>([field](LightmapOptions &o, const Values &v) {
        o.*field = {int(v.numbers.front()), int(v.numbers.back())};
    });
}

/// A choice of two words: the field is whether `on` is given.
SettingTarget<LightmapOptions> Choice(bool LightmapOptions::*field, std::string_view on = "1") {
    return Do<LightmapOptions>([field, on](LightmapOptions &o, const Values &v) { o.*field = v.words[0] == on; });
}

SettingTarget<LightmapOptions> Show(DebugView show) {
    return Do<LightmapOptions>([show](LightmapOptions &o, const Values &) { o.show = show; });
}

Group Samples() {
    return {
        "Lightmap samples",
        "[Lighting](../guide/lighting.md) shows what these options do, and [Lightmaps](../internals/lightmaps.md) how "
        "they work. The settings of a surface (luxel size, projection, shadow groups, ambient light) come from the "
        "`.srf` file that the bsp stage wrote next to the map. Without that file they are derived from the surface, "
        "its shader and its entity.",
        {{{.name = "-onlygrid",
           .help = "Lights the light grids only, and leaves lightmaps and vertex colors as they are",
           .since = "0.1.0"},
          &LightmapOptions::onlyGrid},
         {{.name = "-super",
           .aliases = {"-supersample"},
           .values = "N",
           .range = {1, kMaxSuper},
           .limitReason = "time and memory grow with N²; -samples refines only where light changes",
           .help = "Takes N × N samples in each luxel",
           .details = "Time and memory grow with N². The option `-samples` refines only where light changes.",
           .since = "q3map2",
           .example = "2"},
          &LightmapOptions::super},
         {{.name = "-samples",
           .values = "[+]N",
           .kind = SettingKind::Text,
           .initial = "1",
           .help = "Takes more samples where light changes, up to N levels of refinement (1 to 64)",
           .details = "Luxels are divided again and again where neighbors differ, so shadow edges get smoother. "
                      "With `-randomsamples`, a plus sign before N means exactly N samples.",
           .since = "q3map2",
           .example = "3"},
          Do<LightmapOptions>(TakeSamples)},
         {{.name = "-randomsamples",
           .help = "Takes random samples in each luxel instead of refining it",
           .details = "Their number is 16 for `-samples` 1 and 2, 64 for 3, 256 for 4, and N for other values.",
           .since = "q3map2"},
          &LightmapOptions::randomSamples},
         {{.name = "-samplessearchboxsize",
           .values = "N",
           .unit = "luxels",
           .range = {1, kMaxSearchBox},
           .help = "Sets how far around a luxel -samples looks for differences",
           .since = "q3map2",
           .example = "2"},
          &LightmapOptions::samplesSearchBox},
         {{.name = "-filter", .help = "Blurs the light of each light source by one luxel", .since = "q3map2"},
          &LightmapOptions::filter},
         {{.name = "-thresh",
           .values = "F",
           .unit = "luxels",
           .range = {.low = 0},
           .outside = OutOfRange::UseDefault,
           .outsideValue = 1,
           .help = "Sets how finely curved and bumpy triangles are divided to find the positions of luxels",
           .details = "Concerns curves, smooth shading and normal maps. The finest division is 1/32.",
           .since = "q3map2",
           .example = "0.5"},
          &LightmapOptions::threshold}}};
}

Group LuxelSize() {
    return {"Luxel size",
            "",
            {{{.name = "-samplesize",
               .values = "N",
               .unit = "game units",
               .range = {1, kMaxSampleSize},
               .help = "Sets the luxel size of a map without a .srf file",
               .details = "With that file, the luxel size is the one from the bsp stage, and a warning says so. Use "
                          "[-samplesize](bsp.md#-samplesize) of that stage.",
               .since = "q3map2",
               .example = "8"},
              &LightmapOptions::sampleSize},
             {{.name = "-minsamplesize",
               .values = "N",
               .unit = "game units",
               .initial = "none",
               .range = {1, kMaxSampleSize},
               .help = "Sets the smallest luxel size that shaders and entities can have, in a map without a .srf file",
               .since = "q3map2",
               .example = "4"},
              &LightmapOptions::minSampleSize},
             {{.name = "-samplescale",
               .values = "N",
               .range = {0, kMaxSampleSize},
               .help = "Multiplies the luxel size of every surface, so that 2 halves the resolution",
               .details = "A value of 0 turns it off.",
               .since = "q3map2",
               .example = "2"},
              &LightmapOptions::sampleScale},
             {{.name = "-rawlightmapsizelimit",
               .values = "N",
               .unit = "luxels",
               .range = {0, kMaxPageSide},
               .help = "Limits the longer side of the lightmap of each surface",
               .details = "The luxels of larger surfaces grow until they fit. A value of 0 turns it off.",
               .since = "q3map2",
               .example = "256"},
              &LightmapOptions::rawSizeLimit}}};
}

Group Normals() {
    return {"Normals and positions",
            "",
            {{{.name = "-shade",
               .help = "Smooths vertex normals across edges of shaders with q3map_shadeAngle",
               .since = "q3map2"},
              &LightmapOptions::shade},
             {{.name = "-shadeangle",
               .values = "F",
               .unit = "degrees",
               .range = {0, 360},
               .help = "Sets the angle up to which edges are smooth, for shaders without one of their own",
               .details = "A value over 0 implies `-shade`.",
               .since = "q3map2",
               .example = "60"},
              &LightmapOptions::shadeAngle},
             {{.name = "-lightanglehl",
               .values = "0|1",
               .kind = SettingKind::Choice,
               .initial = "by game, usually 0",
               .help = "Selects half-Lambert lighting, where light falls off more softly with its angle to the surface",
               .details = "With 1, the factor is the square of (a + 1) / 2 instead of the cosine a.",
               .since = "q3map2",
               .example = "1"},
              Choice(&LightmapOptions::halfLambert)},
             {{.name = "-nofastpoint",
               .help = "Lets light entities reach on where their light gets faint, instead of cutting it off",
               .details = "Has no effect with `-fast`.",
               .since = "q3map2"},
              Off(&LightmapOptions::fastPoint)},
             {{.name = "-dark",
               .help = "Leaves luxels inside walls where they are, so that seams stay dark",
               .since = "q3map2"},
              &LightmapOptions::dark},
             {{.name = "-trianglecheck", .help = "Moves the positions of luxels into triangles", .since = "q3map2"},
              &LightmapOptions::triangleCheck},
             {{.name = "-extravisnudge",
               .help = "Tests the positions of luxels one game unit in front of the surface",
               .since = "q3map2"},
              &LightmapOptions::extraVisNudge}}};
}

Group Dirt() {
    const LightmapOptions initial;
    const auto positive = [](std::string_view name, double outside, std::string_view help, std::string_view example) {
        return SettingInfo{.name = name,
                           .values = "F",
                           .range = kPositive,
                           .outside = OutOfRange::UseDefault,
                           .outsideValue = outside,
                           .help = help,
                           .since = "q3map2",
                           .example = example};
    };
    SettingInfo depth =
        positive("-dirtdepth", initial.dirtDepth, "Sets how far geometry darkens its surroundings", "64");
    depth.unit = "game units";
    SettingInfo gain = positive("-dirtgain", initial.dirtGain, "Sets the exponent of dirt", "0.8");
    gain.details = "More than 1 leaves half-open areas lighter.";
    return {
        "Dirt (ambient occlusion)",
        "With o the mean occlusion over all directions, dirt takes away the fraction min(1, dirtscale o^dirtgain) of "
        "all light.",
        {{{.name = "-dirty",
           .help = "Darkens corners and crevices, where nearby geometry blocks the surroundings",
           .since = "q3map2"},
          &LightmapOptions::dirty},
         {depth, &LightmapOptions::dirtDepth},
         {positive("-dirtscale", initial.dirtScale, "Sets the strength of dirt", "0.8"), &LightmapOptions::dirtScale},
         {gain, &LightmapOptions::dirtGain},
         {{.name = "-dirtmode",
           .values = "0|1",
           .kind = SettingKind::Choice,
           .initial = "0",
           .outside = OutOfRange::UseDefault,
           .help = "Selects 48 regular directions for dirt (0), or random ones (1)",
           .since = "q3map2",
           .example = "1"},
          Choice(&LightmapOptions::dirtRandom)}}};
}

Group Bounces() {
    const auto scale = [](LightmapOptions &o, const Values &v) {
        o.bounceScale = float(std::clamp(o.bounceScale * v.numbers[0], -kMaxSetting, kMaxSetting));
    };
    return {
        "Bounced light (radiosity)",
        "",
        {{{.name = "-bounce",
           .values = "N|inf",
           .kind = SettingKind::Text,
           .initial = "0",
           .help = "Sets how often light bounces off surfaces (0 to 1000)",
           .details = "Bouncing ends earlier if all further bounces together would give at most a quarter of an 8-bit "
                      "level anywhere, and an estimate of them is added. With `inf`, it ends only then. More than one "
                      "bounce costs little, because all bounces use the rays of the first one.",
           .since = "q3map2",
           .example = "8"},
          Do<LightmapOptions>(TakeBounces)},
         {{.name = "-bouncetime",
           .values = "S",
           .unit = "seconds",
           .initial = "no limit",
           .range = {.low = 0, .aboveLow = true},
           .help = "Ends the bounces of each light style after this time",
           .details = "The result is valid but lacks the later bounces, and it depends on the speed of the machine.",
           .since = "0.2.0",
           .example = "60"},
          &LightmapOptions::bounceTime},
         {{.name = "-bouncerays",
           .values = "N",
           .initial = "64, or 24 with -fast",
           .range = {4, kMaxBounceRays},
           .help = "Sets how many rays gather bounced light at a luxel",
           .details =
               "The error falls roughly as 1/√N. Vertices trace 4 N rays, and points of the light grids 3 N / 2.",
           .since = "0.2.0",
           .example = "256"},
          &LightmapOptions::bounceRays},
         {{.name = "-reflectivity",
           .values = "legacy|linear",
           .kind = SettingKind::Choice,
           .initial = "legacy",
           .help = "Selects how much light textures reflect",
           .details = "With `legacy` it is 0.55 of their color, as in NetRadiant's q3map2. With `linear` it is their "
                      "color after conversion from sRGB to linear light, which is physically right for the usual "
                      "textures, and as in VRAD. No surface reflects more than 0.99.",
           .since = "0.2.0",
           .example = "linear"},
          Choice(&LightmapOptions::linearReflectance, "linear")},
         {{.name = "-bouncegrid",
           .help = "Lights the light grids and ambient cubes with bounced light too",
           .details = "With `-onlygrid`, surfaces are lit to compute it but not stored, which takes as long as a full "
                      "run. Has no effect without `-bounce`.",
           .since = "q3map2"},
          &LightmapOptions::bounceGrid},
         {{.name = "-bounceonly",
           .help = "Stores bounced light only, without direct light",
           .details = "Has no effect without `-bounce`.",
           .since = "q3map2"},
          &LightmapOptions::bounceOnly},
         {{.name = "-bouncescale",
           .values = "F",
           .kind = SettingKind::Number,
           .initial = "1",
           .help = "Multiplies bounced light",
           .details = "F multiplies a built-in factor of 0.25. At 1, a white wall reflects 0.55 of the light that it "
                      "receives. If the option is repeated, it multiplies again.",
           .since = "q3map2",
           .example = "1.5"},
          Do<LightmapOptions>(scale)},
         {{.name = "-bouncecolorratio",
           .values = "F",
           .range = kFraction,
           .help = "Sets how much bounced light takes the color of the texture (1) or the gray of that color (0)",
           .since = "q3map2",
           .example = "0.5"},
          &LightmapOptions::bounceColorRatio}}};
}

Group Vertices() {
    const auto noVertex = [](LightmapOptions &o, const Values &v) {
        o.noVertex = v.numbers.empty() ? 1 : float(v.numbers[0]);
    };
    return {
        "Vertex light",
        "",
        {{{.name = "-vertexscale",
           .values = "F",
           .help = "Multiplies vertex light",
           .details = "The shader directive `q3map_vertexScale` multiplies it again.",
           .since = "q3map2",
           .example = "1.5"},
          &LightmapOptions::vertexScale},
         {{.name = "-novertex",
           .values = "[F]",
           .kind = SettingKind::Number,
           .initial = "off; 1 without F",
           .range = {0, 1, true},
           .help = "Gives all vertices the same light, F times 127.5 in 8-bit levels",
           .since = "q3map2",
           .example = "0.5"},
          Do<LightmapOptions>(noVertex)},
         {{.name = "-cpma",
           .help = "Lights the vertices of surfaces with lightmaps separately, without shadows",
           .details = "It is meant for games that can show vertex light instead of lightmaps. Otherwise these "
                      "vertices take the light of the nearest luxels.",
           .since = "q3map2"},
          &LightmapOptions::cpma},
         {{.name = "-nolm", .help = "Makes no lightmaps, and lights all surfaces at their vertices", .since = "q3map2"},
          &LightmapOptions::noLightmaps}}};
}

Group Pages() {
    return {
        "Lightmap pages",
        "Lightmaps are packed into pages in the `.bsp`, which are 128 × 128 luxels large (512 in some games). Shaders "
        "with `q3map_lightmapSize` have pages of their own.",
        {{{.name = "-lightmapsize",
           .values = "W [H]",
           .kind = SettingKind::Integer,
           .unit = "luxels",
           .initial = "by game, usually 128",
           .help = "Sets the size of lightmap pages, for engines that load lightmaps from images",
           .details = "W and H are powers of two from 2 to 8192. With other numbers, a warning says that the size of "
                      "the game is used. Pages of another size than that of the game are written as images "
                      "`x/lm_NNNN.tga` next to `x.bsp`, which then holds no pages.",
           .since = "q3map2",
           .example = "512"},
          PageSize(&LightmapOptions::lightmapSize)},
         {{.name = "-external",
           .help = "Writes pages as images next to the map, even if they have the size of the game",
           .since = "q3map2"},
          &LightmapOptions::external},
         {{.name = "-lightmapdir",
           .values = "DIR",
           .initial = "maps/x",
           .help = "Sets the folder for the images of pages",
           .details = "Implies `-external`. Shaders still name `maps/x/`.",
           .since = "q3map2",
           .example = "lightmaps"},
          &LightmapOptions::externalFolder},
         {{.name = "-extlmhacksize",
           .values = "W [H]",
           .kind = SettingKind::Integer,
           .unit = "luxels",
           .initial = "off",
           .help = "Sets the size of lightmap pages, for engines that do not load lightmaps from images",
           .details = "W and H are powers of two from 2 to 8192. The pages are images `x/lm_NNNN.tga`, and generated "
                      "shaders show them.",
           .since = "q3map2",
           .example = "1024"},
          PageSize(&LightmapOptions::hackSize)}}};
}

Group Storing() {
    return {
        "Stored lightmaps",
        "",
        {{{.name = "-deluxe",
           .aliases = {"-deluxemap"},
           .initial = "by game, usually off",
           .help = "Stores a page of light directions after each lightmap page, for bump mapping",
           .details = "Is turned off by `-hdr`, with a warning, because these pages belong to 8-bit lightmaps. "
                      "[HDR and normal maps](../guide/hdr_and_normal_maps.md) shows how to use them.",
           .since = "q3map2"},
          &LightmapOptions::deluxe},
         {{.name = "-nodeluxe", .aliases = {"-nodeluxemap"}, .help = "Stores no light directions", .since = "q3map2"},
          Off(&LightmapOptions::deluxe)},
         {{.name = "-deluxemode",
           .values = "0|1",
           .kind = SettingKind::Choice,
           .initial = "by game, usually 0",
           .outside = OutOfRange::UseDefault,
           .help = "Selects whether light directions are in model space (0) or in tangent space (1)",
           .since = "q3map2",
           .example = "1"},
          Choice(&LightmapOptions::deluxeTangent)},
         {{.name = "-brightness",
           .values = "F",
           .range = kPositive,
           .outside = OutOfRange::UseDefault,
           .outsideValue = 1,
           .help = "Multiplies the light of lightmaps",
           .details = "The shader directive `q3map_lightmapBrightness` multiplies it again.",
           .since = "q3map2",
           .example = "1.2"},
          &LightmapOptions::brightness},
         {{.name = "-macrotexture",
           .values = "IMAGE",
           .initial = "the worldspawn key `_macrotexture`",
           .help = "Tints lightmaps and vertex light by an image over the whole world, seen from above",
           .details = "[Coming from Source](../guide/from_source_engine.md) explains how it is placed.",
           .since = "0.2.0",
           .example = "textures/macro/city"},
          &LightmapOptions::macroTexture},
         {{.name = "-approx",
           .values = "N",
           .unit = "8-bit levels",
           .range = {.low = 0},
           .help = "Drops lightmaps that vertex light matches within N, which makes the file smaller",
           .details = "Surfaces that are up to two luxels large lose their lightmaps too. A value of 0 turns it off.",
           .since = "q3map2",
           .example = "4"},
          &LightmapOptions::approximate}}};
}

Group Encodings() {
    const auto hdrOnly = [](LightmapOptions &o, const Values &) { o.ldr = false, o.hdr = true; };
    const auto both = [](LightmapOptions &o, const Values &) { o.ldr = o.hdr = true; };
    const auto files = [](LightmapOptions &o, const Values &v) {
        // In the order of HdrFiles after None.
        constexpr std::array<std::string_view, 4> kWords = {"rend2", "ioquake3", "exr", "pfm"};
        const auto found = std::find(kWords.begin(), kWords.end(), v.words[0]);
        o.hdrFiles = HdrFiles(1 + (found - kWords.begin()));
        o.hdr = true;
    };
    const auto ldr = [](LightmapOptions &o, const Values &) {
        o.ldr = true, o.hdr = false;
        o.hdrFiles = HdrFiles::None;
    };
    const auto rnmAll = [](LightmapOptions &o, const Values &) { o.rnm = o.rnmAll = true; };
    const auto skyOcclusion = [](LightmapOptions &o, const Values &) { o.lightmass = o.skyOcclusion = true; };
    const auto shadowMap = [](LightmapOptions &o, const Values &v) {
        const std::string &name = v.words[0];
        if (name.empty() || name.find_first_of("/\\:*?\"<>|") != std::string::npos)
            throw Error("-shadowmap {}: names an image file, expected a targetname without / \\ : * ? \" < > |", name);
        o.lightmass = true;
        if (std::find(o.shadowMaps.begin(), o.shadowMaps.end(), name) == o.shadowMaps.end())
            o.shadowMaps.push_back(name);
    };
    const auto storage = [](LightmapOptions &o, const Values &v) { o.rnmRescaled = v.words[0] == "rescaled"; };
    return {
        "Range and direction of light",
        "These options store more than 8 bits of light, or the directions that it comes from. [HDR and normal "
        "maps](../guide/hdr_and_normal_maps.md) shows how to bake them, and [Directional "
        "lightmaps](../engines/directional.md) describes the encodings.",
        {{{.name = "-hdr",
           .help = "Stores HDR lightmaps and vertex light in BSPX lumps, instead of 8-bit lightmaps",
           .details =
               "Engines without support for these lumps show the map without lightmaps. Is overridden by `-both`.",
           .since = "VRAD"},
          Do<LightmapOptions>(hdrOnly)},
         {{.name = "-both",
           .help = "Stores 8-bit and HDR lightmaps, so that the map runs in every engine",
           .since = "VRAD"},
          Do<LightmapOptions>(both)},
         {{.name = "-hdrfiles",
           .values = "rend2|ioquake3|exr|pfm",
           .kind = SettingKind::Choice,
           .initial = "none",
           .help = "Also writes HDR pages as image files x/lm_NNNN",
           .details = "Implies `-both`. With `rend2` for OpenJK, and `ioquake3` for ioquake3 and Quake3e, "
                      "`x/vertlight.raw` is written too. The formats `exr` and `pfm` are for image tools, and can be "
                      "combined with `-hdr`.",
           .since = "0.2.0",
           .example = "rend2"},
          Do<LightmapOptions>(files)},
         {{.name = "-ldr",
           .help = "Stores 8-bit lightmaps only, as without any option",
           .details = "Overrides `-hdr`, `-both` and `-hdrfiles`.",
           .since = "VRAD"},
          Do<LightmapOptions>(ldr)},
         {{.name = "-rnm",
           .help = "Stores light for three basis normals of normal mapped surfaces (radiosity normal mapping)",
           .details =
               "The shader directives `q3map_rnm` and `q3map_noRnm` decide for a shader. Without them, a surface is "
               "normal mapped if its shader names a normal map, or if an image `NAME_n`, `NAME_norm` or `NAME_local` "
               "exists next to its image. Writes the worldspawn key `_q3map2_rnm`.",
           .since = "0.2.0"},
          &LightmapOptions::rnm},
         {{.name = "-rnmall",
           .help = "Stores light for three basis normals of all surfaces with lightmaps",
           .details = "Implies `-rnm`, and ignores `q3map_noRnm`.",
           .since = "0.2.0"},
          Do<LightmapOptions>(rnmAll)},
         {{.name = "-rnmstorage",
           .values = "raw|rescaled",
           .kind = SettingKind::Choice,
           .initial = "rescaled",
           .help = "Selects how the maps of -rnm are stored",
           .details = "With `raw` they hold the light itself. With `rescaled` they are scaled so that the mean of the "
                      "three maps is the flat lightmap.",
           .since = "0.2.0",
           .example = "raw"},
          Do<LightmapOptions>(storage)},
         {{.name = "-lightmass",
           .help = "Also writes L1 SH lightmaps in the layout of Unreal's Lightmass, as images with a JSON file",
           .since = "0.2.0"},
          &LightmapOptions::lightmass},
         {{.name = "-skyocclusion",
           .help = "Also writes how much of the sky each luxel sees, and in which direction",
           .details = "Implies `-lightmass`.",
           .since = "0.2.0"},
          Do<LightmapOptions>(skyOcclusion)},
         {{.name = "-shadowmap",
           .values = "LIGHT",
           .kind = SettingKind::Text,
           .initial = "none",
           .help = "Also writes the visibility of the lights whose targetname is LIGHT",
           .details = "Implies `-lightmass`. Repeat the option for more names. The image is named after LIGHT.",
           .since = "0.2.0",
           .example = "lamp1"},
          Do<LightmapOptions>(shadowMap)}}};
}

Group Packing() {
    return {
        "Packing",
        "",
        {{{.name = "-nocollapse",
           .help = "Stores lightmaps separately even if they have a single color or are equal",
           .details = "Light styles have the same effect.",
           .since = "q3map2"},
          Off(&LightmapOptions::collapse)},
         {{.name = "-slowallocate",
           .help = "Packs lightmaps tightly by trying every position on every page",
           .since = "q3map2"},
          Off(&LightmapOptions::fastAllocate)},
         {{.name = "-lightmapsearchblocksize",
           .values = "N",
           .unit = "pages",
           .range = {0, kMaxSearchBlock},
           .help = "Searches for room in blocks of N pages",
           .details = "A value of 0 searches all pages.",
           .since = "q3map2",
           .example = "4"},
          &LightmapOptions::searchBlock},
         {{.name = "-lightmapsearchpower",
           .values = "N",
           .initial = "off",
           .range = {-kMaxSearchPower, kMaxSearchPower},
           .help = "Searches for room in blocks of pages, whose size follows from that of the pages",
           .details = "A block has the area of a page with 2^N times the side of the game's pages. Overrides "
                      "`-lightmapsearchblocksize`.",
           .since = "q3map2",
           .example = "3"},
          &LightmapOptions::searchPower},
         {{.name = "-nolightmapsearch",
           .help = "Searches for room on the last page only",
           .details = "Overrides `-lightmapsearchblocksize` and `-lightmapsearchpower`.",
           .since = "q3map2"},
          &LightmapOptions::noSearch},
         {{.name = "-fill", .help = "Fills unused texels of pages with the mean of their neighbors", .since = "q3map2"},
          &LightmapOptions::fill},
         {{.name = "-export",
           .help = "Also writes the pages as images x/lightmap_NNNN.tga",
           .details = "Has no effect with `-external`.",
           .since = "q3map2"},
          &LightmapOptions::exportPages},
         {{.name = "-trisoup", .help = "Stores flat surfaces as triangle soups without lightmaps", .since = "q3map2"},
          &LightmapOptions::triangleSoup}}};
}

Group Debugging() {
    return {
        "For debugging",
        "Lightmaps show these things instead of light.",
        {{{.name = "-debug",
           .help = "Marks luxels without a surface (orange), without a free position (violet) and filled ones (blue)",
           .since = "q3map2"},
          &LightmapOptions::debug},
         {{.name = "-border", .help = "Draws the border of each lightmap in red", .since = "q3map2"},
          &LightmapOptions::border},
         {{.name = "-fillpink", .help = "Draws unused texels in pink", .since = "q3map2"}, &LightmapOptions::fillPink},
         {{.name = "-debugsurfaces",
           .aliases = {"-debugsurface"},
           .help = "Gives each surface a color of its own",
           .since = "q3map2"},
          Show(DebugView::Surfaces)},
         {{.name = "-debugaxis", .help = "Shows the axis along which lightmaps are projected", .since = "q3map2"},
          Show(DebugView::Axis)},
         {{.name = "-debugcluster", .help = "Shows the visibility cluster of each luxel", .since = "q3map2"},
          Show(DebugView::Cluster)},
         {{.name = "-debugorigin", .help = "Shows the position of each luxel", .since = "q3map2"},
          Show(DebugView::Origin)},
         {{.name = "-dirtdebug",
           .aliases = {"-debugdirt"},
           .help = "Shows dirt",
           .details = "Implies `-dirty`.",
           .since = "q3map2"},
          Show(DebugView::Dirt)},
         {{.name = "-normalmap", .help = "Shows normals as a normal map does", .since = "q3map2"},
          Show(DebugView::NormalMap)},
         {{.name = "-debugnormals", .help = "Shows the normals of luxels", .since = "q3map2"},
          &LightmapOptions::debugNormals},
         {{.name = "-debugdeluxe",
           .help = "Shows light directions",
           .details = "Implies `-deluxe`.",
           .since = "q3map2"},
          &LightmapOptions::debugDeluxe},
         {{.name = "-debugsamplesize",
           .help = "Prints every surface whose luxels had to grow to fit a page",
           .since = "q3map2"},
          &LightmapOptions::debugSampleSize}}};
}

} // namespace

std::vector<SettingGroup<LightmapOptions>> LightmapSettings() {
    return {Samples(), LuxelSize(), Normals(),   Dirt(),    Bounces(),  Vertices(),
            Pages(),   Storing(),   Encodings(), Packing(), Debugging()};
}

} // namespace q3
