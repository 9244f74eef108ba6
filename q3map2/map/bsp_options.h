// GPL-2.0-or-later. Options of the bsp stage, and the context of its steps: options, game files, log.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/shader/games.h"
#include "q3map2/shader/shader_library.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Largest edge of a luxel, game units.
inline constexpr int kMaxSampleSize = 16384;

/// Declared, with units and ranges, in bsp_options.cpp.
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
    int metaAdequateScore = -1, metaGoodScore = -1; ///< -1: defaults of meta.cpp
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

/// Every option of the bsp stage but the ones that all stages accept.
std::vector<SettingGroup<BspOptions>> BspSettings();

/// Where the entities and primitives of a map source begin, for messages.
class MapPlaces {
  public:
    /// `primitive`: -1 for the entity itself. `location`: FILE:LINE.
    void Set(int entity, int primitive, std::string location);
    /// Of the primitive, else of its entity; empty: unknown.
    std::string_view Of(int entity, int primitive) const;

  private:
    std::vector<std::vector<std::string>> places_; ///< by entity; of itself first, then of its primitives
};

/// Options, game files and log of a compile.
struct BspContext {
    const BspOptions &options;
    const Game &game;
    ShaderLibrary &shaders;
    Log &log;
    const VirtualFileSystem *vfs = nullptr; ///< for models, skins and index maps; null: none are found
    std::shared_ptr<MapPlaces> places = std::make_shared<MapPlaces>(); ///< set by the reader of the map source
    std::string leakFile{};    ///< path of the .lin that shows a leak, for messages; empty: none is written
    bool findsRegions = false; ///< CompiledMap::regions are wanted

    /// Warns "Entity E, Brush B: FILE:LINE: text"; `primitive` -1: about the entity, without a brush. `location`
    /// replaces the line where the primitive begins; "": none is printed. A connected editor selects the primitive.
    void WarnAt(std::string_view kind, int entity, int primitive, std::string_view text,
                std::optional<std::string_view> location = {}) const;
    /// Throws Error with such a text.
    [[noreturn]] void FailAt(int entity, int primitive, std::string_view text,
                             std::optional<std::string_view> location = {}) const;

  private:
    std::string Located(int entity, int primitive, std::string_view text,
                        std::optional<std::string_view> location) const;
};

} // namespace q3
