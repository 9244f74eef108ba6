// GPL-2.0-or-later. The table of words that shader scripts may hold; the parser and the documentation use it.
#include "q3map2/shader/shader_directive.h"

#include "common/text/text.h"
#include "q3map2/shader/image_formats.h"

#include <algorithm>
#include <array>

namespace q3 {

// ---- The table of words that shader scripts may hold ----

namespace {

/// Whether both words are equal, whatever their case. Most differ in length or in their first letter, which is cheap to
/// test.
bool IsWord(std::string_view word, std::string_view name) {
    constexpr int kCaseBit = 0x20; // of ASCII letters
    return word.size() == name.size() && (word[0] | kCaseBit) == (name[0] | kCaseBit) && EqualNoCase(word, name);
}

bool HasName(const SettingInfo &info, std::string_view word) {
    return IsWord(word, info.name) || std::ranges::any_of(info.aliases, [&](std::string_view alias) {
               return !alias.empty() && IsWord(word, alias);
           });
}

constexpr std::array kGroups = {SkyDirectives,          EmissionDirectives, LightmapDirectiveGroup,
                                VertexLightDirectives,  SurfaceDirectives,  ReplacementDirectives,
                                GeometryDirectiveGroup, TextureDirectives,  ExtraSurfaceDirectives};

constexpr std::array kStageWords = std::to_array<StageWordEntry>({
    {{.name = "map",
      .aliases = {"clampMap", "mapComp", "mapNoComp"},
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names the image of the stage, which is the light image if it is the first and no other is named",
      .details = "Names that begin with `$` or `*` are images of the engine and are skipped. After `qer_editorImage`, "
                 "`q3map_lightImage` or an `implicitMap` no stage gives the light image.",
      .since = "q3map2",
      .example = "textures/mymap/wall.tga"},
     StageWord::Image},
    {{.name = "animMap",
      .aliases = {"clampAnimMap"},
      .values = "RATE IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Names images that follow each other, of which the first counts as that of map does",
      .since = "q3map2",
      .example = "4 textures/mymap/screen1.tga"},
     StageWord::Frames},
    {{.name = "normalMap",
      .aliases = {"bumpMap", "normalHeightMap", "normalParallaxMap", "parallaxMap"},
      .values = "IMAGE",
      .kind = SettingKind::Text,
      .initial = "none",
      .help = "Says that the surface is normal mapped, so that -rnm makes basis maps for it",
      .details = "The line `stage normalMap` says the same, and then the image of that stage gives no color.",
      .since = "0.2.0",
      .example = "textures/mymap/wall_n.tga"},
     StageWord::NormalMap},
});

} // namespace

float Number(std::string_view word) {
    return float(std::clamp(NumberFromText(word), -kMaxNumber, kMaxNumber));
}

bool DirectiveContext::ApplyParm(std::string_view name) const {
    const SurfaceParm *parm = table.GameRules().FindParm(name);
    if (!parm)
        return false;
    ShaderInfo &info = shader.info;
    info.contentFlags = (info.contentFlags & ~parm->contentClear) | parm->contentSet;
    info.surfaceFlags = (info.surfaceFlags & ~parm->surfaceClear) | parm->surfaceSet;
    info.compileFlags = (info.compileFlags & ~parm->compileClear) | parm->compileSet;
    return true;
}

Vec3f DirectiveContext::Color(DirectiveWords words) const {
    Vec3f color{Number(words[0]), Number(words[1]), Number(words[2])};
    if (table.Options().sRgbColor)
        color = {LinearFromSrgb(color.x), LinearFromSrgb(color.y), LinearFromSrgb(color.z)};
    return NormalizeColor(color);
}

std::vector<DirectiveGroup> DirectiveGroups() {
    std::vector<DirectiveGroup> groups;
    for (const auto group : kGroups)
        groups.push_back(group());
    return groups;
}

const ShaderDirective *FindDirective(std::string_view word) {
    for (const auto group : kGroups)
        for (const ShaderDirective &directive : group().directives)
            if (HasName(directive.info, word))
                return &directive;
    return nullptr;
}

std::string NearestDirective(std::string_view word, const Game &game) {
    std::vector<std::string> names;
    for (const DirectiveGroup &group : DirectiveGroups())
        for (const ShaderDirective &directive : group.directives) {
            names.emplace_back(directive.info.name);
            for (const std::string_view alias : directive.info.aliases)
                if (!alias.empty())
                    names.emplace_back(alias);
        }
    std::erase_if(names, [](const std::string &name) { return !StartsWithNoCase(name, "q3map_"); });
    for (const SurfaceParm &parm : game.surfaceParms)
        if (!parm.name.starts_with('*'))
            names.push_back(fmt::format("q3map_{}", parm.name));
    return DidYouMean(word, names);
}

std::span<const StageWordEntry> StageWords() {
    return kStageWords;
}

StageWord FindStageWord(std::string_view word) {
    const auto found =
        std::ranges::find_if(kStageWords, [&](const StageWordEntry &entry) { return HasName(entry.info, word); });
    return found == kStageWords.end() ? StageWord::Other : found->use;
}

// ---- Words of shader scripts that are for engines and editors only ----

namespace {

/// In lower case. Directives that the compiler reads itself (FindDirective) are not listed.
constexpr auto kEngineWords = std::to_array<std::string_view>({
    // Quake III Arena, Team Arena, Quake Live, ioquake3
    "clamptime",
    "entitymergable",
    "entitymergeable",
    "fogonly",
    "nolightmap",
    "nomipmap",
    "nomipmaps",
    "nopicmip",
    "novlcollapse",
    "picmip",
    "portal",
    "sort",
    // Return to Castle Wolfenstein, Enemy Territory
    "allowcompress",
    "distancecull",
    "fogvars",
    "lightgridmulamb",
    "lightgridmuldir",
    "nocompress",
    "nofog",
    "skyfogvars",
    "sunshader",
    "waterfogvars",
    // Jedi Outcast, Jedi Academy, Elite Force, Soldier of Fortune II
    "hitlocation",
    "hitmaterial",
    "material",
    "nodraw",
    "noglow",
    "notc",
    "surfacesprites",
    // Medal of Honor
    "force32bit",
    "forcemipmaps",
    "ifcvar",
    "ifcvarnot",
    "endif",
    "portalsky",
    "spritegen",
    "spritescale",
    "surfaceangle",
    "surfacecolor",
    "surfacedensity",
    "surfacelight",
    // Daemon, XreaL
    "addmap",
    "ambientlight",
    "backsided",
    "blendmap",
    "bumpmap",
    "colormap",
    "cheap",
    "decalinfo",
    "decal_macro",
    "deform",
    "depthfade",
    "description",
    "diffusemap",
    "discrete",
    "fogdensity",
    "foggen",
    "forceheightmapparallax",
    "forceopaque",
    "forceshadows",
    "fullbright",
    "fullbrightmap",
    "glowmap",
    "glossmap",
    "guisurf",
    "heightmap",
    "heightmapoffset",
    "heightmapscale",
    "lightfalloffimage",
    "lightmap",
    "materialmap",
    "mirror",
    "noambient",
    "noheightmapparallax",
    "nooverlays",
    "noparallax",
    "noportals",
    "noselfshadow",
    "noshadows",
    "nosmooth",
    "normalformat",
    "normalheightmap",
    "normalmap",
    "normalparallaxmap",
    "normalscale",
    "parallax",
    "parallaxmap",
    "physicalmap",
    "reflectionmap",
    "refraction",
    "relief",
    "smoothing",
    "specularexponent",
    "specularexponentmax",
    "specularexponentmin",
    "specularmap",
    "specularscale",
    "translucent",
    "twosided",
    "when",
    // DarkPlaces, FTE, Warsow
    "affine",
    "bemode",
    "cellshade",
    "celshade",
    "distortion",
    "else",
    "glossexponent",
    "glossintensity",
    "glslprogram",
    "hlslprogram",
    "if",
    "lowermap",
    "offsetmappingscale",
    "program",
    "reflectcube",
    "reflectmask",
    "template",
    "uppermap",
});
/// Prefixes of words for editors, DarkPlaces, FTE, and tools of other engines.
constexpr std::array<std::string_view, 4> kPrefixes = {"qer_", "dp", "fte_", "vertexcolor"};

} // namespace

bool IsEngineDirective(std::string_view lower) {
    return std::ranges::find(kEngineWords, lower) != kEngineWords.end() ||
           std::ranges::any_of(kPrefixes, [&](std::string_view prefix) { return lower.starts_with(prefix); });
}

} // namespace q3
