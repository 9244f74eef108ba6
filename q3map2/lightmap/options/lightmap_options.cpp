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
        log.Warn("HDR files", "engines load HDR files beside 8-bit lightmaps only, which are stored too");
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
        "How lightmaps are made, and what shaders say about them, is in [lightmaps.md](lightmaps.md). The settings "
        "of a surface (luxel size, projection, shadow groups, ambient light) come from the `.srf` that the bsp "
        "stage left beside the map. Without one they are derived from the surface, its shader and its entity.",
        {{{.name = "-onlygrid", .help = "Light the grids only; lightmaps and vertex colors stay as they are"},
          &LightmapOptions::onlyGrid},
         {{.name = "-super",
           .aliases = {"-supersample"},
           .values = "N",
           .range = {1, kMaxSuper},
           .limitReason = "time and memory grow with N²; -samples refines only where light changes",
           .help = "Take N × N samples in each luxel"},
          &LightmapOptions::super},
         {{.name = "-samples",
           .values = "[+]N",
           .kind = SettingKind::Text,
           .initial = "1",
           .help = "Take more samples where light changes; N from 1 to 64, more is finer",
           .details = "Luxels are halved again and again where neighbors differ. `+N` with `-randomsamples`: "
                      "exactly N samples."},
          Do<LightmapOptions>(TakeSamples)},
         {{.name = "-randomsamples",
           .help = "Take random samples in each luxel instead",
           .details = "16 for `-samples` 1 and 2, 64 for 3, 256 for 4, else N."},
          &LightmapOptions::randomSamples},
         {{.name = "-samplessearchboxsize",
           .values = "N",
           .unit = "luxels",
           .range = {1, kMaxSearchBox},
           .help = "How far around a luxel -samples looks for differences"},
          &LightmapOptions::samplesSearchBox},
         {{.name = "-filter", .help = "Blur the light of each light source by one luxel"}, &LightmapOptions::filter},
         {{.name = "-thresh",
           .values = "F",
           .unit = "luxels",
           .range = {.low = 0},
           .outside = OutOfRange::UseDefault,
           .outsideValue = 1,
           .help = "How finely curved and bumpy triangles are divided to find luxel positions",
           .details = "Concerns curves, smooth shading and normal maps; at finest 1/32."},
          &LightmapOptions::threshold}}};
}

Group LuxelSize() {
    return {"Luxel size",
            "",
            {{{.name = "-samplesize",
               .values = "N",
               .unit = "game units",
               .range = {1, kMaxSampleSize},
               .help = "Luxel size of a map without .srf; otherwise -samplesize of the bsp stage counts"},
              &LightmapOptions::sampleSize},
             {{.name = "-minsamplesize",
               .values = "N",
               .unit = "game units",
               .initial = "none",
               .range = {1, kMaxSampleSize},
               .help = "Smallest luxel size that shaders and entities may ask for, in a map without .srf"},
              &LightmapOptions::minSampleSize},
             {{.name = "-samplescale",
               .values = "N",
               .range = {0, kMaxSampleSize},
               .help = "Multiply the luxel size of every surface: 2 halves the resolution; 0 turns it off"},
              &LightmapOptions::sampleScale},
             {{.name = "-rawlightmapsizelimit",
               .values = "N",
               .unit = "luxels",
               .range = {0, kMaxPageSide},
               .help = "Longest side of a surface's lightmap; 0 turns it off"},
              &LightmapOptions::rawSizeLimit}}};
}

Group Normals() {
    return {
        "Normals and positions",
        "",
        {{{.name = "-shade", .help = "Smooth vertex normals across edges, as q3map_shadeAngle of shaders says"},
          &LightmapOptions::shade},
         {{.name = "-shadeangle",
           .values = "F",
           .unit = "degrees",
           .range = {0, 360},
           .help = "Smoothing angle for shaders that name none; over 0 includes -shade"},
          &LightmapOptions::shadeAngle},
         {{.name = "-lightanglehl",
           .values = "0|1",
           .kind = SettingKind::Choice,
           .initial = "by game, usually 0",
           .help = "1: half-Lambert, light falls off more softly with its angle to the surface",
           .details = "The factor is the square of (a + 1) / 2 in place of the cosine a."},
          Choice(&LightmapOptions::halfLambert)},
         {{.name = "-nofastpoint", .help = "Do not cut off light entities where they get faint; no effect with -fast"},
          Off(&LightmapOptions::fastPoint)},
         {{.name = "-dark", .help = "Do not move luxels out of walls: seams stay dark"}, &LightmapOptions::dark},
         {{.name = "-trianglecheck", .help = "Use only luxel positions inside triangles"},
          &LightmapOptions::triangleCheck},
         {{.name = "-extravisnudge", .help = "Test luxel positions one game unit in front of the surface"},
          &LightmapOptions::extraVisNudge}}};
}

Group Dirt() {
    const auto positive = [](std::string_view name, std::string_view unit, double initial, std::string_view help) {
        return SettingInfo{.name = name,
                           .values = "F",
                           .unit = unit,
                           .range = kPositive,
                           .outside = OutOfRange::UseDefault,
                           .outsideValue = initial,
                           .help = help};
    };
    const LightmapOptions initial;
    return {
        "Dirt (ambient occlusion)",
        "",
        {{{.name = "-dirty", .help = "Darken corners and crevices, by how much of the surroundings is near"},
          &LightmapOptions::dirty},
         {positive("-dirtdepth", "game units", initial.dirtDepth, "Distance within which surroundings darken"),
          &LightmapOptions::dirtDepth},
         {positive("-dirtscale", "", initial.dirtScale, "Strength of the darkening"), &LightmapOptions::dirtScale},
         {positive("-dirtgain", "", initial.dirtGain, "Exponent of the darkening; more leaves half-open areas lighter"),
          &LightmapOptions::dirtGain},
         {{.name = "-dirtmode",
           .values = "0|1",
           .kind = SettingKind::Choice,
           .initial = "0",
           .outside = OutOfRange::UseDefault,
           .help = "0: 48 regular directions; 1: random directions"},
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
           .help = "How often light bounces off surfaces",
           .details =
               "Ends earlier when all bounces to come would give little light, at most a quarter of a byte anywhere, "
               "and adds an "
               "estimate of them; `inf` ends only then. More than 1 costs little: the rays are those of the first "
               "bounce."},
          Do<LightmapOptions>(TakeBounces)},
         {{.name = "-bouncetime",
           .values = "S",
           .unit = "seconds",
           .initial = "no limit",
           .range = {.low = 0, .aboveLow = true},
           .help = "Ends the bounces of each light style after this time; the result lacks the later ones"},
          &LightmapOptions::bounceTime},
         {{.name = "-bouncerays",
           .values = "N",
           .initial = "64, 24 with -fast",
           .range = {4, kMaxBounceRays},
           .help = "Rays that gather bounced light at a luxel; the error falls with about the root of N",
           .details = "Vertices trace 4 N, points of the light grids 3 N / 2."},
          &LightmapOptions::bounceRays},
         {{.name = "-reflectivity",
           .values = "legacy|linear",
           .kind = SettingKind::Choice,
           .initial = "legacy",
           .help = "What textures reflect: 0.55 of their color, or all of it after conversion from sRGB",
           .details = "`legacy` follows the established program. `linear` is physical for textures of the usual sRGB "
                      "encoding; so reflects VRAD. Nothing reflects more than 0.99."},
          Choice(&LightmapOptions::linearReflectance, "linear")},
         {{.name = "-bouncegrid",
           .help = "Bounced light reaches the light grids too",
           .details = "With `-onlygrid` surfaces are lit for it too, in the time of a full run, but not stored."},
          &LightmapOptions::bounceGrid},
         {{.name = "-bounceonly",
           .help = "Store bounced light only, without direct light",
           .details = "Has no effect without `-bounce`."},
          &LightmapOptions::bounceOnly},
         {{.name = "-bouncescale",
           .values = "F",
           .kind = SettingKind::Number,
           .initial = "1",
           .help = "Factor of bounced light; repeated ones multiply",
           .details =
               "F multiplies a built-in factor of 0.25. At F = 1 a white wall reflects 0.55 of the light it gets."},
          Do<LightmapOptions>(scale)},
         {{.name = "-bouncecolorratio",
           .values = "F",
           .range = kFraction,
           .help = "1: bounced light takes the color of the texture; 0: its gray"},
          &LightmapOptions::bounceColorRatio}}};
}

Group Vertices() {
    const auto noVertex = [](LightmapOptions &o, const Values &v) {
        o.noVertex = v.numbers.empty() ? 1 : float(v.numbers[0]);
    };
    return {"Vertex light",
            "",
            {{{.name = "-vertexscale",
               .values = "F",
               .help = "Factor of vertex light",
               .details = "The shader directive `q3map_vertexScale` multiplies it."},
              &LightmapOptions::vertexScale},
             {{.name = "-novertex",
               .values = "[F]",
               .kind = SettingKind::Number,
               .initial = "off; 1 without F",
               .range = {0, 1, true},
               .help = "Give all vertices the same light: F times 127.5"},
              Do<LightmapOptions>(noVertex)},
             {{.name = "-cpma",
               .help = "Light vertices of surfaces with lightmaps separately, without shadows",
               .details = "For games that show vertex light on demand."},
              &LightmapOptions::cpma},
             {{.name = "-nolm", .help = "Make no lightmaps: light everything at its vertices"},
              &LightmapOptions::noLightmaps}}};
}

Group Pages() {
    return {
        "Lightmap pages",
        "Lightmaps are packed into pages of 128 × 128 (512 in some games) in the file. Shaders with "
        "`q3map_lightmapSize` have pages of their own.",
        {{{.name = "-lightmapsize",
           .values = "W [H]",
           .kind = SettingKind::Integer,
           .unit = "luxels",
           .initial = "by game, usually 128",
           .help = "Page size, powers of two from 2 to 8192",
           .details = "Pages of another size than the game's are images `x/lm_NNNN.tga` beside `x.bsp`, and the "
                      "file has none. With other numbers a warning says that the game's size is used."},
          PageSize(&LightmapOptions::lightmapSize)},
         {{.name = "-external", .help = "Write pages of the game's size as images too"}, &LightmapOptions::external},
         {{.name = "-lightmapdir",
           .values = "DIR",
           .initial = "maps/x",
           .help = "Folder for the images; includes -external",
           .details = "Shaders still name `maps/x/`."},
          &LightmapOptions::externalFolder},
         {{.name = "-extlmhacksize",
           .values = "W [H]",
           .kind = SettingKind::Integer,
           .unit = "luxels",
           .initial = "off",
           .help = "Larger pages for engines without external lightmaps, by generated shaders"},
          PageSize(&LightmapOptions::hackSize)}}};
}

Group Storing() {
    return {"Stored lightmaps",
            "",
            {{{.name = "-deluxe",
               .aliases = {"-deluxemap"},
               .initial = "by game, usually off",
               .help = "Store a page of light directions after each page, for bump mapping"},
              &LightmapOptions::deluxe},
             {{.name = "-nodeluxe", .aliases = {"-nodeluxemap"}, .help = "Store no light directions"},
              Off(&LightmapOptions::deluxe)},
             {{.name = "-deluxemode",
               .values = "0|1",
               .kind = SettingKind::Choice,
               .initial = "by game, usually 0",
               .outside = OutOfRange::UseDefault,
               .help = "Light directions in model space (0) or tangent space (1)"},
              Choice(&LightmapOptions::deluxeTangent)},
             {{.name = "-brightness",
               .values = "F",
               .range = kPositive,
               .outside = OutOfRange::UseDefault,
               .outsideValue = 1,
               .help = "Factor of lightmaps",
               .details = "The shader directive `q3map_lightmapBrightness` multiplies it."},
              &LightmapOptions::brightness},
             {{.name = "-macrotexture",
               .values = "IMAGE",
               .initial = "the worldspawn key `_macrotexture`",
               .help = "Tint lightmaps and vertex light by an image over the whole world, seen from above",
               .details = "[from_source.md](from_source.md#macro-textures) tells how."},
              &LightmapOptions::macroTexture},
             {{.name = "-approx",
               .values = "N",
               .unit = "byte values",
               .range = {.low = 0},
               .help = "Drop a lightmap that vertex light matches within N; 0 turns it off",
               .details = "Surfaces up to two luxels large get none either."},
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
        "[directional.md](directional.md) describes and compares these forms.",
        {{{.name = "-hdr", .help = "Store HDR lightmaps and vertex light only, in BSPX lumps"},
          Do<LightmapOptions>(hdrOnly)},
         {{.name = "-both", .help = "Store 8-bit and HDR lightmaps"}, Do<LightmapOptions>(both)},
         {{.name = "-hdrfiles",
           .values = "rend2|ioquake3|exr|pfm",
           .kind = SettingKind::Choice,
           .initial = "none",
           .help = "Also write HDR pages as images x/lm_NNNN and, for engines, x/vertlight.raw; includes -both"},
          Do<LightmapOptions>(files)},
         {{.name = "-ldr", .help = "Store 8-bit lightmaps only, the default; overrides the options above"},
          Do<LightmapOptions>(ldr)},
         {{.name = "-rnm",
           .help = "Radiosity normal mapping: store light for three basis normals of normal mapped surfaces",
           .details = "`q3map_rnm` and `q3map_noRnm` in a shader decide; else surfaces count whose shader names a "
                      "normal map, or has an image `NAME_n`, `NAME_norm` or `NAME_local` beside its image."},
          &LightmapOptions::rnm},
         {{.name = "-rnmall", .help = "The same for all surfaces with lightmaps"}, Do<LightmapOptions>(rnmAll)},
         {{.name = "-rnmstorage",
           .values = "raw|rescaled",
           .kind = SettingKind::Choice,
           .initial = "rescaled",
           .help = "Store the light itself, or rescaled so that the mean of the three maps is the flat lightmap"},
          Do<LightmapOptions>(storage)},
         {{.name = "-lightmass",
           .help = "Also write L1 SH lightmaps in the layout of Unreal's Lightmass as images with a JSON file"},
          &LightmapOptions::lightmass},
         {{.name = "-skyocclusion", .help = "Also store from which direction the sky is seen; includes -lightmass"},
          Do<LightmapOptions>(skyOcclusion)},
         {{.name = "-shadowmap",
           .values = "LIGHT",
           .kind = SettingKind::Text,
           .initial = "none",
           .help = "Also store the visibility of the light of that targetname; may be repeated; includes -lightmass"},
          Do<LightmapOptions>(shadowMap)}}};
}

Group Packing() {
    return {
        "Packing",
        "",
        {{{.name = "-nocollapse",
           .help = "Store single-color and equal lightmaps separately too",
           .details = "Light styles have the same effect."},
          Off(&LightmapOptions::collapse)},
         {{.name = "-slowallocate", .help = "Pack lightmaps tightly: try every position on every page"},
          Off(&LightmapOptions::fastAllocate)},
         {{.name = "-lightmapsearchblocksize",
           .values = "N",
           .unit = "pages",
           .range = {0, kMaxSearchBlock},
           .help = "Search for room in blocks of N pages; 0 searches all"},
          &LightmapOptions::searchBlock},
         {{.name = "-lightmapsearchpower",
           .values = "N",
           .initial = "off",
           .range = {-kMaxSearchPower, kMaxSearchPower},
           .help = "Search for room in blocks of pages; a block has the area of a page with 2^N times the game's side"},
          &LightmapOptions::searchPower},
         {{.name = "-nolightmapsearch", .help = "Search for room on the last page only"}, &LightmapOptions::noSearch},
         {{.name = "-fill", .help = "Fill unused texels with the mean of their neighbors"}, &LightmapOptions::fill},
         {{.name = "-export", .help = "Also write the pages as images x/lightmap_NNNN.tga"},
          &LightmapOptions::exportPages},
         {{.name = "-trisoup", .help = "Store flat surfaces as triangle soups without lightmaps"},
          &LightmapOptions::triangleSoup}}};
}

Group Debugging() {
    return {
        "For debugging",
        "Lightmaps show this instead of light.",
        {{{.name = "-debug",
           .help = "Mark luxels: orange no surface, violet no free position, blue filled from neighbors"},
          &LightmapOptions::debug},
         {{.name = "-border", .help = "Draw the border of each lightmap red"}, &LightmapOptions::border},
         {{.name = "-fillpink", .help = "Draw unused texels pink"}, &LightmapOptions::fillPink},
         {{.name = "-debugsurfaces", .aliases = {"-debugsurface"}, .help = "Color each surface differently"},
          Show(DebugView::Surfaces)},
         {{.name = "-debugaxis", .help = "Show the axis along which lightmaps are projected"}, Show(DebugView::Axis)},
         {{.name = "-debugcluster", .help = "Show the visibility cluster of each luxel"}, Show(DebugView::Cluster)},
         {{.name = "-debugorigin", .help = "Show the position of each luxel"}, Show(DebugView::Origin)},
         {{.name = "-dirtdebug", .aliases = {"-debugdirt"}, .help = "Show dirt; includes -dirty"},
          Show(DebugView::Dirt)},
         {{.name = "-normalmap", .help = "Show normals, as a normal map"}, Show(DebugView::NormalMap)},
         {{.name = "-debugnormals", .help = "Show normals"}, &LightmapOptions::debugNormals},
         {{.name = "-debugdeluxe", .help = "Show light directions; includes -deluxe"}, &LightmapOptions::debugDeluxe},
         {{.name = "-debugsamplesize", .help = "Print every surface whose luxels had to grow"},
          &LightmapOptions::debugSampleSize}}};
}

} // namespace

std::vector<SettingGroup<LightmapOptions>> LightmapSettings() {
    return {Samples(), LuxelSize(), Normals(),   Dirt(),    Bounces(),  Vertices(),
            Pages(),   Storing(),   Encodings(), Packing(), Debugging()};
}

} // namespace q3
