// GPL-2.0-or-later. Settings of the light stage.
#include "q3map2/light/options/light_options.h"

#include "common/error.h"
#include "common/text/text.h"

#include <algorithm>
#include <functional>

namespace q3 {

namespace {

/// Larger factors would let products of a few of them pass what float can hold.
constexpr double kMaxFactor = 1e6;

/// Calls use(value) for every occurrence of the option, in order.
void ForEach(Arguments &arguments, std::initializer_list<std::string_view> names,
             const std::function<void(float)> &use) {
    while (const auto value = arguments.TakeValue(names))
        use(float(std::clamp(NumberFromText(*value), -kMaxFactor, kMaxFactor)));
}

void ParseIntensities(Arguments &arguments, LightOptions &o) {
    ForEach(arguments, {"-scale"},
            [&](float f) { o.pointScale *= f, o.spotScale *= f, o.areaScale *= f, o.skyScale *= f; });
    ForEach(arguments, {"-point", "-pointscale"}, [&](float f) { o.pointScale *= f, o.spotScale *= f; });
    ForEach(arguments, {"-spherical", "-sphericalscale"}, [&](float f) { o.pointScale *= f; });
    ForEach(arguments, {"-spot", "-spotscale"}, [&](float f) { o.spotScale *= f; });
    ForEach(arguments, {"-area", "-areascale"}, [&](float f) { o.areaScale *= f; });
    ForEach(arguments, {"-sky", "-skyscale"}, [&](float f) { o.skyScale *= f; });
    ForEach(arguments, {"-gridscale"}, [&](float f) { o.gridScale *= f; });
    ForEach(arguments, {"-gridambientscale"}, [&](float f) { o.gridAmbientScale *= f; });
    ForEach(arguments, {"-griddirectionality"}, [&](float f) {
        o.gridDirectionality = std::min(1.0f, f);
        o.gridAmbientDirectionality = std::min(o.gridAmbientDirectionality, o.gridDirectionality);
    });
    ForEach(arguments, {"-gridambientdirectionality"}, [&](float f) {
        o.gridAmbientDirectionality = std::max(-1.0f, f);
        o.gridDirectionality = std::max(o.gridDirectionality, o.gridAmbientDirectionality);
    });
    ForEach(arguments, {"-extradist"}, [&](float f) { o.extraDist = std::max(0.0f, f); });
    while (const auto values = arguments.TakeValues({"-backsplash"}, 2)) {
        o.shader.backsplashScale *= float(NumberFromText((*values)[0]));
        o.shader.backsplashDistance = float(NumberFromText((*values)[1]));
    }
    if (arguments.TakeFlag("-wolf"))
        o.wolfLighting = true;
    if (arguments.TakeFlag("-q3"))
        o.wolfLighting = false;
}

void ParseTone(Arguments &arguments, LightOptions &o) {
    ForEach(arguments, {"-contrast"}, [&](float f) {
        const float c = std::clamp(f, -255.0f, 255.0f);
        o.tone.contrast = 259 * (c + 255) / (255 * (259 - c));
    });
    ForEach(arguments, {"-gamma"}, [&](float f) { o.tone.gamma = f > 0 ? f : 1; });
    ForEach(arguments, {"-exposure"}, [&](float f) { o.tone.exposure = f; });
    ForEach(arguments, {"-saturation"}, [&](float f) { o.tone.saturation = f; });
    ForEach(arguments, {"-compensate"}, [&](float f) { o.tone.compensate = f > 0 ? f : 1; });
    const auto toggle = [&](std::string_view on, std::string_view off, bool &value) {
        if (arguments.TakeFlag(on))
            value = true;
        if (arguments.TakeFlag(off))
            value = false;
    };
    toggle("-sRGBlight", "-nosRGBlight", o.tone.sRgb);
    toggle("-sRGBcolor", "-nosRGBcolor", o.shader.sRgbColor);
    toggle("-sRGBtex", "-nosRGBtex", o.sRgbTexture);
    const bool all = arguments.TakeFlag("-sRGB"), none = arguments.TakeFlag("-nosRGB");
    if (all || none)
        o.tone.sRgb = o.shader.sRgbColor = o.sRgbTexture = !none;
    if (o.tone.sRgb)
        o.tolerance = 255 * LinearFromSrgb(1.0f / 255);
}

void ParseSpeed(Arguments &arguments, LightOptions &o) {
    o.faster = arguments.TakeFlag("-faster");
    o.fast = arguments.TakeFlag("-fast") || o.faster;
    o.fastGrid = arguments.TakeFlag("-fastgrid") || o.fast;
    o.cheap = arguments.TakeFlag("-cheap");
    o.cheapGrid = arguments.TakeFlag("-cheapgrid") || o.cheap;
    o.noTrace = arguments.TakeFlag("-notrace");
    o.noSurfaces = arguments.TakeFlag("-nosurf");
    o.sunOnly = arguments.TakeFlag("-sunonly");
    o.oneSky = arguments.TakeFlag("-onesky");
    o.patchShadows |= arguments.TakeFlag("-patchshadows");
    if (arguments.TakeFlag({"-style", "-styles"}))
        o.noStyles = false;
    if (arguments.TakeFlag({"-nostyle", "-nostyles"}))
        o.noStyles = true;
    o.floodlight = arguments.TakeFlag("-floodlight");
    o.lowQuality = arguments.TakeFlag("-lowquality");
    o.noGrid = arguments.TakeFlag("-nogrid");
}

/// Needs the options of speed.
void ParseSkips(Arguments &arguments, LightOptions &o) {
    SkipOptions &skip = o.skip;
    const bool none = arguments.TakeFlag("-noskip");
    const std::pair<std::string_view, bool &> switches[] = {
        {"-noskipreach", skip.reach},     {"-noskippvs", skip.pvs},       {"-noskipfaint", skip.faint},
        {"-noskipmoments", skip.moments}, {"-noskipprobes", skip.probes}, {"-noskipcoarse", skip.coarse}};
    for (const auto &[name, value] : switches)
        value = !arguments.TakeFlag(name) && !none;
    skip.coarse = skip.coarse && o.fastGrid;
}

/// -shsamples under -fast.
constexpr float kFastSamples = 1.0f / 16;
/// Samples a cell of -shfit.
constexpr int kDefaultFit = 6, kMaxFit = 64;

void ParseSH(Arguments &arguments, LightOptions &o) {
    o.shBspx = arguments.TakeFlag("-shbspx");
    o.shRadiance = arguments.TakeFlag("-shradiance");
    o.sh = arguments.TakeFlag("-sh") || o.shBspx || o.shRadiance;
    o.shDering = arguments.TakeFlag("-shdering");
    o.shError = arguments.TakeFlag("-sherror");
    while (const auto value = arguments.TakeValue("-gridscalesh")) {
        o.gridScaleSH = float(NumberFromText(*value));
        if (!(o.gridScaleSH > 0))
            throw Error("-gridscalesh {}: expected a number over 0", *value);
    }
    while (const auto values = arguments.TakeValues({"-gridsh"}, 3)) {
        Vec3f size;
        for (std::size_t i = 0; i < 3; ++i) {
            size[i] = float(NumberFromText((*values)[i]));
            if (!(size[i] > 0))
                throw Error("-gridsh {} {} {}: expected three numbers over 0", (*values)[0], (*values)[1],
                            (*values)[2]);
        }
        o.gridSizeSH = size;
    }
    if (o.fastGrid)
        o.shSamples = kFastSamples;
    while (const auto value = arguments.TakeValue("-shsamples")) {
        o.shSamples = float(NumberFromText(*value));
        if (!(o.shSamples >= 1.0f / 64 && o.shSamples <= 64))
            throw Error("-shsamples {}: expected a number from 1/64 to 64", *value);
    }
    while (const auto samples = arguments.TakeCount("-shfit")) {
        if (*samples > kMaxFit)
            throw Error("-shfit {}: expected a number of samples a cell from 1 to {}", *samples, kMaxFit);
        o.shFit = *samples > 0 ? *samples : kDefaultFit;
    }
    o.shFill = !arguments.TakeFlag("-noshfill");
    if (!o.shFill && o.shFit > 0)
        throw Error("-shfit and -noshfill exclude each other");
    while (const auto value = arguments.TakeValue("-shpreview"))
        o.previewFile = *value;
    const std::pair<std::string_view, bool> wantsSH[] = {{"-shdering", o.shDering},
                                                         {"-sherror", o.shError},
                                                         {"-shfit", o.shFit > 0},
                                                         {"-shpreview", !o.previewFile.empty()}};
    for (const auto &[name, given] : wantsSH)
        if (given && !o.sh)
            throw Error("{} needs -sh", name);
}

/// Options of the established program that choose what is always so here, or a way of working that is not needed.
void TakeNeedless(Arguments &arguments, Log &log) {
    std::string taken;
    for (const std::string_view name :
         {"-lomem", "-custinfoparms", "-fastallocate", "-fastbounce", "-nobouncestore", "-dump"})
        if (arguments.TakeFlag(name))
            taken += fmt::format(" {}", name);
    if (!taken.empty())
        log.Warn("options without effect", "without effect:{}", taken);
}

/// Repeated factors stay within bounds too.
void LimitScales(LightOptions &o) {
    for (float *scale : {&o.pointScale, &o.spotScale, &o.areaScale, &o.skyScale, &o.gridScale, &o.gridAmbientScale})
        *scale = std::clamp(*scale, float(-kMaxFactor), float(kMaxFactor));
}

} // namespace

LightOptions ParseLightOptions(Arguments &arguments, const Game &game, Log &log) {
    LightOptions o;
    o.wolfLighting = game.wolfLighting;
    o.tone = {.gamma = game.gamma, .exposure = game.exposure, .compensate = game.compensate, .sRgb = game.sRgbLightmap};
    o.shader.sRgbColor = game.sRgbColor;
    o.sRgbTexture = game.sRgbTexture;
    o.gridScale = game.gridScale;
    o.gridAmbientScale = game.gridAmbientScale;
    o.noStyles = game.noStyles;
    o.patchShadows = game.patchShadows;
    o.noDrawSurfaceFlags = game.NoDrawSurfaceFlags();

    ParseIntensities(arguments, o);
    LimitScales(o);
    ParseTone(arguments, o);
    ParseSpeed(arguments, o);
    ParseSkips(arguments, o);
    ParseSH(arguments, o);
    TakeNeedless(arguments, log);
    return o;
}

void WarnOfUnknown(const Arguments &arguments, Log &log) {
    for (const std::string &word : arguments.Rest())
        log.Warn("unknown argument", "Unknown argument \"{}\"", word);
}

} // namespace q3
