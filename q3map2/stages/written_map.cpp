// GPL-2.0-or-later. What stages that write a map check: the format for it, bot files beside it, the memory of engines.
#include "q3map2/stages/written_map.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/bspfile/bspfile_rbsp.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/shader/games.h"

#include <algorithm>
#include <set>
#include <utility>

namespace q3 {

// ---- The format of a map, and of the game ----

namespace {

/// Values of -game whose files have this format: "sof2, jk2, ja".
std::string GamesWith(std::string_view ident) {
    std::string names;
    for (const Game &game : Games())
        if (game.bspIdent == ident)
            names += fmt::format("{}{}", names.empty() ? "" : ", ", game.name);
    return names;
}

} // namespace

BspFormat FormatOfMap(const Bsp &bsp, const std::filesystem::path &path, const GlobalOptions &options) {
    if (!options.games.empty())
        RequireFormatOfGame(bsp, path, options);
    BspFormat format = options.Format();
    if (bsp.ident != format.ident)
        format = {.version = kRbspVersion, .force = options.force, .ident = bsp.ident};
    return format;
}

void RequireFormatOfGame(const Bsp &bsp, const std::filesystem::path &path, const GlobalOptions &options) {
    const Game &game = *options.game;
    if (bsp.ident != game.bspIdent)
        throw Error("{}: a map of the format {}, but those of -game {} are {}: give -game with one of {}",
                    path.string(), bsp.ident, game.name, game.bspIdent, GamesWith(bsp.ident));
}

// ---- Whether bot files still fit a map after it was written ----

BotCheck::BotCheck(std::filesystem::path bspPath, Log &log) : bspPath_(std::move(bspPath)), log_(log) {
    try {
        files_ = FindBotFiles(bspPath_);
        if (!files_.empty() && std::filesystem::exists(bspPath_))
            before_ = MapChecksum(bspPath_);
    } catch (const Error &error) {
        log_.Warn("bot file", "{}", error.what());
    }
}

void BotCheck::Fix(const BotFile &file, std::uint32_t checksum) const {
    SetChecksum(file, checksum);
    log_.Print("{} fits the map again\n", file.path.string());
    if (file.checksum != before_)
        log_.Warn("bot file",
                  "{} did not fit the map before either: if brushes have changed since it was made, bots walk into "
                  "walls; then make it again with a bot compiler",
                  file.path.string());
}

void BotCheck::Report(Change change, Remedy remedy) const {
    if (files_.empty())
        return;
    const std::uint32_t checksum = MapChecksum(bspPath_);
    for (const BotFile &file : files_) {
        if (file.checksum == checksum)
            continue;
        if (remedy == FixFiles && change == SameGeometry) {
            Fix(file, checksum);
            continue;
        }
        const std::string advice =
            change == OtherGeometry
                ? fmt::format("make it again with a bot compiler or, if no brush has changed, run q3map2 -fixaas {}",
                              bspPath_.string())
                : fmt::format("q3map2 -fixaas {} makes it fit again", bspPath_.string());
        const std::string text =
            fmt::format("{} is for another version of the map, and engines refuse it, so there will be no bots: {}",
                        file.path.string(), advice);
        log_.Warn("bot file", "{}", text);
    }
}

void WarnOfPackedBotFile(const std::filesystem::path &bspPath, std::span<const std::byte> botFile,
                         const std::string &origin, Log &log) {
    try {
        if (ChecksumIn(botFile, origin) != MapChecksum(bspPath))
            log.Warn(
                "bot file",
                "{} is for another version of {}, and engines refuse it, so there will be no bots: copy it next to "
                "the map and run q3map2 -fixaas on the map or, if brushes have changed, make it again with a bot "
                "compiler",
                origin, bspPath.string());
    } catch (const Error &error) {
        log.Warn("bot file", "{}", error.what());
    }
}

// ---- Whether the engines of a game can load a .bsp with the memory that they have by default ----

namespace {

/// Bytes that the game itself takes while a map is loaded: its modules, player models, bots. ioquake3 with OpenArena
/// takes 5 to 7 MB with modules as libraries, and more with .qvm files.
constexpr std::uint64_t kGameBytes = 12000000;
constexpr std::uint64_t kMebibyte = 1 << 20;
constexpr std::uint64_t kHunkStep = 64; ///< MiB; proposed values of com_hunkMegs are multiples

/// How to make the largest part of the file smaller.
std::string AdviceFor(const Bsp &bsp, std::uint64_t fileBytes) {
    if (BytesOfLump(bsp, BspxId::LightGridSH) * 2 > fileBytes) {
        const Float3 &cell = bsp.gridSH->header.gridSize;
        if (cell[0] * cell[1] * cell[2] < kSmallCellSH * kSmallCellSH * kSmallCellSH)
            return "Light it with -shsmall instead of a smaller cell, or with -shadaptive instead of the uniform grid";
        return fmt::format("Light it with larger cells than {:g} {:g} {:g} (-gridsh), or with -shadaptive instead of "
                           "the uniform grid",
                           cell[0], cell[1], cell[2]);
    }
    if ((BytesOfLump(bsp, BspxId::LightmapsE5bgr9) + bsp.lightmaps.size()) * 2 > fileBytes)
        return "Larger luxels (-samplesize of the bsp stage) make smaller lightmaps";
    return "Leave out what it does not need; -info lists the sizes of its lumps";
}

} // namespace

std::uint64_t EngineMemoryFor(const Bsp &bsp, std::uint64_t fileBytes) {
    const std::uint64_t extensions = std::min(BytesOfBspx(bsp), fileBytes);
    return fileBytes + (fileBytes - extensions) + kGameBytes;
}

namespace {

/// Warns of lightmaps and of light styles that are more than engines draw.
void WarnOfLightmapLimits(const std::filesystem::path &bspPath, const Bsp &bsp, const Game &game, Log &log) {
    std::set<std::pair<Styles, Styles>> sets;
    for (const bspDrawSurface_t &surface : bsp.drawSurfaces)
        sets.emplace(surface.lightmapStyles, surface.vertexStyles);
    const std::int64_t pages = bsp.NamedPages();
    if (game.maxStyleSets > 0 && sets.size() > std::size_t(game.maxStyleSets))
        log.Warn("too many sets of light styles",
                 "{}: surfaces have {} different sets of light styles, engines of {} load no map with over {}: use "
                 "fewer styles, "
                 "or let lights that reach the same surfaces share one",
                 bspPath.string(), sets.size(), game.name, game.maxStyleSets);
    if (game.maxLightmaps > 0 && pages > game.maxLightmaps)
        log.Warn("too many lightmaps",
                 "{}: surfaces use {} lightmap pages, engines of {} have room for {}: use larger luxels (-samplesize)",
                 bspPath.string(), pages, game.name, game.maxLightmaps);
}

} // namespace

void WarnOfEngineLimits(const std::filesystem::path &bspPath, const Bsp &bsp, const Game &game, Log &log) {
    WarnOfLightmapLimits(bspPath, bsp, game, log);
    WarnOfEngineMemory(bspPath, bsp, game, log);
}

void WarnOfEngineMemory(const std::filesystem::path &bspPath, const Bsp &bsp, const Game &game, Log &log) {
    const std::uint64_t file = SizeOfFile(bspPath), needed = EngineMemoryFor(bsp, file);
    const std::uint64_t limit = std::uint64_t(EngineMegabytes(game)) * kMebibyte;
    if (limit == 0 || needed <= limit)
        return;
    const std::uint64_t enough = (needed / kMebibyte / kHunkStep + 1) * kHunkStep;
    log.Warn("too large for engines",
             "{} has {} and needs about {} of an engine's memory for maps, of which ioquake3 has {} by default: it may "
             "refuse the map (Hunk_AllocateTempMemory: failed). {}; or have players start the game with +set "
             "com_hunkMegs {}",
             bspPath.string(), SizeText(file), SizeText(needed), SizeText(limit), AdviceFor(bsp, file), enough);
}

} // namespace q3
