// GPL-2.0-or-later. Settings of lightmaps, vertex light and bounces, declared once. Const after parsing.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "libs/math/vec.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/shader/games.h"

#include <array>
#include <limits>
#include <optional>
#include <string>

namespace q3 {

/// Longest side of a lightmap page, in texels; more than any engine supports.
inline constexpr int kMaxPageSide = 8192;

/// Largest -samplessearchboxsize, luxels.
inline constexpr int kMaxSearchBox = 4;

/// LightmapOptions::bounces of -bounce inf.
inline constexpr int kEndlessBounces = std::numeric_limits<int>::max();

/// Format of image files of HDR lightmaps, -hdrfiles.
enum class HdrFiles {
    None,
    Rend2,    ///< .hdr, Radiance, as OpenJK's rend2 reads it
    Ioquake3, ///< .hdr as the second renderers of ioquake3 and Quake3e read it
    OpenExr,  ///< .exr
    Pfm       ///< .pfm
};

/// What luxels show instead of light: the -debug... options.
enum class DebugView { Light, Surfaces, Axis, Cluster, Origin, Dirt, NormalMap };

/// Declared, with units, ranges and help, in lightmap_options.cpp.
struct LightmapOptions {
    bool onlyGrid = false; ///< -onlygrid: lightmaps and vertex colors stay as they are

    // Samples.
    int super = 1;                          ///< -super, 1 to 8
    int samples = 1;                        ///< -samples: depth of adaptive sampling; 1: one sample a luxel
    bool samplesExact = false;              ///< -samples +N
    bool randomSamples = false;             ///< -randomsamples
    int samplesSearchBox = 1;               ///< -samplessearchboxsize, 1 to 4
    bool filter = false;                    ///< -filter
    float threshold = 1;                    ///< -thresh: luxels
    int sampleSize = 16, minSampleSize = 0; ///< -samplesize, -minsamplesize: without a surface file only
    int sampleScale = 0;                    ///< -samplescale; 0: off
    int rawSizeLimit = 0;                   ///< -rawlightmapsizelimit; 0: off
    bool triangleCheck = false, extraVisNudge = false, dark = false; ///< -trianglecheck, -extravisnudge, -dark
    bool shade = false;                                              ///< smooths vertex normals
    float shadeAngle = 0;                                            ///< -shadeangle, degrees; over 0 includes shade
    bool halfLambert = false;                                        ///< -lightanglehl 1
    bool fastPoint = true;                                           ///< false: -nofastpoint
    bool fast = false, faster = false, cheap = false;                ///< of LightOptions

    // Dirt.
    bool dirty = false;                ///< -dirty
    bool dirtRandom = false;           ///< -dirtmode 1
    float dirtDepth = 128;             ///< game units
    float dirtScale = 1, dirtGain = 1; ///< factor and exponent

    // Bounces.
    int bounces = 0;                             ///< kEndlessBounces: until little light is left
    double bounceTime = 0;                       ///< -bouncetime, seconds; 0: no limit
    std::optional<int> bounceRays;               ///< -bouncerays, of a luxel; not given: 64, or 24 under -fast
    bool linearReflectance = false;              ///< -reflectivity linear
    bool bounceGrid = false, bounceOnly = false; ///< -bouncegrid, -bounceonly
    float bounceScale = 0.25f;                   ///< 0.25 * -bouncescale
    float bounceColorRatio = 1;                  ///< 0: bounced light is gray, 1: of the texture's color

    // Vertices.
    float vertexScale = 1;                  ///< -vertexscale: factor
    std::optional<float> noVertex;          ///< -novertex: constant light, fraction of 127.5
    bool cpma = false, noLightmaps = false; ///< -cpma, -nolm

    // Storing.
    float brightness = 1;                                          ///< -brightness: factor
    float approximate = 0;                                         ///< -approx: byte tolerance; 0: off
    std::array<int, 2> pageSize{128, 128}, gamePageSize{128, 128}; ///< texels: of the pages made; of the game
    std::vector<int> lightmapSize, hackSize;        ///< -lightmapsize, -extlmhacksize as given; empty: not given
    /// The size of the pages of a file that says it itself, instead of that of the game.
    void UsePageSize(int side);
    bool external = false;                          ///< pages are images beside the map
    std::string externalFolder;                     ///< -lightmapdir
    bool deluxe = false, deluxeTangent = false;     ///< -deluxe; -deluxemode 1
    bool collapse = true;                           ///< false: -nocollapse
    bool fastAllocate = true;                       ///< false: -slowallocate
    int searchBlock = 0;                            ///< pages; 0: all
    std::optional<int> searchPower;                 ///< -lightmapsearchpower
    bool noSearch = false;                          ///< -nolightmapsearch
    bool fill = false, fillPink = false;            ///< -fill, -fillpink
    std::string macroTexture{};                     ///< -macrotexture; empty: that of the world's key
    bool exportPages = false, triangleSoup = false; ///< -export, -trisoup
    bool sRgbTexture = false;                       ///< of LightOptions

    // Encodings of light.
    bool ldr = true, hdr = false;                 ///< -ldr, -hdr, -both: 8-bit pages, HDR pages
    HdrFiles hdrFiles = HdrFiles::None;           ///< -hdrfiles
    bool rnm = false, rnmAll = false;             ///< -rnm: of normal mapped surfaces; -rnmall
    bool rnmRescaled = true;                      ///< -rnmstorage
    bool lightmass = false, skyOcclusion = false; ///< -lightmass, -skyocclusion
    std::vector<std::string> shadowMaps;          ///< -shadowmap: names of lights
    /// Whether luxels keep the SH of their light.
    bool NeedsSH() const { return lightmass; }

    // Debug: the options of the same names.
    bool debug = false, border = false, debugNormals = false, debugDeluxe = false, debugSampleSize = false;
    DebugView show = DebugView::Light;
};

/// Takes the options of lightmaps, vertex light and bounces off `arguments`; -fast and other options that also
/// concern the grids come from `light`, which is parsed first. Errors: Error, for values out of range; a page size that
/// is no power of two is a warning, and the game's is used.
LightmapOptions ParseLightmapOptions(Arguments &arguments, const LightOptions &light, const Game &game, Log &log);

/// The options of the light stage that LightSettings lacks: lightmaps, vertex light, bounces.
std::vector<SettingGroup<LightmapOptions>> LightmapSettings();

} // namespace q3
