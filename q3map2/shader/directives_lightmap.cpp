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
      .help = "Size of a luxel: a smaller one gives sharper shadows and more lightmaps",
      .details = "It wins over `-samplesize` and the keys of entities, but `_lightmapscale` still multiplies it. It "
                 "counts when the map is compiled, or in the light stage of a map without `.srf`."},
     "both",
     SampleSize},
    {{.name = "q3map_lightmapSampleOffset",
      .values = "F",
      .kind = SettingKind::Number,
      .unit = "game units",
      .initial = "1",
      .help = "How far in front of the surface the light of its luxels is computed"},
     "light",
     LightmapNumber<&LightmapDirectives::sampleOffset>},
    {{.name = "q3map_lightmapAxis",
      .values = "x|y|z",
      .kind = SettingKind::Text,
      .initial = "by normal",
      .help = "Axis along which the lightmap is projected onto the surface",
      .details = "Terrain takes `z`, with `q3map_lightmapMergable`. It counts when the map is compiled, or in the "
                 "light stage of a map without `.srf`."},
     "both",
     LightmapAxis},
    {{.name = "q3map_lightmapSize",
      .values = "W H",
      .kind = SettingKind::Integer,
      .unit = "luxels",
      .initial = "-lightmapsize",
      .help = "Size of the lightmap pages of these surfaces: powers of two from 2 to 8192",
      .details = "Pages that differ in size from those of the game are images beside the map, and surfaces get "
                 "generated shaders; the script must have a stage with `$lightmap`."},
     "light",
     LightmapSize},
    {{.name = "q3map_lightmapBrightness",
      .aliases = {"q3map_lightmapGamma"},
      .values = "F",
      .kind = SettingKind::Number,
      .initial = "1",
      .help = "Multiplies the bytes of the lightmaps, after gamma; both names mean the same",
      .details = "Repeated lines multiply. A negative product counts as 1."},
     "light",
     LightmapBrightness},
    {{.name = "q3map_lightmapMergable",
      .help = "Lets surfaces in several planes share one lightmap, so that light has no seams between them",
      .details = "Their boxes must touch, and the axis of their lightmaps must be the same."},
     "light",
     LightmapFlag<&LightmapDirectives::mergable>},
    {{.name = "q3map_splotchFix",
      .help = "Gives luxels that are as dark as ambient light the light of their neighbors",
      .details = "For lightmaps on models, where luxels can lie inside others."},
     "light",
     LightmapFlag<&LightmapDirectives::splotchFix>},
    {{.name = "q3map_shadeAngle",
      .values = "F",
      .kind = SettingKind::Number,
      .unit = "degrees",
      .initial = "0",
      .help = "Edges up to this angle look round: normals are smoothed across them",
      .details = "The bsp stage smooths vertex normals by it under `-meta`; the light stage smooths those of luxels "
                 "under `-shade`. 0: `_shadeangle` of the entity, `-np` or `-shadeangle` decide."},
     "both",
     LightmapNumber<&LightmapDirectives::shadeAngle>},
    {{.name = "q3map_terrain",
      .help = "Everything that terrain needs: noclip, notjunc, indexed, nonplanar, forceMeta and a shadeAngle of 179",
      .details = "Without `q3map_tcGen` the texture lies on it from above, two repeats for each size of the image in "
                 "units."},
     "both",
     Terrain},
    {{.name = "q3map_normalImage",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Tangent space normal map that bends the normals of luxels, so that light shows the relief",
      .details = "A texel b = (rgb − 127)/127.5 turns the normal n into n + S·b.r + T·b.g + n·b.b, where S and T are "
                 "the directions in which texture coordinates grow. An image that does not exist is a warning."},
     "light",
     LightmapImage<&LightmapDirectives::normalImage>},
    {{.name = "q3map_ssbumpImage",
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "The same by the normals of a self-shadowed bump map; q3map_normalImage wins",
      .details = "[ssbump.md](ssbump.md) says how to make one."},
     "light",
     LightmapImage<&LightmapDirectives::ssbumpImage>},
    {{.name = "q3map_macroTexture",
      .values = "IMAGE|none",
      .kind = SettingKind::Text,
      .initial = "that of the world",
      .help = "Image over the whole world, seen from above, that tints the light of these surfaces",
      .details = "[from_source.md](from_source.md#macro-textures) has the rules."},
     "light",
     LightmapImage<&LightmapDirectives::macroImage>},
    {{.name = "q3map_rnm",
      .initial = "by rule",
      .help = "Makes -rnm store basis maps for these surfaces",
      .details =
          "The [rule](directional.md#which-surfaces-are-normal-mapped) is whether the shader names a normal map."},
     "light",
     MakeRnm},
    {{.name = "q3map_noRnm", .initial = "by rule", .help = "Keeps -rnm from storing basis maps for these surfaces"},
     "light",
     MakeNoRnm},
    {{.name = "q3map_noDirty", .help = "Keeps -dirty from darkening the corners of these surfaces"},
     "light",
     LightmapFlag<&LightmapDirectives::noDirt>},
    {{.name = "q3map_floodLight",
      .values = "R G B DISTANCE INTENSITY SCALE",
      .kind = SettingKind::Number,
      .initial = "none",
      .help = "Adds soft light to the lightmaps of these surfaces wherever there is open space",
      .details = "A luxel that sees nothing within DISTANCE game units gets INTENSITY of 255; SCALE is a factor on "
                 "its weight in deluxe pages. It comes on top of the floodlight of the world."},
     "light",
     FloodLight},
    {{.name = "q3map_styleMarker",
      .help = "Place in the script where generated shaders get the stages of light styles",
      .details = "Engines show no light of other styles than 0 on a surface whose script has no marker, which is a "
                 "warning."},
     "light"},
    {{.name = "q3map_styleMarker2",
      .help = "The same with depthFunc equal, for surfaces that are tested against their alpha"},
     "light"},
    {{.name = "q3map_rnmMaps",
      .values = "IMAGE IMAGE IMAGE STORAGE",
      .kind = SettingKind::Text,
      .help = "Line of generated shaders that names the basis maps for engines; it has no effect when read",
      .details = "[directional.md](directional.md) describes it."},
     "none"},
});

constexpr std::array kVertexLight = std::to_array<ShaderDirective>({
    {{.name = "q3map_vertexScale",
      .values = "F",
      .kind = SettingKind::Number,
      .initial = "1",
      .help = "Multiplies the light of vertices, before gamma",
      .details = "Repeated lines multiply, and `-vertexscale` does too."},
     "light",
     VertexScale},
    {{.name = "q3map_noVertexLight",
      .help = "Keeps vertex colors as the bsp stage wrote them, for alpha and colors set by q3map_rgbMod"},
     "light",
     LightmapFlag<&LightmapDirectives::noVertexLight>},
    {{.name = "q3map_patchShadows",
      .aliases = {"q3map_vertexShadows", "q3map_noVertexShadows"},
      .help = "Accepted; no q3map2 does anything with it. -patchshadows is the option for shadows of curves"},
     "none"},
});

} // namespace

DirectiveGroup LightmapDirectiveGroup() {
    return {"Lightmaps", "", kLightmap};
}

DirectiveGroup VertexLightDirectives() {
    return {"Vertex light", "", kVertexLight};
}

} // namespace q3
