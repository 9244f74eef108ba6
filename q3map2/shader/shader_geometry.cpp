// GPL-2.0-or-later. Directives of shader scripts that shape surfaces.
#include "q3map2/shader/shader_geometry.h"

#include "common/text/text.h"
#include "q3map2/shader/shader_color.h"
#include "q3map2/shader/shader_parse.h"
#include "q3map2/shader/shader_table.h"

#include <algorithm>
#include <numbers>

namespace q3 {

namespace {

using Words = GeometryDirective::Words;

constexpr std::size_t kMaxSteps = 64, kMaxScattered = 64;
constexpr int kMaxTextureSide = 65536, kMaxFurLayers = 256;
constexpr float kTerrainShadeAngle = 179; // degrees; q3map_terrain smooths everything

Vec3f Vector(Words words) {
    return {Number(words[0]), Number(words[1]), Number(words[2])};
}

template <bool GeometryDirectives::*flag>
std::string SetFlag(ShaderInfo &shader, Words, const ShaderOptions &, const Game &) {
    shader.geometry.*flag = true;
    return {};
}

template <float GeometryDirectives::*field>
std::string SetNumber(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
    shader.geometry.*field = Number(words[0]);
    return {};
}

template <std::string GeometryDirectives::*name>
std::string SetShaderName(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
    shader.geometry.*name = WithoutExtension(words[0]);
    return {};
}

std::string DefaultFlare(ShaderInfo &shader, Words, const ShaderOptions &, const Game &game) {
    shader.geometry.flareShader = game.flareShader;
    return {};
}

std::string FogDir(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
    const Vec3f direction = Normalize(Vector(words));
    if (direction == Vec3f{})
        return "expected a direction";
    shader.geometry.fogDir = direction;
    return {};
}

std::string TexGen(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
    const bool inverse = EqualNoCase(words[0], "ivector");
    if (!inverse && !EqualNoCase(words[0], "vector"))
        return fmt::format("method {} is not one of vector and ivector", words[0]);
    shader.geometry.hasTexGen = true;
    shader.geometry.texGen = {Vector(words.subspan(1)), Vector(words.subspan(4))};
    if (inverse)
        for (Vec3f &v : shader.geometry.texGen)
            for (std::size_t axis = 0; axis < 3; ++axis)
                v[axis] = v[axis] != 0 ? 1 / v[axis] : 0;
    return {};
}

std::string TexMod(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
    auto &m = shader.geometry.texMod;
    const std::string method = LowerCase(words[0]);
    const float a = Number(words[1]), b = words.size() > 2 ? Number(words[2]) : 0;
    if (method == "rotate") {
        const double angle = double(a) * std::numbers::pi / 180;
        const float c = float(std::cos(angle)), s = float(std::sin(angle));
        for (auto &row : m)
            row = {row[0] * c + row[1] * s, row[1] * c - row[0] * s, row[2]};
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

std::string TextureSize(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
    const int width = IntegerFromText(words[0]), height = IntegerFromText(words[1]);
    if (std::min(width, height) < 1 || std::max(width, height) > kMaxTextureSide)
        return fmt::format("expected two sizes from 1 to {}", kMaxTextureSide);
    shader.geometry.textureWidth = width;
    shader.geometry.textureHeight = height;
    shader.geometry.textureSizeGiven = true;
    return {};
}

std::string AddColorStep(ShaderInfo &shader, bool alpha, Words words, const ShaderOptions &options) {
    struct Form {
        std::string_view name;
        ColorStep::Kind kind;
        std::size_t words;
    };
    using enum ColorStep::Kind;
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
    if (shader.geometry.colorSteps.size() >= kMaxSteps)
        return fmt::format("more than {} rgbMod and alphaMod directives in one shader", kMaxSteps);
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
    if (form->kind == Set && !alpha && options.sRgbColor)
        step.value = {LinearFromSrgb(step.value.x), LinearFromSrgb(step.value.y), LinearFromSrgb(step.value.z)};
    shader.geometry.colorSteps.push_back(step);
    return {};
}

std::string RgbMod(ShaderInfo &shader, Words words, const ShaderOptions &options, const Game &) {
    return AddColorStep(shader, false, words, options);
}
std::string AlphaMod(ShaderInfo &shader, Words words, const ShaderOptions &options, const Game &) {
    return AddColorStep(shader, true, words, options);
}

std::string Fur(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
    shader.geometry.fur = {std::clamp(IntegerFromText(words[0]), 0, kMaxFurLayers), Number(words[1]), Number(words[2])};
    return {};
}

std::string SurfaceModel(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
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
    if (shader.geometry.surfaceModels.size() < kMaxScattered)
        shader.geometry.surfaceModels.push_back(model);
    return {};
}

std::string Foliage(ShaderInfo &shader, Words words, const ShaderOptions &, const Game &) {
    const FoliageDirective foliage{.model = std::string(words[0]),
                                   .scale = Number(words[1]),
                                   .density = Number(words[2]),
                                   .odds = Number(words[3]),
                                   .invertAlpha = IntegerFromText(words[4])};
    if (foliage.density <= 0)
        return "expected a density above 0";
    if (shader.geometry.foliage.size() < kMaxScattered)
        shader.geometry.foliage.push_back(foliage);
    return {};
}

using G = GeometryDirectives;
constexpr std::array<GeometryDirective, 34> kDirectives{{
    {"tesssize", 1, 0, SetNumber<&G::tessSize>},
    {"q3map_tesssize", 1, 0, SetNumber<&G::tessSize>},
    {"q3map_offset", 1, 0, SetNumber<&G::offset>},
    {"polygonoffset", 0, 0, SetFlag<&G::polygonOffset>},
    {"fogparms", 0, 0, SetFlag<&G::hasFogParms>},
    {"q3map_fogdir", 3, 0, FogDir},
    {"q3map_nofog", 0, 0, SetFlag<&G::noFog>},
    {"q3map_invert", 0, 0, SetFlag<&G::invert>},
    {"q3map_noclip", 0, 0, SetFlag<&G::noClip>},
    {"q3map_notjunc", 0, 0, SetFlag<&G::noTJunctions>},
    {"q3map_forcemeta", 0, 0, SetFlag<&G::forceMeta>},
    {"q3map_nonplanar", 0, 0, SetFlag<&G::nonPlanar>},
    {"q3map_indexed", 0, 0, SetFlag<&G::indexed>},
    {"q3map_clipmodel", 0, 0, SetFlag<&G::clipModel>},
    {"q3map_globaltexture", 0, 0, SetFlag<&G::globalTexture>},
    {"q3map_cloneshader", 1, 0, SetShaderName<&G::cloneShader>},
    {"q3map_backshader", 1, 0, SetShaderName<&G::backShader>},
    {"q3map_remapshader", 1, 0, SetShaderName<&G::remapShader>},
    {"q3map_flare", 1, 0, SetShaderName<&G::flareShader>},
    {"q3map_flareshader", 1, 0, SetShaderName<&G::flareShader>},
    {"damageshader", 1, 1, SetShaderName<&G::damageShader>},
    {"light", 0, 1, DefaultFlare},
    {"q3map_tcgen", 7, 0, TexGen},
    {"q3map_tcmod", 2, 1, TexMod},
    {"q3map_texturesize", 2, 0, TextureSize},
    {"q3map_rgbgen", 1, 5, RgbMod},
    {"q3map_rgbmod", 1, 5, RgbMod},
    {"q3map_colorgen", 1, 5, RgbMod},
    {"q3map_colormod", 1, 5, RgbMod},
    {"q3map_alphagen", 1, 5, AlphaMod},
    {"q3map_alphamod", 1, 5, AlphaMod},
    {"q3map_fur", 3, 0, Fur},
    {"q3map_surfacemodel", 8, 0, SurfaceModel},
    {"q3map_foliage", 5, 0, Foliage},
}};

} // namespace

float Number(std::string_view word) {
    return float(std::clamp(NumberFromText(word), -kMaxNumber, kMaxNumber));
}

const GeometryDirective *FindGeometryDirective(std::string_view name) {
    const auto found = std::find_if(kDirectives.begin(), kDirectives.end(),
                                    [&](const GeometryDirective &directive) { return directive.name == name; });
    return found == kDirectives.end() ? nullptr : &*found;
}

void ApplyDeform(ShaderInfo &shader, std::span<const std::string_view> words) {
    const std::string kind = LowerCase(words[0]);
    if (kind.starts_with("autosprite")) {
        shader.autosprite = true;
        shader.geometry.autosprite2 = kind == "autosprite2";
        shader.compileFlags |= C_DETAIL;
    }
    if (kind == "move" && words.size() >= 7) { // x y z function base amplitude
        const Vec3f way = Vector(words.subspan(1));
        const Vec3f from = way * Number(words[5]), to = from + way * Number(words[6]);
        shader.geometry.move = {Min(from, to), Max(from, to)};
    }
}

void ApplyTerrain(ShaderInfo &shader) {
    GeometryDirectives &geometry = shader.geometry;
    geometry.terrain = geometry.noClip = geometry.noTJunctions = geometry.indexed = true;
    geometry.nonPlanar = geometry.forceMeta = true;
    shader.lightmap.shadeAngle = kTerrainShadeAngle;
}

} // namespace q3
