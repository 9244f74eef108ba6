// GPL-2.0-or-later. The games table: what differs between the games that share the format.
#pragma once

#include "q3map2/shader/surfaceparms.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// One row of the games table.
struct Game {
    std::string_view name;             ///< argument of -game
    std::string_view title;            ///< the game in full, for people
    std::string_view gameDir, homeDir; ///< base game folder; sub-folder of home with leading dot
    std::string_view magic;            ///< word that marks the engine path in a file name
    std::string_view shaderDir = "scripts";
    std::string_view archiveExtension = "pk3";
    /// Files in which an image is looked for, the first counts; * is its name.
    std::string_view imageFiles = "*.tga *.png *.jpg *.dds *.ktx *.crn *.webp";
    std::string_view bspIdent = "IBSP"; ///< BspFormat::ident
    int bspVersion = 46;
    bool hasAdvertisements = false; ///< the file has a lump of advertisements, in slot 17
    /// Records hold four light styles (RBSP, FBSP), and engines read which of them shine. The bsp stage numbers
    /// switchable lights, and shaders need no stages for styles.
    bool styleSlots = false;
    int maxStyleSets = 0; ///< different sets of light styles on surfaces that engines draw; 0: any
    int maxLightmaps = 0; ///< lightmap pages that engines draw, those of light directions too; 0: not known
    /// Leafs of brush entities have no cluster. The engine takes every surface that a leaf with a cluster lists for one
    /// of the world.
    bool solidModelLeafs = false;
    bool wolfLighting = false; ///< linear falloff without angle attenuation by default
    bool flares = false;       ///< default of -flares
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
    bool refusesFoliage = false; ///< the engine ends with an error when a map has surfaces of foliage
    std::string_view originShader = "common/origin"; ///< of origin brushes
    int maxFogs = 31;       ///< that engines draw; fog numbers have 5 bits, and some engines reserve a value
    int lightmapSize = 128; ///< side of a lightmap page in the file
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

} // namespace q3
