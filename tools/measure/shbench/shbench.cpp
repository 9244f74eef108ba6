// GPL-2.0-or-later. shbench: error of the SH light grid against time and size.
#include "common/error.h"
#include "common/files/files.h"
#include "common/tool_main.h"
#include "q3map2/cli/program.h"
#include "q3map2/cli/stage_files.h"
#include "tools/measure/shbench/bench_run.h"
#include "tools/measure/shbench/drawing.h"
#include "tools/measure/shbench/embree_throughput.h"
#include "tools/measure/shbench/lightmap_passes.h"
#include "tools/measure/shbench/scaling.h"

#include <glib.h>

#include <cstdio>
#include <memory>
#include <new>
#include <system_error>

namespace q3::bench {

namespace {

constexpr std::string_view kUsage =
    R"(usage: shbench [options] maps/x.bsp       error of the SH grid against time and size: docs/internals/shbench.md
       shbench --scale-lights [options]     time against the number of lights, in a hall made for it
       shbench --scale-cells [options] maps/x.bsp   time against the number of points
       shbench --lightmaps [options] maps/x.bsp     time and rays of lightmaps, pass by pass
  -game -fs_basepath -fs_game -threads ...  as for q3map2
  --options "LIGHT OPTIONS"                 for the reference and all bakes, or for the lightmaps
  --bake "NAME: LIGHT OPTIONS"              a setting to measure, instead of the usual list; repeatable
  --positions N, --seed N                   of the reference (2000, 1)
  --repeat N                                bakes in turn so often, quotes the least CPU time (1)
  --raw, --no-raw                           measures bare Embree, or does not (it does)
  --no-baselines                            neither the naive baseline nor the legacy grid
  --cache FOLDER, --no-cache                of the reference (the user's cache folder, q3map2-sh/shbench)
  --worst N, --worst-of NAME                lists the worst positions of a setting (default), and why
  --worst-by reference|projection           worst against the light there (usual), or against its exact projection
  --worst-picture FILE                      a plan of the map with them, .png or .svg; 12 unless --worst
  --errors, --errors-of NAME                writes maps/x.sherror.json: errors by position, of the first setting or NAME
  --errors-file FILE                        the same to another file
  --lights N                                most lights of --scale-lights (10000)
  --json FILE, --plot BASENAME              results as JSON; plots as BASENAME.svg and .png, BASENAME-bytes.svg and .png
)";

constexpr int kUsualWorstCount = 12; ///< positions of --worst-picture

/// What the command line asks for.
struct Command {
    GlobalOptions global;
    BenchSettings settings;
    std::string jsonFile, plotBase, worstPicture, errorFile, map;
    bool scaleLights = false, scaleCells = false, lightmaps = false;
    int maxLights = 10000; ///< of --scale-lights
};

std::string TakeText(Arguments &arguments, std::string_view name, std::string fallback = {}) {
    while (auto text = arguments.TakeValue(name))
        fallback = std::move(*text);
    return fallback;
}

void ParseWorst(Arguments &arguments, Command &command) {
    BenchSettings &settings = command.settings;
    command.worstPicture = TakeText(arguments, "--worst-picture");
    settings.drawWorst = !command.worstPicture.empty();
    if (settings.drawWorst && !IsPictureName(command.worstPicture))
        throw Error("--worst-picture {}: expected a name that ends in .png or .svg", command.worstPicture);
    const int usual = settings.drawWorst ? kUsualWorstCount : 0, least = settings.drawWorst ? 1 : 0;
    settings.worstCount = std::size_t(arguments.TakeInteger("--worst", usual, least));
    const std::string of = TakeText(arguments, "--worst-of"), by = TakeText(arguments, "--worst-by");
    if (settings.worstCount == 0 && !(of.empty() && by.empty()))
        throw Error("--worst-of, --worst-by: expected --worst or --worst-picture with it");
    if (!of.empty())
        settings.worstOf = of;
    if (!by.empty() && by != "reference" && by != "projection")
        throw Error("--worst-by {}: expected reference or projection", by);
    settings.worstBy = by == "projection" ? WorstBy::Projection : WorstBy::Reference;
}

void ParseErrorList(Arguments &arguments, Command &command) {
    BenchSettings &settings = command.settings;
    settings.errorsOf = TakeText(arguments, "--errors-of");
    command.errorFile = TakeText(arguments, "--errors-file");
    const bool isAsked = arguments.TakeFlag("--errors");
    settings.listErrors = isAsked || !command.errorFile.empty() || !settings.errorsOf.empty();
}

Command ParseCommand(Arguments arguments, Log &log) {
    Command command;
    BenchSettings &settings = command.settings;
    while (const auto text = arguments.TakeValue("--bake"))
        settings.bakes.push_back(ParseBakeSetting(*text));
    settings.options = TakeText(arguments, "--options");
    settings.truth.positions = arguments.TakeInteger("--positions", settings.truth.positions, 1);
    settings.truth.seed = std::uint64_t(arguments.TakeInteger("--seed", 1, 0));
    settings.repeats = arguments.TakeInteger("--repeat", 1, 1);
    ParseWorst(arguments, command);
    ParseErrorList(arguments, command);
    settings.cache = std::filesystem::path(g_get_user_cache_dir()) / "q3map2-sh" / "shbench";
    settings.cache = TakeText(arguments, "--cache", settings.cache.string());
    if (arguments.TakeFlag("--no-cache"))
        settings.cache.clear();
    const bool noRaw = arguments.TakeFlag("--no-raw");
    settings.measureRaw = arguments.TakeFlag("--raw") || !noRaw;
    settings.measureBaselines = !arguments.TakeFlag("--no-baselines");
    command.jsonFile = TakeText(arguments, "--json");
    command.plotBase = TakeText(arguments, "--plot");
    command.scaleLights = arguments.TakeFlag("--scale-lights");
    command.scaleCells = arguments.TakeFlag("--scale-cells");
    command.lightmaps = arguments.TakeFlag("--lightmaps");
    command.maxLights = arguments.TakeInteger("--lights", command.maxLights, 1);
    command.global = ParseGlobalOptions(arguments, log);
    command.map = arguments.TakeLast();
    if (!arguments.Empty())
        throw Error("unknown argument {}", arguments.Rest().front());
    return command;
}

void Print(const std::string &text, std::FILE *to = stdout) {
    std::fwrite(text.data(), 1, text.size(), to);
}

void WriteText(const std::string &file, const std::string &text) {
    if (!file.empty())
        ReplaceTextFile(file, text);
}

void ReportScaling(const Command &command, const std::vector<ScalingStep> &steps, const std::string &size,
                   const std::string &title) {
    Print(ScalingTable(steps, size));
    WriteText(command.jsonFile, ScalingJson(steps, size));
    if (command.plotBase.empty())
        return;
    WriteChart(ScalingChart(steps, size, "CPU time against " + title, ScalingValue::CpuSeconds), command.plotBase);
    WriteChart(ScalingChart(steps, size, "rays against " + title, ScalingValue::Rays), command.plotBase + "-rays");
}

/// Prints and stores the cost of each pass over surfaces. The rate of bare Embree is the mean of measurements before
/// and after.
void RunLightmaps(const Command &command, const LightmapSettings &settings, BenchFiles &files, const JobPool &jobs) {
    const BenchSettings &bench = command.settings;
    std::unique_ptr<EmbreeThroughput> raw;
    if (bench.measureRaw)
        raw = std::make_unique<EmbreeThroughput>(files.Map(), DefaultLayout(files.Map()), bench.truth.seed);
    const double before = raw ? raw->PerSecond(bench.rawSeconds) : 0;
    const auto passes = LightmapPasses(files.Map(), settings, files.Library(), jobs, bench.repeats);
    const double after = raw ? raw->PerSecond(bench.rawSeconds) : 0;
    Print(LightmapPassTable(passes, (before + after) / 2));
    WriteText(command.jsonFile, LightmapPassJson(passes, (before + after) / 2));
}

int Run(const std::vector<std::string> &words, const std::filesystem::path &program) {
    Log log(PrintWarnings);
    Command command = ParseCommand(Arguments(words), log);
    if (command.global.help || (command.map.empty() && !command.scaleLights)) {
        Print(std::string(kUsage), command.global.help ? stdout : stderr);
        return command.global.help ? 0 : 1;
    }
    Log progress([](LogLevel, std::string_view text) { Print(std::string(text), stderr); });
    const JobPool jobs(command.global.threads);
    BenchSettings &settings = command.settings;
    const Game &game = *command.global.game;
    LightmapSettings lightmaps;
    if (command.lightmaps)
        lightmaps = LightmapSettingsFrom(settings.options, game);
    const LightOptions options = command.lightmaps ? lightmaps.light : LightOptionsFrom(settings.options, game);
    if (command.scaleLights) {
        const auto steps = ScaleLights(options, game, jobs, command.maxLights, settings.repeats, progress);
        ReportScaling(command, steps, "lights", "the number of lights");
        return 0;
    }
    const auto path = WithExtension(std::filesystem::absolute(command.map), ".bsp");
    BenchFiles files(command.global, words, program, path, options, log);
    if (command.lightmaps) {
        RunLightmaps(command, lightmaps, files, jobs);
        return 0;
    }
    if (command.scaleCells) {
        const auto steps = ScaleCells(files.Map(), files.Library(), options, jobs, settings.repeats, progress);
        ReportScaling(command, steps, "points", "the number of points, " + files.Map().inputs.name);
        return 0;
    }
    const BenchResult result = RunBench(files.Map(), files.Library(), settings, game, jobs, progress);
    Print(TableText(result.report) + result.worst);
    WriteText(command.jsonFile, JsonText(result.report));
    if (settings.listErrors)
        ReplaceTextFile(command.errorFile.empty() ? WithExtension(path, ".sherror.json").string() : command.errorFile,
                        result.errors);
    if (!command.plotBase.empty()) {
        WriteChart(ErrorChart(result.report), command.plotBase);
        WriteChart(SizeChart(result.report), command.plotBase + "-bytes");
    }
    if (result.worstView)
        WriteErrorTopView(*result.worstView, command.worstPicture);
    return 0;
}

} // namespace

} // namespace q3::bench

int main(int argc, char **argv) {
    std::error_code failed;
    auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
    if (failed)
        program = argv[0];
    try {
        return q3::bench::Run({argv + 1, argv + argc}, program);
    } catch (const std::bad_alloc &) {
        std::fputs("shbench: out of memory\n", stderr);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "shbench: %s\n", error.what());
    }
    return 1;
}
