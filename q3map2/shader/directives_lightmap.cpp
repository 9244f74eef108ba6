// GPL-2.0-or-later. Directives of shader scripts: lightmaps and vertex light.
#include "q3map2/shader/shader_directive.h"
#include "q3map2/shader/shader_geometry.h"

#include "common/text/text.h"

#include <algorithm>
#include <array>
#include <bit>

namespace q3 {

namespace {

using Words = DirectiveWords;

constexpr int kMaxPageSide = 8192; ///< luxels

LightmapDirectives &Lightmap(DirectiveContext &c) {
    return c.shader.info.lightmap;
}

template <bool LightmapDirectives::*flag> std::string LightmapFlag(DirectiveContext &c, Words) {
    Lightmap(c).*flag = true;
    return {};
}

template <float LightmapDirectives::*field> std::string LightmapNumber(DirectiveContext &c, Words words) {
    Lightmap(c).*field = Number(words[0]);
    return {};
}

template <std::string LightmapDirectives::*image> std::string LightmapImage(DirectiveContext &c, Words words) {
    Lightmap(c).*image = WithoutExtension(words[0]);
    return {};
}

std::string MakeRnm(DirectiveContext &c, Words) {
    Lightmap(c).rnm = true;
    return {};
}

std::string MakeNoRnm(DirectiveContext &c, Words) {
    Lightmap(c).rnm = false;
    return {};
}

std::string SampleSize(DirectiveContext &c, Words words) {
    Lightmap(c).sampleSize = std::max(0, IntegerFromText(words[0]));
    return {};
}

std::string LightmapAxis(DirectiveContext &c, Words words) {
    static constexpr std::array<Vec3f, 3> kAxes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const std::size_t axis = words[0].size() == 1 ? std::string_view("xyz").find(LowerCase(words[0])) : kAxes.size();
    if (axis >= kAxes.size())
        c.log.Warn("lightmap axis", "{}: shader {}: q3map_lightmapAxis {}, expected x, y or z", c.location.Text(),
                   c.shader.info.name, words[0]);
    Lightmap(c).axis = axis < kAxes.size() ? kAxes[axis] : Vec3f{};
    return {};
}

std::string LightmapSize(DirectiveContext &c, Words words) {
    const std::array<int, 2> size = {IntegerFromText(words[0]), IntegerFromText(words[1])};
    const bool isUsable = std::all_of(size.begin(), size.end(), [](int side) {
        return side >= 2 && side <= kMaxPageSide && std::has_single_bit(unsigned(side));
    });
    if (!isUsable)
        c.log.Warn("lightmap page size",
                   "{}: shader {}: q3map_lightmapSize {} {}, expected powers of two from 2 to {}; not used",
                   c.location.Text(), c.shader.info.name, words[0], words[1], kMaxPageSide);
    Lightmap(c).pageSize = isUsable ? size : std::array<int, 2>{};
    return {};
}

std::string LightmapBrightness(DirectiveContext &c, Words words) {
    const double product = double(Lightmap(c).brightness) * double(Number(words[0]));
    Lightmap(c).brightness = product < 0 ? 1 : float(std::min(product, kMaxNumber));
    return {};
}

std::string FloodLight(DirectiveContext &c, Words words) {
    LightmapDirectives &lightmap = Lightmap(c);
    lightmap.floodColor = c.Color(words);
    lightmap.floodDistance = Number(words[3]);
    lightmap.floodIntensity = Number(words[4]);
    lightmap.floodDirectionScale = Number(words[5]);
    return {};
}

std::string Terrain(DirectiveContext &c, Words) {
    ApplyTerrain(c.shader.info);
    return {};
}

std::string VertexScale(DirectiveContext &c, Words words) {
    float &scale = c.shader.info.vertexScale;
    scale = float(std::clamp(double(scale) * double(Number(words[0])), -kMaxNumber, kMaxNumber));
    return {};
}

constexpr std::array kLightmap = std::to_array<ShaderDirective>({
    {{.name = "q3map_lightmapSampleSize",
      .values = "N",
      .kind = SettingKind::Integer,
      .unit = "game units",
      .initial = "-samplesize",
      .help = "Sets the size of a luxel, where a smaller one gives sharper shadows and more lightmaps",
      .details = "It overrides `-samplesize` and the keys of entities, but `_lightmapscale` still multiplies it. It "
                 "counts when the map is compiled, or in the light stage of a map without a `.srf`.",
      .since = "q3map2",
      .example = "8"},
     "both",
     SampleSize},
    {{.name = "q3map_lightmapSampleOffset",
      .values = "F",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "1",
      .help = "Sets how far in front of the surface the light of its luxels is computed",
      .since = "q3map2",
      .example = "2"},
     "light",
     LightmapNumber<&LightmapDirectives::sampleOffset>},
    {{.name = "q3map_lightmapAxis",
      .values = "x|y|z",
      .kind = SettingKind::Text,
      .initial = "by normal",
      .help = "Sets the axis along which the lightmap is projected onto the surface",
      .details = "Terrain usually has `z`, together with `q3map_lightmapMergable`. It counts when the map is compiled, "
                 "or in the light stage of a map without a `.srf`.",
      .since = "q3map2",
      .example = "z"},
     "both",
     LightmapAxis},
    {{.name = "q3map_lightmapSize",
      .values = "W H",
      .kind = SettingKind::Integer,
      .unit = "luxels",
      .initial = "-lightmapsize",
      .help = "Sets the size of the lightmap pages of these surfaces: powers of two from 2 to 8192",
      .details = "Pages whose size differs from that of the game are stored as images next to the map, and their "
                 "surfaces get generated shaders. The script then needs a stage with `$lightmap`.",
      .since = "q3map2",
      .example = "512 512"},
     "light",
     LightmapSize},
    {{.name = "q3map_lightmapBrightness",
      .aliases = {"q3map_lightmapGamma"},
      .values = "F",
      .kind = SettingKind::Number,
      .initial = "1",
      .help = "Multiplies the 8-bit levels of the lightmaps, after gamma",
      .details = "Both names mean the same. Several lines multiply each other. A negative product counts as 1.",
      .since = "q3map2",
      .example = "1.5"},
     "light",
     LightmapBrightness},
    {{.name = "q3map_lightmapMergable",
      .help = "Lets surfaces in several planes use one lightmap, so that light has no seams between them",
      .details = "The boxes of the surfaces must touch, and the axis of their lightmaps must be the same.",
      .since = "q3map2"},
     "light",
     LightmapFlag<&LightmapDirectives::mergable>},
    {{.name = "q3map_splotchFix",
      .help = "Gives luxels that are as dark as ambient light the light of their neighbors",
      .details = "It is meant for lightmaps on models, where luxels can be inside of other triangles.",
      .since = "q3map2"},
     "light",
     LightmapFlag<&LightmapDirectives::splotchFix>},
    {{.name = "q3map_shadeAngle",
      .values = "F",
      .kind = SettingKind::Number,
      .unit = "degrees",
      .initial = "0",
      .help = "Smooths normals across edges up to this angle, so that they look round",
      .details = "The bsp stage smooths the normals of vertices under `-meta`. The light stage smooths those of luxels "
                 "under `-shade`. With 0 the angle is that of the key `_shadeangle`, of `-np` or of `-shadeangle`.",
      .since = "q3map2",
      .example = "60"},
     "both",
     LightmapNumber<&LightmapDirectives::shadeAngle>},
    {{.name = "q3map_terrain",
      .help = "Sets everything that terrain needs",
      .details = "It is short for `q3map_noClip`, `q3map_noTjunc`, `q3map_indexed`, `q3map_nonPlanar`, "
                 "`q3map_forceMeta` and `q3map_shadeAngle 179`. Without `q3map_tcGen` it also projects the texture "
                 "from above, with two repeats per size of the image in game units.",
      .since = "q3map2"},
     "both",
     Terrain},
    {{.name = "q3map_normalImage",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names a tangent space normal map that bends the normals of luxels, so that light shows the relief",
      .details = "A texel b = (rgb − 127)/127.5 turns the normal n into n + S·b.r + T·b.g + n·b.b, where S and T are "
                 "the directions in which texture coordinates grow. An image that does not exist is a warning. Under "
                 "`-rnm` the surfaces count as normal mapped.",
      .since = "q3map2",
      .example = "textures/mymap/wall_n"},
     "light",
     LightmapImage<&LightmapDirectives::normalImage>},
    {{.name = "q3map_ssbumpImage",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names a self-shadowed bump map whose normals bend those of luxels, as q3map_normalImage does",
      .details = "The directive `q3map_normalImage` overrides it. The stage `-ssbump` makes such maps, which "
                 "[Directional light](../engines/directional.md) describes.",
      .since = "0.2.0",
      .example = "textures/mymap/wall_ssbump"},
     "light",
     LightmapImage<&LightmapDirectives::ssbumpImage>},
    {{.name = "q3map_macroTexture",
      .values = "IMAGE|none",
      .kind = SettingKind::Text,
      .initial = "that of the world",
      .help = "Names an image over the whole world, seen from above, that tints the light of these surfaces",
      .details = "The word `none` takes the macro texture of the world off these surfaces. The page [From Source or "
                 "ericw-tools](../guide/from_source_engine.md#macro-textures) has the rules.",
      .since = "0.2.0",
      .example = "textures/macro/city"},
     "light",
     LightmapImage<&LightmapDirectives::macroImage>},
    {{.name = "q3map_rnm",
      .initial = "by rule",
      .help = "Makes -rnm store basis maps for these surfaces",
      .details =
          "Without this line, [a rule](../engines/directional.md) decides by whether the shader names a normal map.",
      .since = "0.2.0"},
     "light",
     MakeRnm},
    {{.name = "q3map_noRnm",
      .initial = "by rule",
      .help = "Keeps -rnm from storing basis maps for these surfaces",
      .details = "The option `-rnmall` stores them nevertheless.",
      .since = "0.2.0"},
     "light",
     MakeNoRnm},
    {{.name = "q3map_noDirty", .help = "Keeps -dirty from darkening the corners of these surfaces", .since = "q3map2"},
     "light",
     LightmapFlag<&LightmapDirectives::noDirt>},
    {{.name = "q3map_floodLight",
      .values = "R G B DISTANCE INTENSITY SCALE",
      .kind = SettingKind::Number,
      .initial = "none",
      .help = "Adds soft light to the lightmaps of these surfaces wherever there is open space",
      .details = "A luxel that sees nothing within DISTANCE game units gets INTENSITY, in 8-bit levels. SCALE is a "
                 "factor of its weight in deluxe pages. The light is added to the floodlight of the world.",
      .since = "q3map2",
      .example = "0.9 0.95 1 512 96 1"},
     "light",
     FloodLight},
    {{.name = "q3map_styleMarker",
      .help = "Marks the place in the script where generated shaders get the stages of light styles",
      .details = "Without a marker, engines show only light of style 0 on a surface, which is a warning.",
      .since = "q3map2"},
     "light"},
    {{.name = "q3map_styleMarker2",
      .help = "Marks the same place as q3map_styleMarker, for surfaces that are tested against their alpha",
      .details = "The generated stages have `depthFunc equal`.",
      .since = "q3map2"},
     "light"},
    {{.name = "q3map_rnmMaps",
      .values = "IMAGE IMAGE IMAGE STORAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names the basis maps of -rnm for engines, in generated shaders, and has no effect when read",
      .details = "STORAGE is `raw` or `rescaled`. The page [Directional light](../engines/directional.md) "
                 "describes the images.",
      .since = "0.2.0",
      .example = "maps/mymap/lm_0000_b1 maps/mymap/lm_0000_b2 maps/mymap/lm_0000_b3 rescaled"},
     "none"},
});

constexpr std::array kVertexLight = std::to_array<ShaderDirective>({
    {{.name = "q3map_vertexScale",
      .values = "F",
      .kind = SettingKind::Number,
      .initial = "1",
      .help = "Multiplies the light of vertices, before gamma",
      .details = "Several lines multiply each other, and `-vertexscale` multiplies the light too.",
      .since = "q3map2",
      .example = "1.5"},
     "light",
     VertexScale},
    {{.name = "q3map_noVertexLight",
      .help = "Keeps vertex colors as the bsp stage wrote them, for alpha and colors set by q3map_rgbMod",
      .since = "q3map2"},
     "light",
     LightmapFlag<&LightmapDirectives::noVertexLight>},
    {{.name = "q3map_patchShadows",
      .aliases = {"q3map_vertexShadows", "q3map_noVertexShadows"},
      .help = "Is accepted and has no effect, as in NetRadiant's q3map2",
      .details = "The option `-patchshadows` of the light stage makes curves cast shadows.",
      .since = "q3map2"},
     "none"},
});

} // namespace

DirectiveGroup LightmapDirectiveGroup() {
    return {"Lightmaps", "These directives set the size, the projection and the light of lightmaps.", kLightmap};
}

DirectiveGroup VertexLightDirectives() {
    return {"Vertex light", "These directives set the light of vertices, which surfaces without a lightmap show.",
            kVertexLight};
}

} // namespace q3
