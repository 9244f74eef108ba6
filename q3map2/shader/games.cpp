// GPL-2.0-or-later. The games table: what differs between the games that share the format.
#include "q3map2/shader/games.h"

#include "common/text/text_scan.h"

#include <algorithm>

namespace q3 {

namespace {

Game MakeGame(std::string_view name, std::string_view gameDir, std::string_view homeDir, std::string_view magic,
              std::vector<SurfaceParm> parms) {
    Game game;
    game.name = name;
    game.gameDir = gameDir;
    game.homeDir = homeDir;
    game.magic = magic;
    game.surfaceParms = std::move(parms);
    return game;
}

/// Sets the limits of draw surfaces.
Game &SetLimits(Game &game, int surfaceVerts, int vertexLitVerts, int indexes) {
    game.maxSurfaceVerts = surfaceVerts;
    game.maxVertexLitVerts = vertexLitVerts;
    game.maxSurfaceIndexes = indexes;
    return game;
}

constexpr int kLargeSurface = 1048575; ///< vertices and indexes; 2^20 - 1

struct GameTitle {
    std::string_view name, title;
};

/// Game::title of each game.
constexpr GameTitle kTitles[] = {
    {"quake3", "Quake III Arena, Team Arena; OpenArena, Urban Terror and others"},
    {"quakelive", "Quake Live"},
    {"nexuiz", "Nexuiz"},
    {"xonotic", "Xonotic"},
    {"tremulous", "Tremulous"},
    {"unvanquished", "Unvanquished"},
    {"tenebrae", "Tenebrae"},
    {"wolf", "Return to Castle Wolfenstein"},
    {"et", "Wolfenstein: Enemy Territory"},
    {"etut", "Urban Terror on Enemy Territory's engine"},
    {"ef", "Star Trek: Voyager - Elite Force"},
    {"reaction", "Reaction"},
    {"darkplaces", "DarkPlaces, for Quake"},
    {"dq", "DeluxeQuake"},
    {"prophecy", "Prophecy"},
};

std::string_view TitleOf(std::string_view game) {
    const auto found = std::ranges::find(kTitles, game, &GameTitle::name);
    return found == std::end(kTitles) ? std::string_view() : found->title;
}

Game QuakeLive() {
    Game game = MakeGame("quakelive", "baseq3", ".quakelive", "quake", QuakeLiveParms());
    game.bspVersion = 47;
    game.hasAdvertisements = true;
    game.bevelSurfaceFlags = 0x1C3043; // also woodsteps; 0x80000 is snowsteps too
    return game;
}

/// Of DarkPlaces, which takes compressed textures from a folder of their own.
constexpr std::string_view kDarkPlacesImages = "*.tga *.png *.jpg dds/*.dds *.dds *.ktx *.crn *.webp";

Game Nexuiz() {
    Game game = MakeGame("nexuiz", "data", ".nexuiz", "nexuiz", BaseParms());
    game.imageFiles = kDarkPlacesImages;
    game.noStyles = game.keepLights = true;
    return SetLimits(game, 999, 999, 6000);
}

Game Xonotic() {
    Game game = MakeGame("xonotic", "data", ".xonotic", "xonotic", BaseParms());
    game.imageFiles = kDarkPlacesImages;
    game.sRgbLightmap = game.sRgbTexture = game.sRgbColor = true;
    game.noStyles = game.keepLights = game.patchShadows = true;
    return SetLimits(game, kLargeSurface, kLargeSurface, kLargeSurface);
}

Game Unvanquished() {
    Game game = MakeGame("unvanquished", "pkg", ".local/share/unvanquished", "unvanquished", TremulousParms());
    game.archiveExtension = "dpk";
    game.imageFiles = "*.webp *.png *.tga *.jpg *.dds dds/*.dds *.crn *.ktx"; // as the engine does
    game.keepLights = true;
    return SetLimits(game, kLargeSurface, kLargeSurface, kLargeSurface);
}

Game Tenebrae() {
    Game game = MakeGame("tenebrae", "base", ".tenebrae", "tenebrae", BaseParms());
    game.gamma = 2;
    game.lightmapSize = 512;
    game.noStyles = game.deluxe = true;
    return SetLimits(game, 1024, 1024, 6144);
}

Game Wolf(std::string_view name, std::string_view gameDir, std::string_view homeDir, std::string_view magic,
          std::vector<SurfaceParm> parms) {
    Game game = MakeGame(name, gameDir, homeDir, magic, std::move(parms));
    game.bspVersion = 47;
    game.wolfLighting = true;
    game.bevelSurfaceFlags = 0x7FFC3043; // also all bits from woodsteps to monsterslicksouth
    return game;
}

Game EnemyTerritory() {
    Game game = Wolf("et", "etmain", ".etwolf", "et", EnemyTerritoryParms());
    return SetLimits(game, 1024, 1024, 6144);
}

Game UrbanTerror() {
    Game game = MakeGame("etut", "etut", ".etwolf", "et", UrbanTerrorParms());
    game.bspVersion = 47;
    game.gamma = 2.2f;
    game.sRgbLightmap = true;
    return SetLimits(game, 1024, 1024, 6144);
}

/// Games with exposure tone mapping by default.
Game ToneMappedGame(std::string_view name, std::string_view gameDir, std::string_view homeDir, std::string_view magic,
                    float gridScale) {
    Game game = MakeGame(name, gameDir, homeDir, magic, BaseParms());
    game.exposure = 200;
    game.gridScale = gridScale;
    game.gridAmbientScale = 0.6f;
    game.noStyles = game.keepLights = true;
    return game;
}

std::vector<Game> MakeGames() {
    Game deluxeQuake = ToneMappedGame("dq", "basedq", ".dq", "dq", 0.3f);
    deluxeQuake.gamma = 1.2f;
    deluxeQuake.patchShadows = deluxeQuake.deluxe = deluxeQuake.deluxeTangent = true;
    Game prophecy = ToneMappedGame("prophecy", "base", ".prophecy", "prophecy", 0.4f);
    prophecy.patchShadows = prophecy.deluxe = true;
    Game darkPlaces = ToneMappedGame("darkplaces", "id1", ".darkplaces", "darkplaces", 0.3f);
    SetLimits(darkPlaces, 999, 999, 6000);
    std::vector<Game> games{
        MakeGame("quake3", "baseq3", ".q3a", "quake", BaseParms()),
        QuakeLive(),
        Nexuiz(),
        Xonotic(),
        MakeGame("tremulous", "base", ".tremulous", "tremulous", TremulousParms()),
        Unvanquished(),
        Tenebrae(),
        Wolf("wolf", "main", ".wolf", "wolf", WolfParms()),
        EnemyTerritory(),
        UrbanTerror(),
        MakeGame("ef", "baseef", ".ef", "elite", EliteForceParms()),
        MakeGame("reaction", "Boomstick", ".Reaction", "reaction", ReactionParms()),
        darkPlaces,
        deluxeQuake,
        prophecy,
    };
    constexpr std::uint32_t kNoOb = 0x80000; // surfaceparm noob, which only bevels of quake3 inherit
    for (Game &game : games) {
        game.title = TitleOf(game.name);
        if (game.name != "quake3" && game.bevelSurfaceFlags == Game().bevelSurfaceFlags)
            game.bevelSurfaceFlags &= ~kNoOb;
    }
    return games;
}

const std::vector<Game> kGames = MakeGames();

} // namespace

const SurfaceParm *Game::FindParm(std::string_view parm) const {
    const auto found = std::find_if(surfaceParms.begin(), surfaceParms.end(),
                                    [&](const SurfaceParm &p) { return EqualNoCase(p.name, parm); });
    return found == surfaceParms.end() ? nullptr : &*found;
}

std::uint32_t Game::NoDrawSurfaceFlags() const {
    const SurfaceParm *parm = FindParm("nodraw");
    return parm ? parm->surfaceSet : 0;
}

std::uint32_t Game::CompileFlagsOf(std::uint32_t surfaceFlags, std::uint32_t contentFlags) const {
    constexpr std::uint32_t kSolidContent = 0x1;
    std::uint32_t flags = (contentFlags & kSolidContent) != 0 ? std::uint32_t(C_SOLID) : 0;
    for (const SurfaceParm &parm : surfaceParms) {
        const bool hasBits = (parm.contentSet | parm.surfaceSet) != 0 && parm.name != "default";
        if (hasBits && (contentFlags & parm.contentSet) == parm.contentSet &&
            (surfaceFlags & parm.surfaceSet) == parm.surfaceSet)
            flags |= parm.compileSet;
    }
    return flags;
}

std::span<const Game> Games() {
    return kGames;
}

const Game *FindGame(std::string_view name) {
    const auto found =
        std::find_if(kGames.begin(), kGames.end(), [&](const Game &game) { return EqualNoCase(game.name, name); });
    return found == kGames.end() ? nullptr : &*found;
}

int EngineMegabytes(const Game &game) {
    // 128: DEF_COMHUNKMEGS of ioquake3, which most players and mods of this game run. The original program of 1999 had
    // 56, too little for many maps of today.
    return game.name == "quake3" ? 128 : 0;
}

// ---- The surfaceparm lists of the games table ----

namespace {

constexpr std::uint32_t kAll = 0xFFFFFFFF;
constexpr std::uint32_t kMaterial = 0xFFF00000; // the field that holds etut's material number

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
// clang-format on

} // namespace q3
