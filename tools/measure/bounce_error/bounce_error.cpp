// GPL-2.0-or-later. bounce_error: error of bounced light in lightmaps and SH grids against a path tracer, and of direct
// light in lightmaps against brute force.
//
// Luxels are drawn by area, positions uniformly where a player can be. Bounced light is the light of a bake with
// bounces minus that of one without: at the luxel, or of the grid on 26 normals. Reference: path_tracer.h.
#include "common/arguments.h"
#include "common/error.h"
#include "common/text/text.h"
#include "common/tool_main.h"
#include "q3map2/cli/global_options.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/stages/light_files.h"
#include "tools/measure/bounce_error/bounce_causes.h"
#include "tools/measure/bounce_error/direct_errors.h"
#include "tools/measure/bounce_error/lit_files.h"
#include "tools/measure/shbench/bakes.h"
#include "tools/measure/shbench/truth.h"

#include <cmath>
#include <glib.h>

#include <cstdio>
#include <map>
#include <numeric>
#include <sstream>

namespace q3::bounce {

namespace {

constexpr std::string_view kUsage = R"(usage: bounce_error [options] MAP.bsp...
  --bounce N,N...      settings to measure, inf: all bounces (1,4)
  --bake "NAME: LIGHT OPTIONS"   a setting to measure, with its -bounce; repeatable
  --options "LIGHT OPTIONS"   for the reference, and put before those of each setting
  --luxels N           luxels of each map, drawn by area (2000)
  --points N           positions where a player can be, for the SH grid; 0: no grid (500)
  --paths N            paths for each (4096)
  --seed N             of luxels and positions (1)
  --all-bounces        the reference has all bounces, not as many as the setting
  --worst N            lists the worst luxels of each setting
  --causes             shares of the error of one bounce
  --check              compares direct light of the reference with baked luxels
  --lit-direct A.bsp, --lit-bounced B.bsp, --lit-limit N   measures the lightmaps of these files of the map in place of
                       bakes, at --luxels points; N bounces (0: all)
  --direct             measures direct light instead: --bake and --options without -bounce, --luxels, --seed, --worst
  --lit FILE.bsp       with --direct: a lit file of the map without bounces, at --luxels points; repeatable
  --at "X Y Z", --at "X Y Z NX NY NZ"   with --direct: baked and true light of the luxel nearest to there, of those
                       that face along NX NY NZ, and then with true light at the point itself; repeatable
  --cache FOLDER, --no-cache   of the reference (the user's cache folder, q3map2-sh/bounce_error)
  -fs_basepath DIR, -fs_game MOD, -game NAME, -threads N   as for q3map2
Prints a table by map. Displayed errors, in bytes of 255: direct light with baked bounces against the same direct light
with path traced ones, both cut to 0..255, over luxels (or positions and 26 normals) and channels. bias: their mean,
signed. energy: sum of baked over sum of traced bounces. noise: standard error of the reference, RMS.
--direct: bytes of 255, baked against true direct light, both cut to 0..255. RMSE clear: of luxels whose position is
clear of walls and surfaces; of others the truth is the mean over clear places of the luxel. gross: luxels with an error
over 10 bytes outside two luxels of a shadow edge. Settings without --bake: default, -samples 2, -samples 3, -super 2,
-areashadows. A second table has the shares of causes in the squared error, and of luxels that have them.
)";

/// Rays per luxel of --causes.
constexpr int kCauseRays = 1024;

/// The command line, see kUsage.
struct BounceCommand {
    GlobalOptions game;
    std::vector<bench::BakeSetting> bakes;
    std::string options; ///< light options of the reference and of all bakes
    int luxels = 2000, points = 500, paths = 4096, worst = 0;
    std::uint64_t seed = 1;
    bool allBounces = false, causes = false, check = false, direct = false;
    std::filesystem::path cache;
    std::string litDirect, litBounced;
    int litBounces = 0;             ///< of litBounced; 0: all
    std::vector<std::string> lit;   ///< --lit
    std::vector<AskedPlace> places; ///< --at
    std::vector<std::string> maps;
};

void AddBounces(std::string_view list, BounceCommand &command) {
    while (!list.empty()) {
        const std::size_t comma = std::min(list.find(','), list.size());
        const std::string number(list.substr(0, comma));
        if (number != "inf" && IntegerFromText(number) < 1)
            throw Error("--bounce {}: expected whole numbers of at least 1, or inf", number);
        if (number != "inf" && !command.allBounces)
            LimitIndexOf(IntegerFromText(number)); // throws if the reference has no result for this number
        command.bakes.push_back({fmt::format("-bounce {}", number), fmt::format("-bounce {}", number)});
        list.remove_prefix(std::min(comma + 1, list.size()));
    }
}

AskedPlace PlaceOf(const std::string &text) {
    std::istringstream words(text);
    std::vector<float> numbers;
    for (float number; words >> number;)
        numbers.push_back(number);
    if (!words.eof() || (numbers.size() != 3 && numbers.size() != 6))
        throw Error("--at \"{}\": expected three or six numbers", text);
    AskedPlace place{{numbers[0], numbers[1], numbers[2]}, {}};
    if (numbers.size() == 6)
        place.normal = Normalize(Vec3f{numbers[3], numbers[4], numbers[5]});
    return place;
}

BounceCommand ParseBounceCommand(Arguments &arguments, Log &log) {
    BounceCommand command;
    command.allBounces = arguments.TakeFlag("--all-bounces");
    bool hasBakes = false;
    while (const auto text = arguments.TakeValue("--bounce"))
        AddBounces(*text, command), hasBakes = true;
    while (const auto text = arguments.TakeValue("--bake"))
        command.bakes.push_back(bench::ParseBakeSetting(*text)), hasBakes = true;
    command.direct = arguments.TakeFlag("--direct");
    if (!hasBakes && command.direct)
        command.bakes = {{"default", ""},
                         {"-samples 2", "-samples 2"},
                         {"-samples 3", "-samples 3"},
                         {"-super 2", "-super 2"},
                         {"-areashadows", "-areashadows"}};
    else if (!hasBakes)
        AddBounces("1,4", command);
    while (const auto text = arguments.TakeValue("--lit"))
        command.lit.push_back(*text);
    while (const auto text = arguments.TakeValue("--at"))
        command.places.push_back(PlaceOf(*text));
    if (!command.direct && (!command.lit.empty() || !command.places.empty()))
        throw Error("--lit, --at: expected --direct");
    while (const auto text = arguments.TakeValue("--options"))
        command.options = *text;
    command.luxels = arguments.TakeInteger("--luxels", command.luxels, 1);
    command.points = arguments.TakeInteger("--points", command.points, 0);
    command.paths = arguments.TakeInteger("--paths", command.paths, 2 * kPathGroup);
    command.seed = std::uint64_t(arguments.TakeInteger("--seed", 1, 0));
    command.worst = arguments.TakeInteger("--worst", 0, 0);
    command.causes = arguments.TakeFlag("--causes");
    command.check = arguments.TakeFlag("--check");
    while (const auto text = arguments.TakeValue("--lit-direct"))
        command.litDirect = *text;
    while (const auto text = arguments.TakeValue("--lit-bounced"))
        command.litBounced = *text;
    command.litBounces = arguments.TakeInteger("--lit-limit", 0, 0);
    if (command.litDirect.empty() != command.litBounced.empty())
        throw Error("--lit-direct, --lit-bounced: expected both");
    command.cache = std::filesystem::path(g_get_user_cache_dir()) / "q3map2-sh" / "bounce_error";
    while (const auto text = arguments.TakeValue("--cache"))
        command.cache = *text;
    if (arguments.TakeFlag("--no-cache"))
        command.cache.clear();
    command.game = ParseGlobalOptions(arguments, log);
    command.maps = arguments.Rest();
    if (command.maps.empty())
        throw Error("expected a .bsp");
    return command;
}

void PrintErrors(const std::string &map, std::string_view where, const std::string &name, double seconds,
                 const BounceErrors &e) {
    fmt::print("| {} | {} | {} | {:.2f} | {:.3f} | {:.2f} | {:.2f} | {:+.3f} | {:.4f} | {:.3f} | {:.2f} |\n", map, name,
               where, seconds, e.rmse, e.percentile95, e.percentile99, e.bias, e.energy, e.noise, e.meanLight);
    std::fflush(stdout);
}

std::string VectorText(const Vec3f &v) {
    return fmt::format("{:.1f} {:.1f} {:.1f}", v.x, v.y, v.z);
}

/// The numbers of the `count` receivers with the largest errors, the largest first. squareOf(number): squared error.
template <typename SquareOf> std::vector<std::size_t> WorstOf(std::size_t all, int count, const SquareOf &squareOf) {
    std::vector<std::size_t> order(all);
    std::iota(order.begin(), order.end(), std::size_t(0));
    const auto shown = std::min(order.size(), std::size_t(count));
    std::partial_sort(order.begin(), order.begin() + std::ptrdiff_t(shown), order.end(),
                      [&](std::size_t a, std::size_t b) { return squareOf(a) > squareOf(b); });
    order.resize(shown);
    return order;
}

void PrintWorst(const CauseInputs &inputs, std::span<const ComparedLight> light, int count) {
    const Bsp &bsp = inputs.in.bsp;
    const Receivers &receivers = inputs.receivers;
    for (const std::size_t i :
         WorstOf(light.size(), count, [&](std::size_t number) { return SquaredError(light[number]); })) {
        const LuxelReceiver &at = receivers.luxels[i];
        const ComparedLight &one = light[i];
        const auto &shader = bsp.shaders[std::size_t(bsp.drawSurfaces[std::size_t(at.surface)].shaderNum)];
        fmt::print("  error {:.2f} at {} normal {:.2f} {:.2f} {:.2f}: direct {}, bounced {}, traced {} +- {}; {}; {}\n",
                   std::sqrt(SquaredError(one) / 3), VectorText(at.position), at.normal.x, at.normal.y, at.normal.z,
                   VectorText(one.direct), VectorText(one.bounced), VectorText(one.traced), VectorText(one.tracedError),
                   FieldName(shader.shader), SurroundingsText(inputs, at));
    }
}

/// One map: its reference and its bakes.
class MapMeasure {
  public:
    MapMeasure(const BounceCommand &command, const MeasuredMap &map, const JobPool &jobs)
        : command_(command), map_(map), jobs_(jobs), setup_(map, SettingsOf("")), in_{setup_.light.bsp,
                                                                                      setup_.light.space,
                                                                                      setup_.light.scene,
                                                                                      setup_.light.table,
                                                                                      setup_.light.options,
                                                                                      setup_.settings.lightmap,
                                                                                      setup_.light.world,
                                                                                      jobs,
                                                                                      map.log},
          direct_(BakeLuxels(setup_, 0, jobs, map.log, &surfaces_)), lights_(in_, SurfaceLights()),
          tracer_(in_, surfaces_, lights_) {}

    /// Measures lit files instead of bakes.
    void RunLit() {
        const int side = command_.game.game->lightmapSize;
        const auto direct = compare::LitMap::Load(command_.litDirect, side, map_.log);
        const auto all = compare::LitMap::Load(command_.litBounced, side, map_.log);
        const LitFiles files{direct, all};
        const auto points = LitPoints(in_, tracer_.Scene(), files, command_.luxels, command_.seed);
        receivers_ = ReceiversOf(points);
        Trace();
        const auto light = CompareLit(points, reference_, LimitIndexOf(command_.litBounces), files);
        PrintErrors(map_.inputs.name, "lightmap points", command_.litBounced, 0, ErrorsOf(light));
        fmt::print(stderr, "{} points are not too bright\n", light.size());
    }

    /// Measures direct light; adds a row for each bake and lit file.
    void RunDirect(std::vector<DirectRow> &rows) {
        std::vector<LuxelReceiver> luxels =
            LuxelsByArea(in_, surfaces_, tracer_.Scene(), command_.luxels, command_.seed);
        const std::size_t drawn = luxels.size();
        for (const AskedPlace &place : command_.places)
            if (const auto nearest = NearestLuxel(in_, surfaces_, tracer_.Scene(), place)) {
                luxels.push_back(*nearest);
                if (place.normal != Vec3f{})
                    luxels.push_back(AtPlace(*nearest, place));
            }
        const DirectReference reference = TraceDirect(luxels);
        for (const bench::BakeSetting &bake : command_.bakes) {
            const std::string key = OptionsWithoutBounces(bake.options);
            const BakedLuxels own = key.empty() ? BakedLuxels{} : BakeDirect(bake.options);
            const BakedLuxels &baked = key.empty() ? direct_ : own;
            const auto light = CompareDirect(surfaces_, luxels, reference.luxels, LightAt(surfaces_, luxels, baked));
            fmt::print("{}, {}:\n", map_.inputs.name, bake.name);
            for (std::size_t i = drawn; i < luxels.size(); ++i)
                fmt::print("{}", DirectText(map_.bsp, luxels[i], light[i]));
            AddDirectRow(bake.name, baked.cpuSeconds, luxels, std::span(light).first(drawn), rows);
        }
        for (const std::string &file : command_.lit)
            RunDirectLit(file, rows);
    }

    void Run() {
        receivers_.luxels =
            LuxelsByArea(in_, surfaces_, tracer_.Scene(), command_.luxels, command_.seed, &receivers_.hiddenShare);
        if (command_.points > 0)
            receivers_.positions =
                bench::PlayerPositions(map_.bsp, setup_.light.space, map_.inputs.name, command_.points, command_.seed);
        Trace();
        const CauseInputs causes{in_, surfaces_, tracer_, lights_, receivers_, direct_};
        if (command_.check)
            fmt::print("{}", DirectCheckText(causes));
        for (const bench::BakeSetting &bake : command_.bakes) {
            const bench::LightmapSettings settings = SettingsOf(bake.options);
            const std::size_t limit = command_.allBounces ? kAllBounces : LimitIndexOf(settings.lightmap.bounces);
            const auto light = MeasureLuxels(bake, settings, limit);
            PrintWorst(causes, light, command_.worst);
            if (command_.causes && settings.lightmap.bounces == 1)
                fmt::print("{}", CausesText(causes, light, std::min(command_.paths, kCauseRays)));
            if (!receivers_.positions.empty())
                MeasureGrid(bake, settings, limit);
        }
    }

  private:
    DirectReference TraceDirect(const std::vector<LuxelReceiver> &luxels) const {
        std::vector<TruthReceiver> receivers;
        for (const LuxelReceiver &luxel : luxels)
            receivers.push_back(TruthReceiverOf(surfaces_, luxel));
        DirectReference reference = MakeDirectReference(in_, lights_, receivers, command_.cache);
        fmt::print(stderr, "{}: {} lights, {} receivers, reference {:.1f} CPU s{}\n", map_.inputs.name,
                   lights_.Lights().size(), luxels.size(), reference.cpuSeconds,
                   reference.fromCache ? " (from the cache)" : "");
        return reference;
    }
    BakedLuxels BakeDirect(const std::string &options) const {
        const MapSetup setup(map_, SettingsOf(options), MeasuredLight::Direct);
        return BakeLuxels(setup, 0, jobs_, map_.log);
    }
    void RunDirectLit(const std::string &file, std::vector<DirectRow> &rows) const {
        const auto lit = compare::LitMap::Load(file, command_.game.game->lightmapSize, map_.log);
        auto points = LitPoints(in_, tracer_.Scene(), {lit, lit}, command_.luxels, command_.seed);
        std::vector<LuxelReceiver> luxels = LuxelsOf(surfaces_, points);
        const DirectReference reference = TraceDirect(luxels);
        std::vector<Vec3f> found;
        for (const LitPoint &one : points)
            found.push_back(Vec3f(lit.Light(one.surface, one.point)));
        auto light = CompareDirect(surfaces_, luxels, reference.luxels, found);
        RemoveTooBright(luxels, light);
        const std::string name = std::filesystem::path(file).filename().string();
        fmt::print("{}, {}:\n", map_.inputs.name, name);
        fmt::print(stderr, "{} points are not too bright\n", light.size());
        AddDirectRow(name, -1, luxels, light, rows);
    }
    /// Also prints the worst receivers.
    void AddDirectRow(const std::string &setting, double seconds, std::span<const LuxelReceiver> luxels,
                      std::span<const ComparedDirect> light, std::vector<DirectRow> &rows) const {
        for (const std::size_t i : WorstOf(light.size(), command_.worst,
                                           [&](std::size_t number) { return SquaredError(light[number].light); }))
            fmt::print("{}", DirectText(map_.bsp, luxels[i], light[i]));
        std::fflush(stdout);
        rows.push_back({map_.inputs.name, setting, seconds, DirectErrorsOf(light)});
    }
    void Trace() {
        reference_ = MakeReference(in_, tracer_, lights_, receivers_, command_.paths, command_.cache);
        fmt::print(stderr,
                   "{}: {} lights, {} luxels, hidden {:.1f} % of area, {} positions, reference {:.1f} CPU s{}\n",
                   map_.inputs.name, lights_.Lights().size(), receivers_.luxels.size(), 100 * receivers_.hiddenShare,
                   receivers_.positions.size(), reference_.cpuSeconds, reference_.fromCache ? " (from the cache)" : "");
    }
    bench::LightmapSettings SettingsOf(const std::string &options) const {
        return bench::LightmapSettingsFrom(command_.options + " " + options, *command_.game.game);
    }
    std::vector<Light> SurfaceLights() const {
        int culled = 0;
        return SetupEnvelopes(setup_.light.lights, LightPass::Surfaces, setup_.light.options, setup_.light.space,
                              setup_.light.skySeenFrom, culled, setup_.settings.lightmap.fastPoint);
    }

    std::vector<ComparedLight> MeasureLuxels(const bench::BakeSetting &bake, const bench::LightmapSettings &settings,
                                             std::size_t limit) {
        const std::string key = OptionsWithoutBounces(bake.options);
        std::unique_ptr<MapSetup> own;
        if (!key.empty())
            own = std::make_unique<MapSetup>(map_, settings);
        const MapSetup &setup = own ? *own : setup_;
        if (own && !directLuxels_.contains(key))
            directLuxels_.emplace(key, BakeLuxels(setup, 0, jobs_, map_.log));
        const BakedLuxels &direct = own ? directLuxels_.at(key) : direct_;
        const BakedLuxels baked = BakeLuxels(setup, settings.lightmap.bounces, jobs_, map_.log);
        auto light = CompareLuxels(receivers_, reference_, limit, direct, baked);
        PrintErrors(map_.inputs.name, "luxels", bake.name, baked.cpuSeconds - direct.cpuSeconds, ErrorsOf(light));
        return light;
    }

    void MeasureGrid(const bench::BakeSetting &bake, const bench::LightmapSettings &settings, std::size_t limit) {
        const std::string key = OptionsWithoutBounces(bake.options);
        if (!directGrids_.contains(key))
            directGrids_.emplace(key, BakeGrid(map_, settings, 0, jobs_));
        const BakedGrid &direct = directGrids_.at(key);
        const BakedGrid baked = BakeGrid(map_, settings, settings.lightmap.bounces, jobs_);
        const auto light = ComparePositions(receivers_, reference_, limit, direct.bsp, baked.bsp);
        PrintErrors(map_.inputs.name, "SH grid", bake.name, baked.cpuSeconds - direct.cpuSeconds, ErrorsOf(light));
    }

    const BounceCommand &command_;
    const MeasuredMap &map_;
    const JobPool &jobs_;
    const MapSetup setup_; // for the options of the reference
    const SurfaceInputs in_;
    SurfaceLight surfaces_;    // of the bake direct_
    const BakedLuxels direct_; // without bounces
    const DirectLights lights_;
    const PathTracer tracer_;
    Receivers receivers_;
    Reference reference_;
    // Bakes without bounces, by OptionsWithoutBounces. Luxels without other options are in direct_.
    std::map<std::string, BakedLuxels> directLuxels_;
    std::map<std::string, BakedGrid> directGrids_;
};

int Run(const std::vector<std::string> &words) {
    Arguments arguments(words);
    if (arguments.TakeFlag({"--help", "-h"}) || arguments.Empty()) {
        fmt::print("{}", kUsage);
        return 0;
    }
    Log log(PrintWarnings);
    const BounceCommand command = ParseBounceCommand(arguments, log);
    const VirtualFileSystem files = OpenGameFiles(command.game, GameFolders(command.game, {}, {}), log);
    const JobPool jobs(command.game.threads);
    if (!command.direct)
        fmt::print("| map | setting | light | CPU s over direct | RMSE | 95 % | 99 % | bias | energy | noise | mean |\n"
                   "|---|---|---|---|---|---|---|---|---|---|---|\n");
    std::vector<DirectRow> rows;
    for (const std::string &name : command.maps) {
        const MeasuredMap map{files, *command.game.game, ReadBspFile(name, command.game.Format(), log),
                              ReadLightInputs(FilesOf(name), log), log};
        MapMeasure measure(command, map, jobs);
        if (command.direct)
            measure.RunDirect(rows);
        else if (command.litDirect.empty())
            measure.Run();
        else
            measure.RunLit();
    }
    if (command.direct)
        fmt::print("{}", DirectTables(rows));
    return 0;
}

} // namespace

} // namespace q3::bounce

int main(int count, char **words) {
    return q3::RunTool("bounce_error", count, words, q3::bounce::Run);
}
