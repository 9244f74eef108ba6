// GPL-2.0-or-later. Settings of the light stage, declared once. Const after parsing.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "libs/math/vec.h"
#include "q3map2/shader/games.h"
#include "q3map2/shader/shader_library.h"

#include <optional>
#include <string>

namespace q3 {

/// The sparse grid is the smallest that meets the error, or the most accurate within the budget if there is one.
struct SparseGoal {
    float error = 1.5f;           ///< displayed error, measured or, where no light is traced, expected: RMS, bytes
    std::optional<double> budget; ///< size of the lump in bytes, in place of the error
    bool isGiven = false;         ///< by an option: a bake may take longer than that of the uniform grid
};

/// The option -sherrortarget. goal(options) returns the goal to set; it is called once for each time the option is
/// given.
template <typename Options, typename GoalOf>
Setting<Options> ErrorTargetSetting(std::string_view help, std::string_view details, GoalOf goal) {
    return {{.name = "-sherrortarget",
             .values = "LEVELS",
             .kind = SettingKind::Number,
             .unit = "8-bit levels",
             .initial = "1.5",
             .range = {0.05, 64},
             .help = help,
             .details = details,
             .since = "0.2.0",
             .example = "3"},
            Do<Options>([goal](Options &o, const SettingValues &v) { goal(o).error = float(v.numbers[0]); })};
}

/// The option -shbudget, likewise.
template <typename Options, typename GoalOf>
Setting<Options> BudgetSetting(std::string_view help, std::string_view details, GoalOf goal) {
    return {{.name = "-shbudget",
             .values = "MB",
             .kind = SettingKind::Number,
             .unit = "million bytes",
             .initial = "none",
             .range = {0.01, 2000},
             .help = help,
             .details = details,
             .since = "0.2.0",
             .example = "2"},
            Do<Options>([goal](Options &o, const SettingValues &v) { goal(o).budget = v.numbers[0] * 1e6; })};
}

/// Edge of the SH grid's cells that -shsmall chooses, game units.
inline constexpr float kSmallCellSH = 64;
/// Smallest cell of either light grid, on each axis. Game units.
inline constexpr float kMinCell = 8;

/// Tone mapping: how light becomes bytes. ToneMapper (light/options/light_tone.h) applies the settings, in its own
/// order.
struct ToneOptions {
    float gamma = 1, exposure = 0, compensate = 1, saturation = 1; ///< as the options of these names; exposure 0: off
    float contrast = 1;                                            ///< the factor, not the option's -255..255
    bool sRgb = false;                                             ///< bytes are in sRGB
    float maxLight = 255;                                          ///< from worldspawn _maxlight
};

/// Shortcuts: each has a -noskip option, and -noskip switches all off.
struct SkipOptions {
    bool reach = true;   ///< leave out lights out of reach of a brick of points, or facing away from it
    bool pvs = true;     ///< leave out lights that visibility data hides
    bool faint = true;   ///< represent faint lights by a few of them
    bool moments = true; ///< approximate far area lights by points instead of the closed form
    bool probes = true;  ///< cast a single ray toward faint area lights
    bool smooth = true;  ///< SH grid: interpolate the weak light of points where it is smooth
    bool coarse = false; ///< dim lights: trace a few receivers of a batch, the rest if they differ; only with fastGrid
};

/// Settings of the light stage. Options with units, ranges and help: light_options.cpp.
struct LightOptions {
    // Intensities: the product of the option's factors and the default.
    float pointScale = 7500, spotScale = 7500, areaScale = 0.25f, skyScale = 1;
    float gridScale = 1, gridAmbientScale = 1;
    /// Factor of the light in the SH grid and ambient cubes: gridScale if that is positive, else 1.
    float PositiveGridScale() const { return gridScale > 0 ? gridScale : 1; }
    /// Legacy grid: share of light from the main direction, and from the opposite one, that is stored as directed.
    float gridDirectionality = 1, gridAmbientDirectionality = 0;
    float extraDist = 0;                      ///< of lights without the key _extradist. Game units
    std::vector<std::string> texLightFiles{}; ///< -lights
    bool wolfLighting = false;                ///< lights without spawnflags fall off linearly
    ToneOptions tone;
    ShaderOptions shader;
    bool sRgbTexture = false;  ///< images are sRGB where they color bounced light
    float tolerance = 1;       ///< falloff tolerance, byte scale
    bool recoverLamps = false; ///< first finds the lamps of a map whose source is lost

    // Speed against quality.
    bool fast = false;      ///< lights end where they fall below the tolerance, except in the SH grid
    bool fastGrid = false;  ///< legacy grid: as fast; SH grid: fewer samples. Set by -fast too
    bool faster = false;    ///< treat area lights as points, except for the SH grid
    bool cheap = false;     ///< add no more light to white vertices and legacy grid points
    bool cheapGrid = false; ///< the same for legacy grid points only; set by -cheap too
    int areaShadows = 0;    ///< -areashadows: most rays of a luxel to an area light; 0: one, to its middle
    bool noTrace = false, structuralShadowsOnly = false, sunOnly = false, oneSky = false, noStyles = false,
         patchShadows = false;
    bool switchable = false; ///< lights of a targetname get a style
    bool styleSlots = false; ///< the file holds four styles of light: Game::styleSlots
    bool floodlight = false, lowQuality = false;
    bool noGrid = false;             ///< the legacy grid stays as it is
    bool staticPropLighting = false; ///< light at the vertices of static props
    bool staticPropPolys = false;    ///< static props cast shadows by their triangles; else by boxes, if they are lit
    bool textureShadows = false;     ///< such triangles let light through where their image is see-through
    bool staticPropFiles = false;    ///< light of static props also as files beside the map
    std::uint32_t noDrawSurfaceFlags = 0; ///< surface flags of the game that mark surfaces as not drawn

    // SH grid.
    bool sh = false;         ///< bake the uniform SH grid, not only as a step to the sparse one
    bool shBspx = false;     ///< it goes into a BSPX lump, not into lump 18
    bool shAdaptive = false; ///< the sparse SH grid
    bool shLights = false;   ///< a grid that names its strongest lights; with shAdaptive, in place of the sparse one
    int shNames = 4;         ///< most lights that a cell names, besides those with a style
    SparseGoal sparseGoal;
    bool shRadiance = false;         ///< store radiance, not irradiance
    std::string gridFormats;         ///< -gridformats
    bool keepSH = false;             ///< -sh or -shbspx: the map keeps the uniform SH grid, whatever -gridformats says
    bool shDering = false;           ///< no negative lobes
    bool shError = false;            ///< compare the grid with exact light and print the error
    float gridScaleSH = 2;           ///< points for each point of the legacy grid, along an axis
    std::optional<Vec3f> gridSizeSH; ///< -gridsh: size of a cell, else by gridScaleSH. Game units
    int shFit = 0;                   ///< samples per cell to which all points are fitted; 0: fit points in solids only
    bool shFill = true;              ///< fit points in solids; else fill from neighbors alone
    float shSamples = 1;             ///< factor of the number of rays: -shsamples or its default
    std::optional<float> givenSHSamples; ///< -shsamples, if given
    SkipOptions skip;

    // Ambient cubes.
    bool ambientCubes = false;
    bool cubesFromSH = false; ///< sides from the SH grid instead of traced light
    int cubesPerLeaf = 16;    ///< at most
    float cubeTolerance = 3;  ///< samples that others reproduce so well are left out. 255ths on a screen of gamma 2.2

    std::vector<Vec3f> explain;             ///< -explain: points whose light is explained; nothing is baked
    std::string previewFile;                ///< -shpreview
    bool fixBotFiles = false;               ///< enter the lit map into bot files beside it
    std::vector<std::string> withoutEffect; ///< options given that change nothing
};

/// Removes the options of the grids, and those that grids share with lightmaps, from `arguments`; leaves all others.
/// Errors: Error, for values out of range.
LightOptions ParseLightOptions(Arguments &arguments, const Game &game, Log &log);

/// The options of the light stage that concern light sources and the grids. Those of lightmaps: LightmapSettings.
std::vector<SettingGroup<LightOptions>> LightOptionSettings();

} // namespace q3
