// GPL-2.0-or-later. Settings of the light stage.
#include "q3map2/light/options/light_options.h"

#include "common/error.h"
#include "q3map2/light/options/light_settings.h"

#include <algorithm>

namespace q3 {

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
    o.patchShadows = game.patchShadows;
    o.noDrawSurfaceFlags = game.NoDrawSurfaceFlags();
    o.skip.coarse = true; // ApplyInclusions clears it without -fastgrid
    return o;
}

/// Sets options that other options include.
void ApplyInclusions(LightOptions &o) {
    o.fast |= o.faster;
    o.fastGrid |= o.fast;
    o.cheapGrid |= o.cheap;
    o.skip.coarse &= o.fastGrid;
    o.keepSH = o.sh || o.shBspx;
    o.sh = o.keepSH || (o.shRadiance && !o.shAdaptive) || !o.gridFormats.empty();
    o.ambientCubes |= o.cubesFromSH;
    if (o.tone.sRgb)
        o.tolerance = 255 * LinearFromSrgb(1.0f / 255);
    o.shSamples = o.givenShSamples.value_or(o.fastGrid ? kFastSamples : 1);
    // Repeated factors multiply; keep the product within bounds.
    for (float *scale : {&o.pointScale, &o.spotScale, &o.areaScale, &o.skyScale, &o.gridScale, &o.gridAmbientScale})
        *scale = std::clamp(*scale, float(-kMaxSetting), float(kMaxSetting));
}

void CheckCombinations(const LightOptions &o) {
    if (!o.shFill && o.shFit > 0)
        throw Error("-shfit and -noshfill exclude each other");
    const std::pair<std::string_view, bool> wantsSH[] = {{"-shdering", o.shDering},
                                                         {"-sherror", o.shError},
                                                         {"-shfit", o.shFit > 0},
                                                         {"-shpreview", !o.previewFile.empty()}};
    for (const auto &[name, given] : wantsSH)
        if (given && !o.sh && !o.shAdaptive)
            throw Error("{} needs -sh or -shadaptive", name);
    if (o.cubesFromSH && !o.sh && !o.shAdaptive)
        throw Error("-ambientcubesfrom sh needs -sh or -shadaptive");
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

} // namespace q3
