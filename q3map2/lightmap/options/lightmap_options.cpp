// GPL-2.0-or-later. Settings of lightmaps, vertex light and bounces.
#include "q3map2/lightmap/options/lightmap_options.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

/// Larger factors would let products of a few of them pass what float can hold.
constexpr double kMaxFactor = 1e6;
/// Sides of pages; every engine's limit is lower.
constexpr int kMinPageSide = 2, kMaxPageSide = 8192;
constexpr int kMaxSuper = 8, kMaxSearchBox = 4, kMaxSamples = 64, kMaxBounces = 1000;

float Factor(std::string_view text) {
    return float(std::clamp(NumberFromText(text), -kMaxFactor, kMaxFactor));
}

/// Takes every occurrence; the last one counts.
std::optional<float> TakeNumber(Arguments &arguments, std::string_view name) {
    std::optional<float> number;
    while (const auto value = arguments.TakeValue(name))
        number = Factor(*value);
    return number;
}

/// Sets `value` if the option is there; what is not above 0 counts as `otherwise`.
void TakePositive(Arguments &arguments, std::string_view name, float otherwise, float &value) {
    if (const auto number = TakeNumber(arguments, name))
        value = *number > 0 ? *number : otherwise;
}

/// A whole number in [least, most]. Errors: Error, for anything else.
void TakeWhole(Arguments &arguments, std::string_view name, int least, int most, int &value) {
    while (const auto text = arguments.TakeValue(name)) {
        value = IntegerFromText(*text);
        if (value < least || value > most)
            throw Error("{} {}: expected a whole number from {} to {}", name, *text, least, most);
    }
}

/// Position of the first occurrence.
std::optional<std::size_t> Find(const Arguments &arguments, std::string_view name) {
    const std::vector<std::string> &words = arguments.Rest();
    const auto at = std::find_if(words.begin(), words.end(), [&](const auto &word) { return EqualNoCase(word, name); });
    return at == words.end() ? std::nullopt : std::optional(std::size_t(at - words.begin()));
}

/// Whether the word at that position is there and starts with a number that is not 0.
bool NumberAt(const Arguments &arguments, std::size_t at) {
    return at < arguments.Rest().size() && NumberFromText(arguments.Rest()[at]) != 0;
}

void ParseSamples(Arguments &arguments, LightmapOptions &o) {
    for (const std::string_view name : {"-super", "-supersample"})
        TakeWhole(arguments, name, 1, kMaxSuper, o.super);
    while (const auto text = arguments.TakeValue("-samples")) {
        o.samplesExact = text->starts_with('+');
        o.samples = IntegerFromText(std::string_view(*text).substr(o.samplesExact ? 1 : 0));
        if (o.samples < 1 || o.samples > (o.samplesExact ? 65536 : kMaxSamples))
            throw Error("-samples {}: expected a whole number from 1 to {}, or + and a number of samples", *text,
                        kMaxSamples);
    }
    o.randomSamples = arguments.TakeFlag("-randomsamples");
    TakeWhole(arguments, "-samplessearchboxsize", 1, kMaxSearchBox, o.samplesSearchBox);
    o.filter = arguments.TakeFlag("-filter");
    if (const auto number = TakeNumber(arguments, "-thresh"))
        o.threshold = *number < 0 ? 1 : *number;
    TakeWhole(arguments, "-samplesize", 1, 16384, o.sampleSize);
    TakeWhole(arguments, "-minsamplesize", 1, 16384, o.minSampleSize);
    TakeWhole(arguments, "-samplescale", 0, 16384, o.sampleScale);
    TakeWhole(arguments, "-rawlightmapsizelimit", 0, kMaxPageSide, o.rawSizeLimit);
    o.triangleCheck = arguments.TakeFlag("-trianglecheck");
    o.extraVisNudge = arguments.TakeFlag("-extravisnudge");
    o.dark = arguments.TakeFlag("-dark");
    o.shade = arguments.TakeFlag("-shade");
    if (const auto degrees = TakeNumber(arguments, "-shadeangle")) {
        o.shadeAngle = std::clamp(*degrees, 0.0f, 360.0f);
        o.shade |= o.shadeAngle > 0;
    }
    if (const auto number = TakeNumber(arguments, "-lightanglehl"))
        o.halfLambert = *number != 0;
    o.fastPoint = !arguments.TakeFlag("-nofastpoint");
}

void ParseDirt(Arguments &arguments, LightmapOptions &o) {
    o.dirty = arguments.TakeFlag("-dirty");
    if (const auto mode = TakeNumber(arguments, "-dirtmode"))
        o.dirtRandom = *mode == 1;
    TakePositive(arguments, "-dirtdepth", 128, o.dirtDepth);
    TakePositive(arguments, "-dirtscale", 1, o.dirtScale);
    TakePositive(arguments, "-dirtgain", 1, o.dirtGain);
}

void ParseBounces(Arguments &arguments, LightmapOptions &o) {
    TakeWhole(arguments, "-bounce", 0, kMaxBounces, o.bounces);
    o.bounceGrid = arguments.TakeFlag("-bouncegrid");
    o.bounceOnly = arguments.TakeFlag("-bounceonly");
    while (const auto value = arguments.TakeValue("-bouncescale"))
        o.bounceScale = float(std::clamp(double(o.bounceScale * Factor(*value)), -kMaxFactor, kMaxFactor));
    if (const auto ratio = TakeNumber(arguments, "-bouncecolorratio"))
        o.bounceColorRatio = std::clamp(*ratio, 0.0f, 1.0f);
}

void ParseVertices(Arguments &arguments, LightmapOptions &o) {
    if (const auto scale = TakeNumber(arguments, "-vertexscale"))
        o.vertexScale = *scale;
    while (const auto at = Find(arguments, "-novertex")) {
        const bool hasValue = NumberAt(arguments, *at + 1);
        const auto values = arguments.TakeValues({"-novertex"}, hasValue ? 1 : 0);
        o.noVertex = hasValue ? std::clamp(Factor(values->front()), 0.0f, 1.0f) : 1;
    }
    o.cpma = arguments.TakeFlag("-cpma");
    o.noLightmaps = arguments.TakeFlag("-nolm");
}

/// "W [H]". Nothing, and a warning, unless both are powers of two in range.
std::optional<std::array<int, 2>> TakePageSize(Arguments &arguments, std::string_view name, Log &log) {
    std::optional<std::array<int, 2>> size;
    while (const auto at = Find(arguments, name)) {
        const auto values = arguments.TakeValues({name}, NumberAt(arguments, *at + 2) ? 2 : 1);
        const int w = IntegerFromText(values->front()), h = IntegerFromText(values->back());
        const auto fits = [](int side) {
            return side >= kMinPageSide && side <= kMaxPageSide && std::has_single_bit(unsigned(side));
        };
        if (fits(w) && fits(h))
            size = {w, h};
        else
            log.Warn("page size", "{} {} {}: expected powers of two from {} to {}; taking the game's size", name, w, h,
                     kMinPageSide, kMaxPageSide);
    }
    return size;
}

void ParsePages(Arguments &arguments, LightmapOptions &o, Log &log) {
    if (const auto size = TakePageSize(arguments, "-lightmapsize", log)) {
        o.pageSize = *size;
        o.external = o.pageSize != o.gamePageSize;
    }
    if (const auto size = TakePageSize(arguments, "-extlmhacksize", log); size && !o.external)
        o.pageSize = *size;
    o.external |= arguments.TakeFlag("-external");
    while (const auto folder = arguments.TakeValue("-lightmapdir")) {
        o.externalFolder = *folder;
        o.external = true;
    }
    TakeWhole(arguments, "-lightmapsearchblocksize", 0, 1 << 20, o.searchBlock);
    if (Find(arguments, "-lightmapsearchpower")) {
        int power = 0;
        TakeWhole(arguments, "-lightmapsearchpower", -20, 20, power);
        const double ratio = o.gamePageSize[0] * std::exp2(power) / o.pageSize[0];
        o.searchBlock = int(std::clamp(ratio * ratio, 1.0, double(1 << 20)));
    }
    if (arguments.TakeFlag("-nolightmapsearch"))
        o.searchBlock = 1;
    o.fastAllocate = !arguments.TakeFlag("-slowallocate");
}

void ParseStoring(Arguments &arguments, LightmapOptions &o, Log &log) {
    TakePositive(arguments, "-brightness", 1, o.brightness);
    if (const auto tolerance = TakeNumber(arguments, "-approx"))
        o.approximate = std::max(0.0f, *tolerance);
    ParsePages(arguments, o, log);
    if (arguments.TakeFlag({"-deluxe", "-deluxemap"}))
        o.deluxe = true;
    if (arguments.TakeFlag({"-nodeluxe", "-nodeluxemap"}))
        o.deluxe = false;
    if (const auto mode = TakeNumber(arguments, "-deluxemode"))
        o.deluxeTangent = *mode == 1;
    o.collapse = !arguments.TakeFlag("-nocollapse");
    o.fill = arguments.TakeFlag("-fill");
    o.fillPink = arguments.TakeFlag("-fillpink");
    o.exportPages = arguments.TakeFlag("-export");
    o.triangleSoup = arguments.TakeFlag("-trisoup");
}

void ParseDebug(Arguments &arguments, LightmapOptions &o) {
    o.debug = arguments.TakeFlag("-debug");
    o.border = arguments.TakeFlag("-border");
    o.debugNormals = arguments.TakeFlag("-debugnormals");
    o.debugSampleSize = arguments.TakeFlag("-debugsamplesize");
    o.debugDeluxe = arguments.TakeFlag("-debugdeluxe");
    o.deluxe |= o.debugDeluxe;
    struct Show {
        std::string_view name;
        DebugView show;
    };
    constexpr Show kShows[] = {{"-debugsurfaces", DebugView::Surfaces}, {"-debugsurface", DebugView::Surfaces},
                               {"-debugaxis", DebugView::Axis},         {"-debugcluster", DebugView::Cluster},
                               {"-debugorigin", DebugView::Origin},     {"-dirtdebug", DebugView::Dirt},
                               {"-debugdirt", DebugView::Dirt},         {"-normalmap", DebugView::NormalMap}};
    for (const auto &[name, show] : kShows)
        if (arguments.TakeFlag(name))
            o.show = show;
    o.dirty |= o.show == DebugView::Dirt;
}

} // namespace

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
    o.onlyGrid = arguments.TakeFlag("-onlygrid");
    ParseSamples(arguments, o);
    ParseDirt(arguments, o);
    ParseBounces(arguments, o);
    ParseVertices(arguments, o);
    ParseStoring(arguments, o, log);
    ParseDebug(arguments, o);
    return o;
}

} // namespace q3
