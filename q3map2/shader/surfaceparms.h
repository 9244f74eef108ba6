// GPL-2.0-or-later. The surfaceparms of each game: which bits of a .bsp they set and what they tell the compiler.
#pragma once

#include <cstdint>
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

/// The list of quake3, on which those of other games are based.
std::vector<SurfaceParm> BaseParms();
std::vector<SurfaceParm> QuakeLiveParms();
std::vector<SurfaceParm> TremulousParms();
std::vector<SurfaceParm> WolfParms();
std::vector<SurfaceParm> EnemyTerritoryParms();
std::vector<SurfaceParm> UrbanTerrorParms();
std::vector<SurfaceParm> EliteForceParms();
std::vector<SurfaceParm> ReactionParms();
/// Of sof2 and jk2: a list of its own, with materials in the low five surface flags.
std::vector<SurfaceParm> SoldierOfFortuneParms();
/// That list and two more.
std::vector<SurfaceParm> JediAcademyParms();

} // namespace q3
