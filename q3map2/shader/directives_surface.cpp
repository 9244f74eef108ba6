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
      .initial = "none",
      .help = "Gives surfaces and brushes a property of the game, such as nonsolid, trans, nodraw, sky or nolightmap",
      .details = "There is one name per line, and later lines can take off what earlier ones set. The compiler itself "
                 "acts on detail, structural, trans, hint, skip, areaportal, antiportal, origin, lightgrid, nodraw, "
                 "alphashadow and lightfilter. It also acts on nolightmap, pointlight, nonsolid, water, slime, lava, "
                 "fog, sky, nomarks, playerclip, monsterclip, ob and noob. With alphashadow, a surface lets the "
                 "fraction (255 − alpha)/255 of a ray through. With lightfilter, it multiplies the ray by the color of "
                 "the texel. Surfaces with nolightmap or pointlight are lit at their vertices. The directive "
                 "`q3map_NAME` is the same as `surfaceparm NAME`. The option `-custinfoparms` adds names.",
      .since = "q3map2",
      .example = "nomarks"},
     "both",
     SurfaceParmLine},
    {{.name = "q3map_material",
      .values = "NAME",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Gives surfaces the material NAME, which the game uses for sounds and marks",
      .details = "It sets surface flags in games that have materials, such as Jedi Academy. In other games it is a "
                 "warning. Light does not change.",
      .since = "q3map2",
      .example = "gravel"},
     "bsp",
     Material},
    {{.name = "q3map_onlyVertexLighting",
      .help = "Lights surfaces at their vertices, without lightmaps",
      .details = "It is the same as `surfaceparm pointlight`.",
      .since = "q3map2"},
     "both",
     VertexLighting},
    {{.name = "cull",
      .values = "none|disable|twosided|SIDE",
      .kind = SettingKind::Text,
      .initial = "one side",
      .help = "With none, disable or twosided, gives surfaces two sides that are lit and that emit light",
      .details = "Other words are for the engine only.",
      .since = "q3map2",
      .example = "none"},
     "light",
     Cull},
    {{.name = "deformVertexes",
      .values = "KIND [X] [Y] [Z] [FUNCTION] [BASE] [AMPLITUDE] [PHASE] [FREQUENCY]",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Says that the engine moves the surface, where autosprite, autosprite2 and move matter to the compiler",
      .details = "An autosprite becomes detail, stays in one piece, is not merged and does not reflect light. Its "
                 "`q3map_surfaceLight` makes one point light. The kind `move X Y Z FUNCTION BASE AMPLITUDE` extends "
                 "the space in which the surface is drawn by the box from BASE to BASE + AMPLITUDE times X Y Z.",
      .since = "q3map2",
      .example = "autosprite2"},
     "both",
     DeformVertexes},
    {{.name = "qer_editorImage",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "image with the shader's name",
      .help = "Names the image that editors show, by whose size the texture coordinates of brush faces count",
      .details = "If it comes before the stages, it is the light image as well, unless `q3map_lightImage` names one. "
                 "Other words that begin with `qer_` are for editors only.",
      .since = "q3map2",
      .example = "textures/mymap/wall"},
     "both",
     ShaderImage<&ParsedShader::editorImage>},
    {{.name = "implicitMap",
      .values = "IMAGE|-",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names the image of a shader without stages, which games of the Wolfenstein family draw",
      .details = "The word `-` is the name of the shader.",
      .since = "q3map2",
      .example = "textures/mymap/wall"},
     "both",
     SetImplicitImage<&ShaderInfo::implicitMap>},
    {{.name = "implicitMask",
      .values = "IMAGE|-",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names the image of a shader without stages, and tests it against its alpha",
      .details = "The word `-` is the name of the shader.",
      .since = "q3map2",
      .example = "textures/mymap/grate"},
     "both",
     SetImplicitImage<&ShaderInfo::implicitMask>},
    {{.name = "implicitBlend",
      .values = "IMAGE|-",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names the image of a shader without stages, and blends it by its alpha",
      .details = "The word `-` is the name of the shader.",
      .since = "q3map2",
      .example = "textures/mymap/glass"},
     "both",
     SetImplicitImage<&ShaderInfo::implicitBlend>},
});

constexpr std::array kReplacement = std::to_array<ShaderDirective>({
    {{.name = "q3map_baseShader",
      .values = "SHADER",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Takes over all properties of another shader, which the lines that follow change",
      .details = "Put it first, since lines before it have no effect, which is a warning. The other shader must be "
                 "earlier in the scripts. This shader keeps its own name and stages.",
      .since = "q3map2",
      .example = "textures/mymap/terrain_base"},
     "both",
     BaseShader},
    {{.name = "q3map_deprecateShader",
      .values = "SHADER",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Replaces this shader by another one wherever it is used",
      .since = "q3map2",
      .example = "textures/mymap/wall_new"},
     "both",
     DeprecateShader},
    {{.name = "q3map_remapShader",
      .values = "SHADER",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Writes another name into the .bsp, while everything else is compiled as this shader says",
      .since = "q3map2",
      .example = "textures/mymap/wall_drawn"},
     "bsp",
     SetShaderName<&GeometryDirectives::remapShader>},
    {{.name = "damageShader",
      .values = "SHADER [HEALTH]",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Adds a shader to the .bsp that the game shows when the surface is damaged",
      .details = "HEALTH is for the game only.",
      .since = "q3map2",
      .example = "textures/mymap/glass_broken 50"},
     "bsp",
     SetShaderName<&GeometryDirectives::damageShader>},
});

} // namespace

DirectiveGroup SurfaceDirectives() {
    return {"Surfaces and their images", "These directives say what surfaces are and which images they show.",
            kSurface};
}

DirectiveGroup ReplacementDirectives() {
    return {"Shaders made from others",
            "These directives name another shader by its full name, such as `textures/base/wall`.", kReplacement};
}

} // namespace q3
