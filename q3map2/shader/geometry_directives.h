// GPL-2.0-or-later. Directives of shader scripts that the bsp stage uses.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace q3 {

/// One step of q3map_rgbMod or q3map_alphaMod, on vertex colors as bytes.
struct ColorStep {
    enum class Kind { Set, Scale, DotProduct, DotProductScale, DotProduct2, DotProduct2Scale, Volume };
    Kind kind = Kind::Set;
    bool alpha = false;     ///< acts on alpha; else on the three colors
    Vec3f value;            ///< color (0..1) or factors, for alpha in x; direction of the dot products
    float min = 0, max = 1; ///< of the scaled dot products
};

/// q3map_surfaceModel: models scattered over a surface.
struct SurfaceModelDirective {
    std::string model;
    float density = 0, odds = 0, minScale = 1, maxScale = 1, minAngle = 0, maxAngle = 0;
    bool oriented = false;
};

/// q3map_foliage.
struct FoliageDirective {
    std::string model;
    float scale = 1, density = 0, odds = 0;
    int invertAlpha = 0; ///< 1: where alpha is low; 2: whatever alpha is
};

/// q3map_fur; off if `layers` is 0.
struct FurDirective {
    int layers = 0;
    float offset = 0, fade = 0;
};

/// Names of shaders are full names. Defaults hold where a directive is absent.
struct GeometryDirectives {
    float tessSize = 0; ///< game units; below 1: off
    float offset = 0;   ///< along the normals
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

} // namespace q3
