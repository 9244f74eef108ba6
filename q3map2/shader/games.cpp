// GPL-2.0-or-later. The games table: what differs between the games that share the format.
#include "q3map2/shader/games.h"

#include "common/text/text_scan.h"
#include "q3map2/shader/engine_limits.h"
#include "q3map2/shader/surfaceparms.h"

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

Game &Limits(Game &game, int surfaceVerts, int verts, int indexes) {
    game.maxSurfaceVerts = surfaceVerts;
    game.maxVertexLitVerts = verts;
    game.maxSurfaceIndexes = indexes;
    return game;
}

constexpr int kLargeSurface = 1048575;

Game QuakeLive() {
    Game game = MakeGame("quakelive", "baseq3", ".quakelive", "quake", QuakeLiveParms());
    game.bspVersion = 47;
    game.hasAdvertisements = true;
    game.bevelSurfaceFlags = 0x1C3043;
    return game;
}

Game Nexuiz() {
    Game game = MakeGame("nexuiz", "data", ".nexuiz", "nexuiz", BaseParms());
    game.noStyles = game.keepLights = true;
    return Limits(game, 999, 999, 6000);
}

Game Xonotic() {
    Game game = MakeGame("xonotic", "data", ".xonotic", "xonotic", BaseParms());
    game.sRgbLightmap = game.sRgbTexture = game.sRgbColor = true;
    game.noStyles = game.keepLights = game.patchShadows = true;
    return Limits(game, kLargeSurface, kLargeSurface, kLargeSurface);
}

Game Unvanquished() {
    Game game = MakeGame("unvanquished", "pkg", ".local/share/unvanquished", "unvanquished", TremulousParms());
    game.archiveExtension = "dpk";
    game.keepLights = true;
    return Limits(game, kLargeSurface, kLargeSurface, kLargeSurface);
}

Game Tenebrae() {
    Game game = MakeGame("tenebrae", "base", ".tenebrae", "tenebrae", BaseParms());
    game.gamma = 2;
    game.lightmapSize = 512;
    game.noStyles = game.deluxe = true;
    return Limits(game, 1024, 1024, 6144);
}

Game Wolf(std::string_view name, std::string_view gameDir, std::string_view homeDir, std::string_view magic,
          std::vector<SurfaceParm> parms) {
    Game game = MakeGame(name, gameDir, homeDir, magic, std::move(parms));
    game.bspVersion = 47;
    game.wolfLighting = true;
    game.bevelSurfaceFlags = 0x7FFC3043;
    return game;
}

Game EnemyTerritory() {
    Game game = Wolf("et", "etmain", ".etwolf", "et", EnemyTerritoryParms());
    return Limits(game, 1024, 1024, 6144);
}

Game UrbanTerror() {
    Game game = MakeGame("etut", "etut", ".etwolf", "et", UrbanTerrorParms());
    game.bspVersion = 47;
    game.gamma = 2.2f;
    game.sRgbLightmap = true;
    return Limits(game, 1024, 1024, 6144);
}

/// Games with exposure tone mapping by default.
Game Exposed(std::string_view name, std::string_view gameDir, std::string_view homeDir, std::string_view magic,
             float gridScale) {
    Game game = MakeGame(name, gameDir, homeDir, magic, BaseParms());
    game.exposure = 200;
    game.gridScale = gridScale;
    game.gridAmbientScale = 0.6f;
    game.noStyles = game.keepLights = true;
    return game;
}

std::vector<Game> MakeGames() {
    Game deluxeQuake = Exposed("dq", "basedq", ".dq", "dq", 0.3f);
    deluxeQuake.gamma = 1.2f;
    deluxeQuake.patchShadows = deluxeQuake.deluxe = deluxeQuake.deluxeTangent = true;
    Game prophecy = Exposed("prophecy", "base", ".prophecy", "prophecy", 0.4f);
    prophecy.patchShadows = prophecy.deluxe = true;
    Game darkPlaces = Exposed("darkplaces", "id1", ".darkplaces", "darkplaces", 0.3f);
    Limits(darkPlaces, 999, 999, 6000);
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
    constexpr std::uint32_t kNoOb = 0x80000;
    for (Game &game : games)
        if (game.name != "quake3" && game.bevelSurfaceFlags == Game().bevelSurfaceFlags)
            game.bevelSurfaceFlags &= ~kNoOb;
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

} // namespace q3
