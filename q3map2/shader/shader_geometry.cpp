// GPL-2.0-or-later. Directives of shader scripts that shape surfaces.
#include "q3map2/shader/shader_geometry.h"

#include "common/text/text.h"
#include "q3map2/shader/image_formats.h"
#include "q3map2/shader/shader_directive.h"

#include <algorithm>
#include <numbers>

namespace q3 {

namespace {

using Words = DirectiveWords;
using Context = DirectiveContext;

// Limits of this program for a shader, chosen.
constexpr std::size_t kMaxColorSteps = 64, kMaxScattered = 64; ///< scattered: models or foliage
constexpr int kMaxTextureSide = 65536, kMaxFurLayers = 256;    ///< side: texels
constexpr float kTerrainShadeAngle = 179;                      // degrees; q3map_terrain smooths everything

Vec3f Vector(Words words) {
    return {Number(words[0]), Number(words[1]), Number(words[2])};
}

template <bool GeometryDirectives::*flag> std::string GeometryFlag(Context &c, Words) {
    c.shader.info.geometry.*flag = true;
    return {};
}

template <float GeometryDirectives::*field> std::string GeometryNumber(Context &c, Words words) {
    c.shader.info.geometry.*field = Number(words[0]);
    return {};
}

std::string DefaultFlare(Context &c, Words) {
    c.shader.info.geometry.flareShader = c.table.GameRules().flareShader;
    return {};
}

std::string FogDir(Context &c, Words words) {
    const Vec3f direction = Normalize(Vector(words));
    if (direction == Vec3f{})
        return "expected a direction";
    c.shader.info.geometry.fogDir = direction;
    return {};
}

std::string TexGen(Context &c, Words words) {
    const bool isInverse = EqualNoCase(words[0], "ivector");
    if (!isInverse && !EqualNoCase(words[0], "vector"))
        return fmt::format("method {} is not one of vector and ivector", words[0]);
    c.shader.info.geometry.hasTexGen = true;
    c.shader.info.geometry.texGen = {Vector(words.subspan(1)), Vector(words.subspan(4))};
    if (isInverse)
        for (Vec3f &v : c.shader.info.geometry.texGen)
            for (std::size_t axis = 0; axis < 3; ++axis)
                v[axis] = v[axis] != 0 ? 1 / v[axis] : 0;
    return {};
}

std::string TexMod(Context &c, Words words) {
    auto &m = c.shader.info.geometry.texMod;
    const std::string method = LowerCase(words[0]);
    const float a = Number(words[1]), b = words.size() > 2 ? Number(words[2]) : 0;
    if (method == "rotate") {
        const double angle = double(a) * std::numbers::pi / 180;
        const float cosine = float(std::cos(angle)), sine = float(std::sin(angle));
        for (auto &row : m) // times the rotation ( cos -sin ; sin cos ) of s and t
            row = {row[0] * cosine + row[1] * sine, row[1] * cosine - row[0] * sine, row[2]};
        return {};
    }
    const bool moves = method == "translate" || method == "shift" || method == "offset";
    if (!moves && method != "scale")
        return fmt::format("method {} is not one of translate, shift, offset, scale and rotate", words[0]);
    if (words.size() < 3)
        return fmt::format("{} needs two numbers", words[0]);
    if (moves) {
        m[0][2] += a;
        m[1][2] += b;
    } else {
        m[0][0] *= a;
        m[1][1] *= b;
    }
    return {};
}

std::string TextureSize(Context &c, Words words) {
    const int width = IntegerFromText(words[0]), height = IntegerFromText(words[1]);
    if (std::min(width, height) < 1 || std::max(width, height) > kMaxTextureSide)
        return fmt::format("expected two sizes from 1 to {}", kMaxTextureSide);
    c.shader.info.geometry.textureWidth = width;
    c.shader.info.geometry.textureHeight = height;
    c.shader.info.geometry.textureSizeGiven = true;
    return {};
}

/// The channels that a step changes.
enum class StepChannels { Color, Alpha };

std::string AddColorStep(Context &c, StepChannels channels, Words words) {
    struct Form {
        std::string_view name;
        ColorStep::Kind kind;
        std::size_t words;
    };
    using enum ColorStep::Kind;
    const bool alpha = channels == StepChannels::Alpha;
    const std::size_t count = alpha ? 1 : 3;
    const std::array<Form, 8> forms{{{"set", Set, count},
                                     {"const", Set, count},
                                     {"scale", Scale, count},
                                     {"dotproduct", DotProduct, 3},
                                     {"dotproductscale", DotProductScale, 5},
                                     {"dotproduct2", DotProduct2, 3},
                                     {"dotproduct2scale", DotProduct2Scale, 5},
                                     {"volume", Volume, 0}}};
    const std::string name = LowerCase(words[0]);
    const auto form = std::find_if(forms.begin(), forms.end(), [&](const Form &f) { return f.name == name; });
    if (form == forms.end())
        return fmt::format("unknown method {}", words[0]);
    const Words values = words.subspan(1);
    if (values.size() < form->words)
        return fmt::format("{} with {} numbers, expected {}", words[0], values.size(), form->words);
    if (c.shader.info.geometry.colorSteps.size() >= kMaxColorSteps)
        return fmt::format("more than {} rgbMod and alphaMod directives in one shader", kMaxColorSteps);
    if (form->kind == Volume && !c.shader.info.geometry.colorSteps.empty())
        return "volume has no effect here: it must stand in the first rgbMod or alphaMod line of the shader";
    ColorStep step{.kind = form->kind, .alpha = alpha, .value = {}};
    if (form->words == 1)
        step.value.x = Number(values[0]);
    else if (form->words >= 3)
        step.value = Vector(values);
    if (form->words == 5) {
        step.min = Number(values[3]);
        step.max = Number(values[4]);
        if (step.min == step.max)
            return "the two limits are equal";
    }
    if (form->kind == Set && !alpha && c.table.Options().sRgbColor)
        step.value = {LinearFromSrgb(step.value.x), LinearFromSrgb(step.value.y), LinearFromSrgb(step.value.z)};
    c.shader.info.geometry.colorSteps.push_back(step);
    return {};
}

std::string RgbMod(Context &c, Words words) {
    return AddColorStep(c, StepChannels::Color, words);
}
std::string AlphaMod(Context &c, Words words) {
    return AddColorStep(c, StepChannels::Alpha, words);
}

std::string Fur(Context &c, Words words) {
    c.shader.info.geometry.fur = {std::clamp(IntegerFromText(words[0]), 0, kMaxFurLayers), Number(words[1]),
                                  Number(words[2])};
    return {};
}

std::string SurfaceModel(Context &c, Words words) {
    const SurfaceModelDirective model{.model = std::string(words[0]),
                                      .density = Number(words[1]),
                                      .odds = Number(words[2]),
                                      .minScale = Number(words[3]),
                                      .maxScale = Number(words[4]),
                                      .minAngle = Number(words[5]),
                                      .maxAngle = Number(words[6]),
                                      .oriented = words[7].starts_with('1')};
    if (model.density <= 0)
        return "expected a density above 0";
    if (c.shader.info.geometry.surfaceModels.size() < kMaxScattered)
        c.shader.info.geometry.surfaceModels.push_back(model);
    return {};
}

std::string Foliage(Context &c, Words words) {
    const FoliageDirective foliage{.model = std::string(words[0]),
                                   .scale = Number(words[1]),
                                   .density = Number(words[2]),
                                   .odds = Number(words[3]),
                                   .invertAlpha = IntegerFromText(words[4])};
    if (foliage.density <= 0)
        return "expected a density above 0";
    if (c.shader.info.geometry.foliage.size() < kMaxScattered)
        c.shader.info.geometry.foliage.push_back(foliage);
    return {};
}

using Geometry = GeometryDirectives;

constexpr std::array kShape = std::to_array<ShaderDirective>({
    {{.name = "q3map_tessSize",
      .aliases = {"tessSize"},
      .values = "N",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "off",
      .help = "Cuts brush faces by a grid of this size, so that vertex light and moving textures get finer",
      .details = "A size below 1 turns it off. Skies are never cut, and `-nosubdivide` cuts nothing.",
      .since = "q3map2",
      .example = "64"},
     "bsp",
     GeometryNumber<&Geometry::tessSize>},
    {{.name = "q3map_offset",
      .values = "F",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "0",
      .help = "Moves every vertex of the surface along its normal",
      .since = "q3map2",
      .example = "1"},
     "bsp",
     GeometryNumber<&Geometry::offset>},
    {{.name = "q3map_forceMeta",
      .help = "Merges and smooths surfaces and models as -meta does, also without -meta",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::forceMeta>},
    {{.name = "q3map_nonPlanar",
      .help = "Lets faces of several planes become one surface under -meta, which bends over edges",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::nonPlanar>},
    {{.name = "q3map_noTjunc",
      .help = "Leaves edges as they are where the corner of another surface touches them",
      .details = "The corners of these surfaces do not change the edges of others either.",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::noTJunctions>},
    {{.name = "q3map_noClip",
      .help = "Draws brush faces in one piece with their hidden parts, as the triangles of terrain need it",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::noClip>},
    {{.name = "polygonOffset",
      .help = "Keeps a face that coincides with another one, and the other one behind it",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::polygonOffset>},
    {{.name = "q3map_invert",
      .help = "Turns surfaces around, so that their normals and their front sides are reversed",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::invert>},
    {{.name = "q3map_clipModel",
      .help = "Gives models with this material clip brushes, so that players do not walk through them",
      .details = "The option `-clipdepth` and the key `_clipdepth` set the thickness of the brushes.",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::clipModel>},
    {{.name = "q3map_indexed",
      .help = "Replaces the shader of terrain by the shaders of the entity's index map",
      .details = "The keys `_indexmap`, `_layers`, `_shader` and `_offsets` of the entity define them.",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::indexed>},
});

constexpr std::array kTexture = std::to_array<ShaderDirective>({
    {{.name = "q3map_globalTexture",
      .help = "Keeps texture coordinates that are far from 0, so that a moving texture fits across surfaces",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::globalTexture>},
    {{.name = "q3map_tcGen",
      .values = "vector|ivector SX SY SZ TX TY TZ",
      .kind = SettingKind::Text,
      .initial = "as in the map",
      .help = "Computes texture coordinates from the position p as p·S and p·T",
      .details = "With ivector, 1/x of each number counts, so 256 is a repeat per 256 game units, and 0 stays 0.",
      .since = "q3map2",
      .example = "ivector ( 256 0 0 ) ( 0 256 0 )"},
     "bsp",
     TexGen},
    {{.name = "q3map_tcMod",
      .values = "METHOD A [B]",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Changes texture coordinates by translate S T, scale S T or rotate DEGREES",
      .details = "The words shift and offset mean the same as translate. Several lines combine.",
      .since = "q3map2",
      .example = "scale 2 2"},
     "bsp",
     TexMod},
    {{.name = "q3map_textureSize",
      .values = "W H",
      .kind = SettingKind::Integer,
      .unit = "texels",
      .initial = "those of the image",
      .help = "Sets the size of the texture by which texture coordinates of brush faces count: 1 to 65536",
      .details = "It serves images with a better resolution than those that the map was made with.",
      .since = "q3map2",
      .example = "256 256"},
     "bsp",
     TextureSize},
    {{.name = "q3map_rgbMod",
      .aliases = {"q3map_rgbGen", "q3map_colorMod", "q3map_colorGen"},
      .values = "METHOD [X] [Y] [Z] [MIN] [MAX]",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Changes the colors of vertices, where several lines act one after the other",
      .details =
          "The methods `set R G B` and `const R G B` replace the color, and `scale R G B` multiplies it. For the "
          "others, d is normal · (X Y Z). The method `dotProduct X Y Z` multiplies by d, and `dotProductScale X Y Z "
          "MIN MAX` by (d − MIN)/(MAX − MIN). The methods `dotProduct2` and `dotProduct2Scale` do the same with d². "
          "The method `volume` in the first of these lines makes the brush a volume, and the other lines act on "
          "vertices inside it. The light stage replaces colors by light unless the shader has `q3map_noVertexLight`.",
      .since = "q3map2",
      .example = "set ( 0.5 0.5 0.5 )"},
     "bsp",
     RgbMod},
    {{.name = "q3map_alphaMod",
      .aliases = {"q3map_alphaGen"},
      .values = "METHOD [X] [Y] [Z] [MIN] [MAX]",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Changes the alpha of vertices by the methods of q3map_rgbMod, with one number for set and scale",
      .details = "Alpha stays when the map is lit. The line `q3map_alphaMod dotProduct2 ( 0 0 1 )` makes slopes "
                 "transparent, for terrain of blended textures.",
      .since = "q3map2",
      .example = "dotProduct2 ( 0 0 1 )"},
     "bsp",
     AlphaMod},
});

constexpr std::array kExtra = std::to_array<ShaderDirective>({
    {{.name = "fogParms",
      .help = "Makes brushes with this shader fog volumes, whose color and depth the engine reads",
      .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::hasFogParms>},
    {{.name = "q3map_fogDir",
      .values = "X Y Z",
      .kind = SettingKind::Number,
      .initial = "by side",
      .help = "Makes the side whose normal is most opposed to this direction the visible side of a fog volume",
      .since = "q3map2",
      .example = "( 0 0 -1 )"},
     "bsp",
     FogDir},
    {{.name = "q3map_noFog", .help = "Keeps fog off these surfaces", .since = "q3map2"},
     "bsp",
     GeometryFlag<&Geometry::noFog>},
    {{.name = "q3map_flareShader",
      .aliases = {"q3map_flare"},
      .values = "SHADER",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Puts a flare with that shader on each surface, 2 units above its middle, under -flares",
      .since = "q3map2",
      .example = "textures/mymap/flare"},
     "bsp",
     SetShaderName<&Geometry::flareShader>},
    {{.name = "light",
      .values = "[N]",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Puts a flare with the game's own flare shader on each surface, under -flares",
      .details = "The number N is not read.",
      .since = "q3map2",
      .example = "1"},
     "bsp",
     DefaultFlare},
    {{.name = "q3map_cloneShader",
      .values = "SHADER",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Adds a second, identical surface with another shader",
      .since = "q3map2",
      .example = "textures/mymap/glow"},
     "bsp",
     SetShaderName<&Geometry::cloneShader>},
    {{.name = "q3map_backShader",
      .values = "SHADER",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Adds a second surface with another shader that faces the other way",
      .since = "q3map2",
      .example = "textures/mymap/water_below"},
     "bsp",
     SetShaderName<&Geometry::backShader>},
    {{.name = "q3map_fur",
      .values = "LAYERS OFFSET FADE",
      .kind = SettingKind::Number,
      .initial = "none",
      .help = "Adds layers over the surface, OFFSET game units apart, whose alpha is less by FADE (0 to 1)",
      .details = "LAYERS is from 0 to 256. The offset is multiplied by the alpha of each vertex.",
      .since = "q3map2",
      .example = "8 1 0.1"},
     "bsp",
     Fur},
    {{.name = "q3map_surfaceModel",
      .values = "MODEL DENSITY ODDS MINSCALE MAXSCALE MINANGLE MAXANGLE ORIENTED",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Scatters models over the surface, with at most 64 of these lines in a shader",
      .details =
          "The surface is cut until no edge is longer than DENSITY game units. Each piece gets a model with the "
          "probability ODDS times its alpha. The scale and the angle around the vertical axis are random within their "
          "limits. With ORIENTED 1 the model follows the normal of the surface, and with 0 it is upright.",
      .since = "q3map2",
      .example = "models/mymap/tree.md3 512 0.25 0.8 1.2 0 360 0"},
     "bsp",
     SurfaceModel},
    {{.name = "q3map_foliage",
      .values = "MODEL SCALE DENSITY ODDS ALPHA",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Scatters foliage of Enemy Territory over the surface, which engines of Quake III do not draw",
      .details = "The games sof2, jk2 and ja get no foliage, since their engines would not load it. Pieces are cut as "
                 "for `q3map_surfaceModel`. They count if they slope by less than 60 degrees and their alpha is at "
                 "least 0.75. With ALPHA 1 their alpha is inverted, and with 2 it counts as 1.",
      .since = "q3map2",
      .example = "models/mymap/grass.md3 1 48 0.5 0"},
     "bsp",
     Foliage},
});

} // namespace

void ApplyDeform(ShaderInfo &shader, std::span<const std::string_view> words) {
    const std::string kind = LowerCase(words[0]);
    if (kind.starts_with("autosprite")) {
        shader.autosprite = true;
        shader.geometry.autosprite2 = kind == "autosprite2";
        shader.compileFlags |= C_DETAIL;
    }
    if (kind == "move" && words.size() >= 7) { // x y z function base amplitude
        const Vec3f direction = Vector(words.subspan(1));
        const Vec3f from = direction * Number(words[5]), to = from + direction * Number(words[6]);
        shader.geometry.move = {Min(from, to), Max(from, to)};
    }
}

void ApplyTerrain(ShaderInfo &shader) {
    GeometryDirectives &geometry = shader.geometry;
    geometry.terrain = geometry.noClip = geometry.noTJunctions = geometry.indexed = true;
    geometry.nonPlanar = geometry.forceMeta = true;
    shader.lightmap.shadeAngle = kTerrainShadeAngle;
}

DirectiveGroup GeometryDirectiveGroup() {
    return {"Shape", "These directives change the shape of surfaces and how they are merged.", kShape};
}

DirectiveGroup TextureDirectives() {
    return {"Texture coordinates and vertex colors",
            "These directives change the texture coordinates, colors and alpha of vertices.", kTexture};
}

DirectiveGroup ExtraSurfaceDirectives() {
    return {"Fog, flares and added surfaces",
            "These directives make fog volumes, flares, and surfaces and models in addition to those of the map.",
            kExtra};
}

} // namespace q3
