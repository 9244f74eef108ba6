// GPL-2.0-or-later. Parsed shaders: their properties, by name.
#pragma once

#include "common/image/image.h"
#include "common/log.h"
#include "libs/math/vec.h"
#include "q3map2/shader/games.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace q3 {

/// One step of q3map_rgbMod or q3map_alphaMod, on vertex colors as bytes.
struct ColorStep {
    /// The method words; help of q3map_rgbMod (shader_geometry.cpp) has the formulas.
    enum class Kind { Set, Scale, DotProduct, DotProductScale, DotProduct2, DotProduct2Scale, Volume };
    Kind kind = Kind::Set;
    bool alpha = false;     ///< acts on alpha; else on the three colors
    Vec3f value;            ///< color (0..1) or factors, for alpha in x; direction of the dot products
    float min = 0, max = 1; ///< of the scaled dot products
};

/// q3map_surfaceModel: models scattered over a surface.
struct SurfaceModelDirective {
    std::string model;
    float density = 0; ///< longest edge of the pieces that get a model each, game units
    float odds = 0;    ///< probability of a model, times alpha
    float minScale = 1, maxScale = 1;
    float minAngle = 0, maxAngle = 0; ///< degrees
    bool oriented = false;            ///< stands on the normal; else upright
};

/// q3map_foliage.
struct FoliageDirective {
    std::string model;
    float scale = 1, density = 0, odds = 0; ///< density and odds as in SurfaceModelDirective
    int invertAlpha = 0;                    ///< 1: where alpha is low; 2: whatever alpha is
};

/// q3map_fur; off if `layers` is 0.
struct FurDirective {
    int layers = 0;
    float offset = 0; ///< between layers, game units
    float fade = 0;   ///< loss of alpha by layer, 0 to 1
};

/// Directives that shape surfaces; flags have the names of theirs. Names of shaders are full names. Defaults hold where
/// a directive is absent.
struct GeometryDirectives {
    float tessSize = 0; ///< game units; below 1: off
    float offset = 0;   ///< along the normals, game units
    bool polygonOffset = false, autosprite2 = false, invert = false, noClip = false, noTJunctions = false;
    bool forceMeta = false, nonPlanar = false, indexed = false, terrain = false, clipModel = false;
    bool globalTexture = false, noFog = false;
    bool hasFogParms = false;    ///< brushes with this shader are fog volumes
    std::optional<Vec3f> fogDir; ///< unit
    std::string cloneShader, backShader, damageShader, remapShader, flareShader;
    bool hasTexGen = false; ///< s = p . texGen[0], t = p . texGen[1]
    std::array<Vec3f, 2> texGen{};
    std::array<std::array<float, 3>, 2> texMod{{{1, 0, 0}, {0, 1, 0}}}; ///< s' = row 0 . (s, t, 1), t' = row 1
    std::vector<ColorStep> colorSteps;                                  ///< in order
    std::optional<std::pair<Vec3f, Vec3f>> move; ///< deformVertexes move: corners of the box that points move in
    FurDirective fur;
    std::vector<SurfaceModelDirective> surfaceModels; ///< as listed
    std::vector<FoliageDirective> foliage;
    /// Texels of the shader's image, or q3map_textureSize: what texture axes of brush sides are divided by. Only known
    /// with ShaderOptions::imageSizes.
    int textureWidth = 64, textureHeight = 64;
    bool textureSizeGiven = false;

    /// Brushes with this shader change the colors of vertices inside them.
    bool IsColorVolume() const { return !colorSteps.empty() && colorSteps.front().kind == ColorStep::Kind::Volume; }
};

/// q3map_sun, q3map_sunExt, sun.
struct SunDirective {
    Vec3f direction;        ///< unit, toward the sun
    Vec3f color;            ///< largest component 1
    float photons = 0;      ///< light on a surface that faces it, 255 is full; may be negative
    float deviance = 0;     ///< radians
    int samples = 1;        ///< suns that it is split into, within the deviance
    float filterRadius = 0; ///< game units
    int style = 0;          ///< light style
};

/// q3map_skyLight.
struct SkyLightDirective {
    float value = 0;                     ///< V of the help: light on an open floor is 0.5 to 0.63 of it
    int iterations = 2;                  ///< N of the help: 4 (N - 1)^2 + 1 suns
    int horizonMin = 0, horizonMax = 90; ///< elevations of the suns, degrees
    bool sampleColor = true;             ///< colors are those of the sky images; else that of the shader
};

/// Directives about lightmaps and vertex light.
struct LightmapDirectives {
    int sampleSize = 0;            ///< q3map_lightmapSampleSize; 0: unset
    float sampleOffset = 0;        ///< q3map_lightmapSampleOffset; 0: unset
    Vec3f axis;                    ///< q3map_lightmapAxis; zero: unset
    std::array<int, 2> pageSize{}; ///< q3map_lightmapSize; 0: unset
    float brightness = 1;          ///< q3map_lightmapBrightness, q3map_lightmapGamma; multiplies -brightness
    bool mergable = false, splotchFix = false, noDirt = false, noVertexLight = false;
    float shadeAngle = 0;    ///< q3map_shadeAngle, degrees
    std::string normalImage; ///< q3map_normalImage, without extension
    std::string ssbumpImage; ///< q3map_ssbumpImage, without extension; not used if there is a normalImage
    std::string macroImage;  ///< q3map_macroTexture, without extension; "none": none, empty: that of the world
    std::optional<bool> rnm; ///< q3map_rnm, q3map_noRnm: whether -rnm makes basis maps for it
    /// q3map_floodLight; none while the intensity is 0. The largest component of the color is 1.
    Vec3f floodColor;
    float floodDistance = 0, floodIntensity = 0, floodDirectionScale = 1;
};

/// How shader scripts and images are interpreted, beyond the game's table.
struct ShaderOptions {
    bool sRgbColor = false;          ///< colors of lights and shaders are sRGB
    float backsplashScale = 1;       ///< multiplies the default fraction
    float backsplashDistance = -999; ///< replaces the default 23 when >= -900
    bool imageSizes = false;         ///< for the bsp stage: sizes of images; pixels only where flares need a color
    bool customInfoParms = false;    ///< read custinfoparms.txt in Game::shaderDir
    bool noOb = false;               ///< surfaceparm noob for all shaders without ob
    std::vector<std::string> globalFlags{}; ///< surfaceparms whose surface flags all shaders get
};

/// One shader with everything that the bsp and light stages need. Defaults are those of a shader that no script
/// defines.
struct ShaderInfo {
    std::string name;
    bool defined = false; ///< by a script
    std::uint32_t surfaceFlags = 0, contentFlags = 1, compileFlags = C_SOLID;

    float surfaceLight = 0;                                    ///< q3map_surfacelight
    float backsplashFraction = 0.05f, backsplashDistance = 23; ///< q3map_backsplash; distance in game units
    float bounceScale = 1;                                     ///< factor of the light that surfaces reflect
    float lightSubdivide = 0;                                  ///< game units; 0: unset
    int lightStyle = 0;
    float vertexScale = 1;                                 ///< factor of the light of vertices
    float lightmapFilterRadius = 0, lightFilterRadius = 0; ///< q3map_lightmapFilterRadius OWN OTHERS, game units
    LightmapDirectives lightmap;
    GeometryDirectives geometry;
    bool twoSided = false;       ///< cull none / disable / twosided
    bool autosprite = false;     ///< deformVertexes autosprite...
    bool normalMapStage = false; ///< a stage names a normal map
    bool noFast = false;         ///< q3map_noFast
    bool forceSunlight = false;  ///< q3map_forceSunlight
    std::vector<SunDirective> suns;
    std::vector<SkyLightDirective> skyLights;
    std::string skyImageBase; ///< skyParms base, without _up etc.; empty: none

    // From the image; see ShaderLibrary::Get for when it is read.
    Vec3f color{1, 1, 1}; ///< light color: q3map_lightRGB, else the light image's mean; largest component 1
    Vec3f averageColor{255, 255, 255};       ///< 0..255: q3map_lightRGB, else the mean of the light image
    std::shared_ptr<const Image> lightImage; ///< never null once looked up; 64 x 64 white when no file was found
    bool imageFound = false;                 ///< false: lightImage is the white default
    std::string scriptText; ///< the body in braces, tidied; empty if no script defines what the engine draws
    std::string implicitMap, implicitMask, implicitBlend; ///< images without extension; empty: none
};

/// A line below the suns of its shader, which do not use what it sets.
struct LateLine {
    std::string directive, location;
};

/// A shader and the names of the images that give its colors: without extension, empty if not given.
struct ParsedShader {
    ShaderInfo info;
    std::string editorImage, lightImage, implicitImage;
    std::optional<std::string> body; ///< source of info.scriptText, which is made at look-up; empty: already made
    std::string replacement;         ///< q3map_deprecateShader
    int linesRead = 0;               ///< directives so far that q3map_baseShader would replace
    std::vector<LateLine> lateLines; ///< below the last sun, for WarnOfLateLines
    bool lightImageGiven = false;    ///< lightImage is that of q3map_lightImage
    bool builtInImage = false;       ///< a stage draws an image of the engine, such as $whiteimage
    bool hasBspFlags = false;        ///< no script defines it; flags are those of a .bsp
    bool colorGiven = false;         ///< q3map_lightRGB: info.color is final
    bool lookedUp = false;           ///< returned by ShaderLibrary::Get
    bool imagesReady = false;        ///< light image and colors are in info
};

/// All shaders by name. References stay valid as long as the table.
class ShaderTable {
  public:
    ShaderTable(const Game &game, const ShaderOptions &options);

    const Game &GameRules() const { return game_; }
    const ShaderOptions &Options() const { return options_; }

    /// A shader with the defaults of the game and the command line.
    ParsedShader MakeDefault(std::string_view name) const;
    /// Adds a script's definition; a name that is there already keeps the first one.
    void Define(std::unique_ptr<ParsedShader> shader);
    /// The definition of that name (without extension, case-insensitive) or of what replaces it, or null.
    const ParsedShader *Find(std::string_view name, Log &log) const;
    /// The same; an unknown name is added as an implicit shader.
    ParsedShader &FindOrAdd(std::string_view name, Log &log);
    /// Number of shaders that scripts define.
    std::size_t DefinedCount() const { return definedCount_; }
    static constexpr std::size_t kMaxCustomParms = 256; ///< limit of this program, chosen
    /// One more surfaceparm, after those of the game; false: there are too many.
    bool AddCustomParm(std::string name, std::uint32_t contentFlags, std::uint32_t surfaceFlags);
    /// Flags that the command line gives to all shaders.
    void ApplyGlobalFlags(ShaderInfo &info) const;
    /// Calls visit for each shader, in no particular order.
    void ForEach(const std::function<void(ParsedShader &)> &visit);

  private:
    std::string FollowReplacements(std::string_view name, Log &log) const;

    Game game_;
    ShaderOptions options_;
    std::uint32_t globalFlags_ = 0;                                          ///< surface flags for all shaders
    std::deque<std::string> customNames_;                                    ///< parms refer to them
    std::unordered_map<std::string, std::unique_ptr<ParsedShader>> shaders_; ///< by lower-case name
    std::size_t definedCount_ = 0;
};

/// What the names of the images of a sky have after ShaderInfo::skyImageBase: left, right, front, back, up, down.
inline constexpr std::array<const char *, 6> kSkyImageSides = {"_lf", "_rt", "_ft", "_bk", "_up", "_dn"};

/// Copy up to the last '.' that follows the last slash.
std::string WithoutExtension(std::string_view name);

} // namespace q3
