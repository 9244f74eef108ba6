// GPL-2.0-or-later. The surfaceparms of each game.
#include "q3map2/shader/surfaceparms.h"

#include <utility>

namespace q3 {

namespace {

constexpr std::uint32_t kAll = 0xFFFFFFFF;
constexpr std::uint32_t kMaterial = 0xFFF00000;              // the field that holds etut's material number
constexpr std::uint32_t kRavenMaterial = 0x1F;               // that of Raven's games
constexpr std::uint32_t kSolid = 0x1, kSolidOpaque = 0x8001; // content flags of Raven's games

// Columns of the lists below: name; content set, clear; surface set, clear; compile set, clear.
using Parms = std::vector<SurfaceParm>;

/// The parms of both lists, in this order.
Parms Joined(Parms first, const Parms &second) {
    first.insert(first.end(), second.begin(), second.end());
    return first;
}

} // namespace

// clang-format off
Parms BaseParms() {
    return {
        {"default", 0x1, kAll, 0, kAll, C_SOLID, kAll},
        {"lightgrid", 0, 0, 0, 0, C_LIGHTGRID},
        {"antiportal", 0, 0, 0, 0, C_ANTIPORTAL},
        {"skip", 0, 0, 0, 0, C_SKIP},
        {"origin", 0x1000000, 0x1, 0, 0, C_TRANSLUCENT | C_ORIGIN, C_SOLID},
        {"areaportal", 0x8000, 0x1, 0, 0, C_TRANSLUCENT | C_AREAPORTAL, C_SOLID},
        {"trans", 0x20000000, 0, 0, 0, C_TRANSLUCENT},
        {"detail", 0x8000000, 0, 0, 0, C_DETAIL},
        {"structural", 0x10000000, 0, 0, 0, C_STRUCTURAL},
        {"hint", 0, 0, 0x100, 0, C_HINT},
        {"nodraw", 0, 0, 0x80, 0, C_NODRAW},
        {"alphashadow", 0, 0, 0x10000, 0, C_TRANSLUCENT | C_ALPHASHADOW},
        {"lightfilter", 0, 0, 0x8000, 0, C_TRANSLUCENT | C_LIGHTFILTER},
        {"nolightmap", 0, 0, 0xC00, 0, C_VERTEXLIT},
        {"pointlight", 0, 0, 0xC00, 0, C_VERTEXLIT},
        {"nonsolid", 0, 0x1, 0x4000, 0, 0, C_SOLID},
        {"trigger", 0x40000000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"water", 0x20, 0x1, 0, 0, C_TRANSLUCENT | C_LIQUID, C_SOLID},
        {"slime", 0x10, 0x1, 0, 0, C_TRANSLUCENT | C_LIQUID, C_SOLID},
        {"lava", 0x8, 0x1, 0, 0, C_TRANSLUCENT | C_LIQUID, C_SOLID},
        {"playerclip", 0x10000, 0x1, 0, 0, C_TRANSLUCENT | C_DETAIL, C_SOLID},
        {"monsterclip", 0x20000, 0x1, 0, 0, C_TRANSLUCENT | C_DETAIL, C_SOLID},
        {"nodrop", 0x80000000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"clusterportal", 0x100000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"donotenter", 0x200000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"botclip", 0x400000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"fog", 0x40, 0x1, 0, 0, C_FOG, C_SOLID},
        {"sky", 0, 0, 0x4, 0, C_SKY},
        {"slick", 0, 0, 0x2},
        {"noimpact", 0, 0, 0x10},
        {"nomarks", 0, 0, 0x20, 0, C_NOMARKS},
        {"ladder", 0, 0, 0x8},
        {"nodamage", 0, 0, 0x1},
        {"metalsteps", 0, 0, 0x1000},
        {"flesh", 0, 0, 0x40},
        {"nosteps", 0, 0, 0x2000},
        {"nodlight", 0, 0, 0x20000},
        {"dust", 0, 0, 0x40000},
        {"noob", 0, 0, 0x80000},
        {"ob", 0, 0, 0, 0, C_OB},
    };
}

Parms QuakeLiveParms() {
    return Joined(BaseParms(), {
        {"snowsteps", 0, 0, 0x80000},
        {"woodsteps", 0, 0, 0x100000},
        {"dmgthrough", 0, 0, 0x200000},
    });
}

Parms TremulousParms() {
    return Joined(BaseParms(), {
        {"noalienbuild", 0x1000},
        {"nohumanbuild", 0x2000},
        {"nobuild", 0x4000},
        {"noalienbuildsurface", 0, 0, 0x80000},
        {"nohumanbuildsurface", 0, 0, 0x100000},
        {"nobuildsurface", 0, 0, 0x200000},
    });
}

Parms WolfParms() {
    return Joined(BaseParms(), {
        {"slag", 0x10, 0x1, 0, 0, C_TRANSLUCENT | C_LIQUID, C_SOLID},
        {"clipmissile", 0x80, 0x1, 0, 0, C_TRANSLUCENT | C_DETAIL, C_SOLID},
        {"clipshot", 0x2000, 0x1, 0, 0, C_TRANSLUCENT | C_DETAIL, C_SOLID},
        {"donotenterlarge", 0x400000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"metal", 0, 0, 0x1000},
        {"glass", 0, 0, 0x200000},
        {"ceramic", 0, 0, 0x40},
        {"woodsteps", 0, 0, 0x40000},
        {"grasssteps", 0, 0, 0x80000},
        {"gravelsteps", 0, 0, 0x100000},
        {"rubble", 0, 0, 0x1000000},
        {"carpetsteps", 0, 0, 0x2000000},
        {"snowsteps", 0, 0, 0x400000},
        {"roofsteps", 0, 0, 0x800000},
        {"ai_nosight", 0x1000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"ai_nopass", 0x200000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"ai_nopasslarge", 0x400000, 0x1, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"monsterslick", 0, 0, 0x4000000, 0, C_TRANSLUCENT},
        {"monsterslicknorth", 0, 0, 0x10000000, 0, C_TRANSLUCENT},
        {"monsterslickeast", 0, 0, 0x20000000, 0, C_TRANSLUCENT},
        {"monsterslicksouth", 0, 0, 0x40000000, 0, C_TRANSLUCENT},
        {"monsterslickwest", 0, 0, 0x8000000, 0, C_TRANSLUCENT},
    });
}

Parms EnemyTerritoryParms() {
    return Joined(WolfParms(), {
        {"landmine", 0, 0, 0x80000000},
        {"splash", 0, 0, 0x40},
    });
}

Parms UrbanTerrorParms() {
    return Joined(BaseParms(), {
        {"*mat_none", 0, 0, 0, kMaterial},
        {"*mat_tin", 0, 0, 0x100000, kMaterial},
        {"*mat_aluminum", 0, 0, 0x200000, kMaterial},
        {"*mat_iron", 0, 0, 0x300000, kMaterial},
        {"*mat_titanium", 0, 0, 0x400000, kMaterial},
        {"*mat_steel", 0, 0, 0x500000, kMaterial},
        {"*mat_brass", 0, 0, 0x600000, kMaterial},
        {"*mat_copper", 0, 0, 0x700000, kMaterial},
        {"*mat_cement", 0, 0, 0x800000, kMaterial},
        {"*mat_rock", 0, 0, 0x900000, kMaterial},
        {"*mat_gravel", 0, 0, 0xA00000, kMaterial},
        {"*mat_pavement", 0, 0, 0xB00000, kMaterial},
        {"*mat_brick", 0, 0, 0xC00000, kMaterial},
        {"*mat_clay", 0, 0, 0xD00000, kMaterial},
        {"*mat_grass", 0, 0, 0xE00000, kMaterial},
        {"*mat_dirt", 0, 0, 0xF00000, kMaterial},
        {"*mat_mud", 0, 0, 0x1000000, kMaterial},
        {"*mat_snow", 0, 0, 0x1100000, kMaterial},
        {"*mat_ice", 0, 0, 0x1200000, kMaterial},
        {"*mat_sand", 0, 0, 0x1300000, kMaterial},
        {"*mat_ceramic", 0, 0, 0x1400000, kMaterial},
        {"*mat_ceramictile", 0, 0, 0x1400000, kMaterial},
        {"*mat_linoleum", 0, 0, 0x1500000, kMaterial},
        {"*mat_rug", 0, 0, 0x1600000, kMaterial},
        {"*mat_plaster", 0, 0, 0x1700000, kMaterial},
        {"*mat_plastic", 0, 0, 0x1800000, kMaterial},
        {"*mat_cardboard", 0, 0, 0x1900000, kMaterial},
        {"*mat_hardwood", 0, 0, 0x1A00000, kMaterial},
        {"*mat_softwood", 0, 0, 0x1B00000, kMaterial},
        {"*mat_plank", 0, 0, 0x1C00000, kMaterial},
        {"*mat_glass", 0, 0, 0x1D00000, kMaterial},
        {"*mat_water", 0, 0, 0x1E00000, kMaterial},
        {"*mat_stucco", 0, 0, 0x1F00000, kMaterial},
    });
}

Parms EliteForceParms() {
    Parms parms = BaseParms();
    std::erase_if(parms, [](const SurfaceParm &parm) { return parm.name == "ladder"; });
    return Joined(std::move(parms), {
        {"ladder", 0x80, 0x1, 0x8, 0, C_TRANSLUCENT | C_DETAIL, C_SOLID},
        {"shotclip", 0x40000, 0x1, 0, 0, C_TRANSLUCENT | C_DETAIL, C_SOLID},
        {"forcefield", 0, 0, 0x40000},
    });
}

Parms ReactionParms() {
    return Joined(BaseParms(), {
        {"rq3_gravel", 0, 0, 0x80000},
        {"rq3_wood", 0, 0, 0x81000},
        {"rq3_carpet", 0, 0, 0x100000},
        {"rq3_metal2", 0, 0, 0x101000},
        {"rq3_glass", 0, 0, 0x180000},
        {"rq3_grass", 0, 0, 0x181000},
        {"rq3_snow", 0, 0, 0x200000},
        {"rq3_mud", 0, 0, 0x201000},
        {"rq3_wood2", 0, 0, 0x280000},
        {"rq3_hardmetal", 0, 0, 0x281000},
        {"rq3_leaves", 0, 0, 0x300000},
        {"rq3_cement", 0, 0, 0x301000},
        {"rq3_marble", 0, 0, 0x380000},
        {"rq3_snow2", 0, 0, 0x381000},
        {"rq3_hardsteps", 0, 0, 0x400000},
        {"rq3_sand", 0, 0, 0x401000},
    });
}

Parms SoldierOfFortuneParms() {
    constexpr std::uint32_t kClip = C_TRANSLUCENT | C_DETAIL, kLiquid = C_TRANSLUCENT | C_LIQUID;
    return {
        {"default", kSolidOpaque, kAll, 0, kAll, C_SOLID, kAll},
        {"lightgrid", 0, 0, 0, 0, C_LIGHTGRID},
        {"antiportal", 0, 0, 0, 0, C_ANTIPORTAL},
        {"skip", 0, 0, 0, 0, C_SKIP},
        {"origin", 0, kSolid, 0, 0, C_TRANSLUCENT | C_ORIGIN, C_SOLID},
        {"areaportal", 0x80000000, kSolidOpaque, 0, 0, C_TRANSLUCENT | C_AREAPORTAL, C_SOLID},
        {"trans", 0x80000000, 0, 0, 0, C_TRANSLUCENT},
        {"detail", 0x8000000, 0, 0, 0, C_DETAIL},
        {"structural", 0, 0, 0, 0, C_STRUCTURAL},
        {"hint", 0, 0, 0, 0, C_HINT},
        {"nodraw", 0, 0, 0x200000, 0, C_NODRAW},
        {"alphashadow", 0, 0, 0, 0, C_TRANSLUCENT | C_ALPHASHADOW},
        {"lightfilter", 0, 0, 0, 0, C_TRANSLUCENT | C_LIGHTFILTER},
        {"nolightmap", 0, 0, 0, 0, C_VERTEXLIT},
        {"pointlight", 0, 0, 0, 0, C_VERTEXLIT},
        {"nonsolid", 0, kSolid, 0, 0, 0, C_SOLID},
        {"nonopaque", 0, 0x8000, 0, 0, C_TRANSLUCENT},
        {"trigger", 0x400, kSolidOpaque, 0, 0, C_TRANSLUCENT, C_SOLID},
        {"water", 0x4, kSolid, 0, 0, kLiquid, C_SOLID},
        {"slime", 0x20000, kSolid, 0, 0, kLiquid, C_SOLID},
        {"lava", 0x2, kSolid, 0, 0, kLiquid, C_SOLID},
        {"shotclip", 0x80, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"playerclip", 0x10, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"monsterclip", 0x20, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"nodrop", 0x800, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"terrain", 0x1000, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"ladder", 0x2000, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"abseil", 0x4000, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"outside", 0x10000, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"botclip", 0x40, kSolidOpaque, 0, 0, kClip, C_SOLID},
        {"fog", 0x8, kSolidOpaque, 0, 0, kClip | C_FOG, C_SOLID},
        {"sky", 0, 0, 0x2000, 0, C_SKY},
        {"slick", 0, 0, 0x4000},
        {"noimpact", 0, 0, 0x80000},
        {"nomarks", 0, 0, 0x100000, 0, C_NOMARKS},
        {"nodamage", 0, 0, 0x40000},
        {"metalsteps", 0, 0, 0x8000},
        {"nosteps", 0, 0, 0x400000},
        {"nodlight", 0, 0, 0x800000},
        {"nomiscents", 0, 0, 0x1000000},
        {"forcefield", 0, 0, 0x10000},
        {"*mat_none", 0, 0, 0, kRavenMaterial},
        {"*mat_solidwood", 0, 0, 1, kRavenMaterial},
        {"*mat_hollowwood", 0, 0, 2, kRavenMaterial},
        {"*mat_solidmetal", 0, 0, 3, kRavenMaterial},
        {"*mat_hollowmetal", 0, 0, 4, kRavenMaterial},
        {"*mat_shortgrass", 0, 0, 5, kRavenMaterial},
        {"*mat_longgrass", 0, 0, 6, kRavenMaterial},
        {"*mat_dirt", 0, 0, 7, kRavenMaterial},
        {"*mat_sand", 0, 0, 8, kRavenMaterial},
        {"*mat_gravel", 0, 0, 9, kRavenMaterial},
        {"*mat_glass", 0, 0, 10, kRavenMaterial},
        {"*mat_concrete", 0, 0, 11, kRavenMaterial},
        {"*mat_marble", 0, 0, 12, kRavenMaterial},
        {"*mat_water", 0, 0, 13, kRavenMaterial},
        {"*mat_snow", 0, 0, 14, kRavenMaterial},
        {"*mat_ice", 0, 0, 15, kRavenMaterial},
        {"*mat_flesh", 0, 0, 16, kRavenMaterial},
        {"*mat_mud", 0, 0, 17, kRavenMaterial},
        {"*mat_bpglass", 0, 0, 18, kRavenMaterial},
        {"*mat_dryleaves", 0, 0, 19, kRavenMaterial},
        {"*mat_greenleaves", 0, 0, 20, kRavenMaterial},
        {"*mat_fabric", 0, 0, 21, kRavenMaterial},
        {"*mat_canvas", 0, 0, 22, kRavenMaterial},
        {"*mat_rock", 0, 0, 23, kRavenMaterial},
        {"*mat_rubber", 0, 0, 24, kRavenMaterial},
        {"*mat_plastic", 0, 0, 25, kRavenMaterial},
        {"*mat_tiles", 0, 0, 26, kRavenMaterial},
        {"*mat_carpet", 0, 0, 27, kRavenMaterial},
        {"*mat_plaster", 0, 0, 28, kRavenMaterial},
        {"*mat_shatterglass", 0, 0, 29, kRavenMaterial},
        {"*mat_armor", 0, 0, 30, kRavenMaterial},
        {"*mat_computer", 0, 0, 31, kRavenMaterial},
    };
}

Parms JediAcademyParms() {
    return Joined(SoldierOfFortuneParms(), {
        {"inside", 0x10000000},
        {"forcesight", 0, 0, 0x2000000},
    });
}
// clang-format on

} // namespace q3
