// GPL-2.0-or-later. Settings of the light stage. Const after parsing.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/shader/games.h"
#include "q3map2/shader/shader.h"

#include <optional>
#include <string>

namespace q3 {

/// How light becomes bytes: scale, exposure, saturation, gamma, sRGB, in the order of light/tone/light_tone.cpp.
struct ToneOptions {
    float gamma = 1, exposure = 0, compensate = 1, saturation = 1;
    float contrast = 1; ///< the factor, not the option's -255..255
    bool sRgb = false;
    float maxLight = 255; ///< from worldspawn _maxlight
};

/// Work that a scene does not need and that is left out: one -noskip option each, or -noskip for all.
struct SkipOptions {
    bool reach = true;   ///< lights out of reach of a brick of points, or facing away from it
    bool pvs = true;     ///< lights that visibility data hides
    bool faint = true;   ///< faint lights, represented by a few
    bool moments = true; ///< closed form of far area lights, approximated by points
    bool probes = true;  ///< more than one ray toward faint area lights
    bool coarse = false; ///< rays of dim lights, where a few receivers of a batch see the same; only with fastGrid
};

/// Declared, with units, ranges and help, in light_settings.cpp.
struct LightOptions {
    // Intensities, already multiplied by their defaults.
    float pointScale = 7500, spotScale = 7500, areaScale = 0.25f, skyScale = 1;
    float gridScale = 1, gridAmbientScale = 1;
    float gridDirectionality = 1, gridAmbientDirectionality = 0;
    float extraDist = 0;
    bool wolfLighting = false;
    ToneOptions tone;
    ShaderOptions shader;
    bool sRgbTexture = false; ///< colours of images are sRGB where they tint bounced light
    float tolerance = 1;      ///< falloff tolerance, byte scale

    // Speed against quality.
    bool fast = false;      ///< lights end where they fall below the tolerance: in all passes
    bool fastGrid = false;  ///< ... on the grids; set by -fast too
    bool faster = false;    ///< treat area lights as points, except for the SH grid
    bool cheap = false;     ///< stop adding lights to what is white: in all passes that -cheap concerns
    bool cheapGrid = false; ///< ... to points of the legacy grid; set by -cheap too
    bool noTrace = false, structuralShadowsOnly = false, sunOnly = false, oneSky = false, noStyles = false,
         patchShadows = false;
    bool floodlight = false, lowQuality = false;
    bool noGrid = false;
    std::uint32_t noDrawSurfaceFlags = 0; ///< the game's bits of surfaces that are not drawn

    // SH grid.
    bool sh = false;
    bool shBspx = false;
    bool shRadiance = false;
    bool shDering = false; ///< no negative lobes
    bool shError = false;  ///< compare the grid with exact light and say how far it is off
    float gridScaleSH = 2;
    std::optional<Vec3f> gridSizeSH;
    int shFit = 0;       ///< samples per cell to which all points are fitted; 0: fit points in solids only
    bool shFill = true;  ///< fit points in solids; else fill from neighbours alone
    float shSamples = 1; ///< factor of the number of rays
    std::optional<float> givenShSamples; ///< -shsamples
    SkipOptions skip;

    std::string previewFile;                ///< -shpreview
    std::vector<std::string> withoutEffect; ///< given options that change nothing
};

/// Takes the options of the grids, and those that the grids share with lightmaps, off `arguments`. Errors: Error, for
/// values out of range. Words that it does not know stay.
LightOptions ParseLightOptions(Arguments &arguments, const Game &game, Log &log);

} // namespace q3
