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
    {"sof2", "Soldier of Fortune II: Double Helix"},
    {"jk2", "Star Wars Jedi Knight II: Jedi Outcast"},
    {"ja", "Star Wars Jedi Knight: Jedi Academy"},
    {"qfusion", "Warsow, Warfork and other games on qfusion"},
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

/// Raven's games with .bsp files of the format RBSP.
Game Raven(std::string_view name, std::string_view homeDir, std::string_view magic, std::string_view flareShader,
           std::vector<SurfaceParm> parms) {
    Game game = MakeGame(name, "base", homeDir, magic, std::move(parms));
    game.shaderDir = "shaders";
    game.bspIdent = "RBSP";
    game.bspVersion = 1;
    game.styleSlots = game.flares = game.refusesFoliage = true;
    game.maxLightmaps = 256;
    game.bevelSurfaceFlags = 0x144C000; // slick, metalsteps, nodamage, nosteps and nomiscents, which have other bits
    game.flareShader = flareShader;
    game.originShader = "system/origin";
    game.maxFogs = 30; // the last bit pattern is that of the goggles
    return game;
}

Game QFusion() {
    Game game = MakeGame("qfusion", "base", ".qfusion", "qfusion", BaseParms());
    game.bspIdent = "FBSP";
    game.bspVersion = 1;
    game.styleSlots = game.solidModelLeafs = true;
    game.maxStyleSets = 128;
    game.maxLightmaps = 256;
    game.sRgbLightmap = game.sRgbTexture = game.sRgbColor = true;
    game.halfLambert = game.keepLights = game.patchShadows = true;
    game.lightmapSize = 512;
    game.deluxe = true;
    constexpr int kVertices = 65535;
    return SetLimits(game, kVertices, kVertices, 6 * kVertices);
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
        Raven("sof2", ".sof2", "soldier", "gfx/misc/lens_flare", SoldierOfFortuneParms()),
        Raven("jk2", ".jk2", "GameData", "gfx/misc/flare", SoldierOfFortuneParms()),
        Raven("ja", ".ja", "GameData", "gfx/misc/flare", JediAcademyParms()),
        QFusion(),
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

namespace {

/// Whether the parm clears content bits that are set, and another one with the same bits clears none of these.
bool HasBetterMatch(const SurfaceParm &parm, const std::vector<SurfaceParm> &all, std::uint32_t contentFlags) {
    return (contentFlags & parm.contentClear) != 0 && std::ranges::any_of(all, [&](const SurfaceParm &other) {
               return other.contentSet == parm.contentSet && other.surfaceSet == parm.surfaceSet &&
                      (contentFlags & other.contentClear) == 0;
           });
}

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
            (surfaceFlags & parm.surfaceSet) == parm.surfaceSet && !HasBetterMatch(parm, surfaceParms, contentFlags))
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

} // namespace q3
