// GPL-2.0-or-later. Directives of shader scripts: what surfaces are, their images, and shaders made from others.
#include "q3map2/shader/shader_directive.h"
#include "q3map2/shader/shader_geometry.h"

#include "common/text/text.h"

#include <array>

namespace q3 {

namespace {

using Words = DirectiveWords;

std::string SurfaceParmLine(DirectiveContext &c, Words words) {
    if (!c.ApplyParm(words[0]))
        c.log.Warn("unknown surfaceparm", "{}: shader {}: unknown surfaceparm {}", c.location.Text(),
                   c.shader.info.name, words[0]);
    return {};
}

std::string Cull(DirectiveContext &c, Words words) {
    const std::string side = LowerCase(words[0]);
    if (side == "none" || side == "disable" || side == "twosided")
        c.shader.info.twoSided = true;
    return {};
}

std::string DeformVertexes(DirectiveContext &c, Words words) {
    ApplyDeform(c.shader.info, words);
    return {};
}

std::string Material(DirectiveContext &c, Words words) {
    if (!c.ApplyParm("*mat_" + std::string(words[0])))
        c.log.Warn("unknown material", "{}: shader {}: unknown material {}", c.location.Text(), c.shader.info.name,
                   words[0]);
    return {};
}

std::string VertexLighting(DirectiveContext &c, Words) {
    c.ApplyParm("pointlight");
    return {};
}

template <std::string ParsedShader::*image> std::string ShaderImage(DirectiveContext &c, Words words) {
    c.shader.*image = WithoutExtension(words[0]);
    return {};
}

template <std::string ShaderInfo::*image> std::string SetImplicitImage(DirectiveContext &c, Words words) {
    c.shader.implicitImage = words[0] == "-" ? c.shader.info.name : WithoutExtension(words[0]);
    c.shader.info.*image = c.shader.implicitImage;
    return {};
}

/// Starts over from a shader defined earlier: directives before this one are lost, the name stays.
std::string BaseShader(DirectiveContext &c, Words words) {
    ParsedShader &shader = c.shader;
    const int lost = shader.linesRead;
    const ParsedShader *base = c.table.Find(words[0], c.log);
    std::string name = std::move(shader.info.name);
    shader = base ? *base : c.table.MakeDefault({});
    shader.info.name = std::move(name);
    shader.info.defined = true;
    shader.linesRead = 0;
    shader.lateLines.clear();
    if (!base)
        return fmt::format("no shader {} stands above this one in the scripts; the lines above this one are lost and "
                           "defaults are used",
                           words[0]);
    if (lost == 0)
        return {};
    return fmt::format("replaces the line{} above it, {} in all, which {} no effect; put it first",
                       lost == 1 ? "" : "s", lost, lost == 1 ? "has" : "have");
}

std::string DeprecateShader(DirectiveContext &c, Words words) {
    c.shader.replacement = words[0];
    return {};
}

constexpr std::array kSurface = std::to_array<ShaderDirective>({
    {{.name = "surfaceparm",
      .values = "NAME",
      .kind = SettingKind::Text,
      .help = "Gives surfaces and brushes a property of the game, such as nonsolid, trans, nodraw, sky or nolightmap",
      .details = "One name per line; later lines can take off what earlier ones set. The compiler itself acts on "
                 "detail, structural, trans, hint, skip, areaportal, antiportal, origin, lightgrid, nodraw, "
                 "alphashadow, lightfilter, nolightmap, pointlight, nonsolid, water, slime, lava, fog, sky, nomarks, "
                 "playerclip, monsterclip, ob and noob. Light: alphashadow lets (255 − alpha)/255 of a ray through, "
                 "lightfilter multiplies it by the color of the texel; nolightmap and pointlight surfaces are lit at "
                 "their vertices. `q3map_NAME` is the same as `surfaceparm NAME`. `-custinfoparms` adds names."},
     "both",
     SurfaceParmLine},
    {{.name = "q3map_material",
      .values = "NAME",
      .kind = SettingKind::Text,
      .help = "Gives surfaces the material NAME, which the game uses for sounds and marks",
      .details = "It sets surface flags of the games that have materials; in the others it is a warning. Light does "
                 "not change."},
     "bsp",
     Material},
    {{.name = "q3map_onlyVertexLighting",
      .help = "Lights surfaces at their vertices, without lightmaps; the same as surfaceparm pointlight"},
     "both",
     VertexLighting},
    {{.name = "cull",
      .values = "none|disable|twosided|SIDE",
      .kind = SettingKind::Text,
      .help = "With none, disable or twosided, surfaces have two sides: both are lit, and both emit light",
      .details = "Other words are for the engine only."},
     "light",
     Cull},
    {{.name = "deformVertexes",
      .values = "KIND [X] [Y] [Z] [FUNCTION] [BASE] [AMPLITUDE] [PHASE] [FREQUENCY]",
      .kind = SettingKind::Text,
      .help = "Says that the engine moves the surface: autosprite, autosprite2 and move matter to the compiler",
      .details = "An autosprite becomes detail, stays in one piece, is not merged and does not reflect light; its "
                 "`q3map_surfaceLight` makes one point light. `move X Y Z FUNCTION BASE AMPLITUDE` extends the space "
                 "in which the surface is drawn by the box from BASE to BASE + AMPLITUDE times X Y Z."},
     "both",
     DeformVertexes},
    {{.name = "qer_editorImage",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .help = "Image that editors show; texture coordinates of brush faces count its texels",
      .details = "It stands before the stages as a rule: then it is the light image as well, unless "
                 "`q3map_lightImage` names one. Other words that begin with `qer_` are for editors only."},
     "both",
     ShaderImage<&ParsedShader::editorImage>},
    {{.name = "implicitMap",
      .values = "IMAGE|-",
      .kind = SettingKind::Text,
      .help = "Image of a shader without stages, as games of the Wolfenstein family draw it; - is the shader's name"},
     "both",
     SetImplicitImage<&ShaderInfo::implicitMap>},
    {{.name = "implicitMask",
      .values = "IMAGE|-",
      .kind = SettingKind::Text,
      .help = "The same, for an image that is tested against its alpha"},
     "both",
     SetImplicitImage<&ShaderInfo::implicitMask>},
    {{.name = "implicitBlend",
      .values = "IMAGE|-",
      .kind = SettingKind::Text,
      .help = "The same, for an image that is blended by its alpha"},
     "both",
     SetImplicitImage<&ShaderInfo::implicitBlend>},
});

constexpr std::array kReplacement = std::to_array<ShaderDirective>({
    {{.name = "q3map_baseShader",
      .values = "SHADER",
      .kind = SettingKind::Text,
      .help = "Starts over from all properties of another shader; the lines that follow change them",
      .details = "Put it first: the lines before it have no effect, which is a warning. SHADER must stand earlier in "
                 "the scripts. Name and stages stay those of this shader."},
     "both",
     BaseShader},
    {{.name = "q3map_deprecateShader",
      .values = "SHADER",
      .kind = SettingKind::Text,
      .help = "Replaces this shader by another wherever it is used"},
     "both",
     DeprecateShader},
    {{.name = "q3map_remapShader",
      .values = "SHADER",
      .kind = SettingKind::Text,
      .help = "Writes another name into the .bsp; everything else is compiled as this shader says"},
     "bsp",
     SetShaderName<&GeometryDirectives::remapShader>},
    {{.name = "damageShader",
      .values = "SHADER [HEALTH]",
      .kind = SettingKind::Text,
      .help = "Adds a shader to the .bsp that the game shows when the surface is damaged"},
     "bsp",
     SetShaderName<&GeometryDirectives::damageShader>},
});

} // namespace

DirectiveGroup SurfaceDirectives() {
    return {"Surfaces and their images", "", kSurface};
}

DirectiveGroup ReplacementDirectives() {
    return {"Shaders made from others", "SHADER is a full name, such as `textures/base/wall`.", kReplacement};
}

} // namespace q3
