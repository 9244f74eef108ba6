// GPL-2.0-or-later. Options of the bsp stage.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "q3map2/shader/games.h"

#include <string>
#include <vector>

namespace q3 {

/// Declared, with units and ranges, in bsp_settings.cpp.
struct BspOptions {
    bool meta = false, patchMeta = false;
    int sampleSize = 16, minSampleSize = 0;
    bool leakTest = false, onlyEntities = false;
    bool fullDetail = false, noDetail = false, noWater = false, noFog = false, noHint = false, noCurves = false;
    bool noSubdivide = false, noTJunctions = false, skyFix = false, flares = false;
    bool keepLights = false, keepModels = false;
    int maxSurfaceVerts = 64;     ///< -mv, of surfaces with a lightmap
    int maxVertexLitVerts = 999;  ///< of other surfaces; at least maxSurfaceVerts
    int maxSurfaceIndexes = 6000; ///< -mi
    bool maxArea = false;         ///< -maxarea
    float nonPlanarAngle = 0;     ///< -np, degrees; above 0 merges across planes
    double normalEpsilon = 0.00005, distanceEpsilon = 0.005;
    int bevelSnap = 0;        ///< -snap
    bool snapVertices = true; ///< off with -nobrushsnap
    bool altSplit = false, deep = false;
    int metaAdequateScore = -1, metaGoodScore = -1; ///< -1: defaults of meta_merge.cpp
    std::string celShader;                          ///< full name; empty: none
    bool flat = false;
    double clipDepth = 2;
    bool noOb = false;                    ///< -noob
    std::vector<std::string> globalFlags; ///< surfaceparm names of -globalflag
    bool rename = false;
    bool customInfoParms = false;
    bool sRgbColor = false;                 ///< colors of shaders are sRGB
    std::vector<std::string> withoutEffect; ///< options given that have no effect
    bool autoCaulk = false, verboseEntities = false, fakeMap = false;
    bool debugSurfaces = false, debugInset = false, debugPortals = false, debugClip = false;
    std::string tempName; ///< -tempname: the map text is read from here and the file deleted afterwards
    int subdivisions = 8; ///< curve tolerance of patches, game units
    int maxDrawSurfaces = 131072;
};

/// Removes the options of the bsp stage from `arguments`; the game's table gives defaults. Throws what TakeSettings
/// throws.
BspOptions ParseBspOptions(Arguments &arguments, const Game &game, Log &log);

} // namespace q3
