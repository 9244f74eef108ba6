// GPL-2.0-or-later. Words of shader scripts that are for engines and editors only.
#include "q3map2/shader/engine_directives.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

/// In lower case. Directives that the compiler reads itself (FindDirective) are not listed.
constexpr auto kWords = std::to_array<std::string_view>({
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
    return std::ranges::find(kWords, lower) != kWords.end() ||
           std::ranges::any_of(kPrefixes, [&](std::string_view prefix) { return lower.starts_with(prefix); });
}

} // namespace q3
