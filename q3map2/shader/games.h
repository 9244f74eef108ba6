// GPL-2.0-or-later. The games table: what differs between the games that share the format.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Compiler-internal meaning of a surfaceparm, independent of a game's bit values.
enum CompileFlags : std::uint32_t {
    C_SOLID = 0x1,
    C_TRANSLUCENT = 0x2,
    C_STRUCTURAL = 0x4,
    C_HINT = 0x8,
    C_NODRAW = 0x10,
    C_LIGHTGRID = 0x20,
    C_ALPHASHADOW = 0x40,
    C_LIGHTFILTER = 0x80,
    C_VERTEXLIT = 0x100,
    C_LIQUID = 0x200,
    C_FOG = 0x400,
    C_SKY = 0x800,
    C_ORIGIN = 0x1000,
    C_AREAPORTAL = 0x2000,
    C_ANTIPORTAL = 0x4000,
    C_SKIP = 0x8000,
    C_NOMARKS = 0x10000,
    C_OB = 0x20000,
    C_DETAIL = 0x8000000
};

/// flags = (flags & ~clear) | set for each of the three words.
struct SurfaceParm {
    std::string_view name;
    std::uint32_t contentSet = 0, contentClear = 0;
    std::uint32_t surfaceSet = 0, surfaceClear = 0;
    std::uint32_t compileSet = 0, compileClear = 0;
};

/// One row of the games table. Only IBSP games: RBSP and FBSP are another container.
struct Game {
    std::string_view name;             ///< argument of -game
    std::string_view title;            ///< the game in full, for people
    std::string_view gameDir, homeDir; ///< base game folder; sub-folder of home with leading dot
    std::string_view magic;            ///< word that marks the engine path in a file name
    std::string_view shaderDir = "scripts";
    std::string_view archiveExtension = "pk3";
    /// Files in which an image is looked for, the first counts; * is its name.
    std::string_view imageFiles = "*.tga *.png *.jpg *.dds *.ktx *.crn *.webp";
    int bspVersion = 46;
    bool hasAdvertisements = false; ///< the file has a lump of advertisements, in slot 17
    bool wolfLighting = false;      ///< linear falloff without angle attenuation by default
    // Defaults of the options -nostyle, -keeplights, -patchshadows and -lightanglehl.
    bool noStyles = false, keepLights = false, patchShadows = false, halfLambert = false;
    // Defaults of -sRGBlight, -sRGBtex and -sRGBcolor.
    bool sRgbLightmap = false, sRgbTexture = false, sRgbColor = false;
    // Defaults of the options -gamma, -exposure, -compensate, -gridscale and -gridambientscale.
    float gamma = 1, exposure = 0, compensate = 1;
    float gridScale = 1, gridAmbientScale = 1;
    /// Of draw surfaces. Engines have SHADER_MAX_VERTEXES 1000 and SHADER_MAX_INDEXES 6000.
    int maxSurfaceVerts = 64, maxVertexLitVerts = 999, maxSurfaceIndexes = 6000;
    /// Surface flags that bevel sides inherit: nodamage, slick, flesh, metalsteps, nosteps, dust and, in quake3, noob.
    std::uint32_t bevelSurfaceFlags = 0xC3043;
    std::string_view flareShader = "flareshader";
    int lightmapSize = 128;                     ///< side of a lightmap page in the file
    bool deluxe = false, deluxeTangent = false; ///< light direction pages by default; in tangent space
    std::vector<SurfaceParm> surfaceParms;      ///< in table order, the first match of a name counts

    /// First parm of that name (case-insensitive), or null.
    const SurfaceParm *FindParm(std::string_view parm) const;
    /// Surface and content bits that mark a BSP shader record as nodraw in this game (0 when the game has none).
    std::uint32_t NoDrawSurfaceFlags() const;
    /// CompileFlags that a .bsp's shader record implies: C_SOLID from its content bit, and those of every parm whose
    /// content and surface bits are all set. Parms without bits of their own leave no trace in a .bsp.
    std::uint32_t CompileFlagsOf(std::uint32_t surfaceFlags, std::uint32_t contentFlags) const;
};

/// All rows, quake3 first.
std::span<const Game> Games();
/// Row of that name (case-insensitive), or null.
const Game *FindGame(std::string_view name);

/// Default of com_hunkMegs, the memory for a map, in MiB. 0: unknown.
int EngineMegabytes(const Game &game);

/// The list of quake3, on which those of other games are based.
std::vector<SurfaceParm> BaseParms();
std::vector<SurfaceParm> QuakeLiveParms();
std::vector<SurfaceParm> TremulousParms();
std::vector<SurfaceParm> WolfParms();
std::vector<SurfaceParm> EnemyTerritoryParms();
std::vector<SurfaceParm> UrbanTerrorParms();
std::vector<SurfaceParm> EliteForceParms();
std::vector<SurfaceParm> ReactionParms();

} // namespace q3
