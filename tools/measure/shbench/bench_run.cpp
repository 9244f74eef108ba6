// GPL-2.0-or-later. The benchmark of one map: reference, bakes, errors.
#include "tools/measure/shbench/bench_run.h"

#include "common/error.h"
#include "q3map2/cli/stage_files.h"
#include "q3map2/stages/light_files.h"
#include "tools/measure/shbench/embree_throughput.h"
#include "tools/measure/shbench/plain.h"

#include <algorithm>
#include <functional>

namespace q3::bench {

namespace {

/// A line of the report and how it is made.
struct Contender {
    BenchLine line;
    std::function<Baked()> bake;
};

/// Layout of the grid that a line of the report measures.
GridLayout LayoutOf(const BenchMap &map, const Baked &baked, BakedFormat format) {
    if (format == BakedFormat::GridSH) {
        const bspGridSHHeader_t &header = baked.bsp.gridSH->header;
        return {header.gridMins, header.gridSize, header.gridBounds};
    }
    Log silent(Log::Nowhere());
    Entity world = map.stored.front();
    return SetupGrid(map.bsp, world, silent);
}

/// Lists, and draws if asked for, the worst positions of one setting.
void ReportWorst(const BenchMap &map, const Truth &truth, const BenchSettings &settings, const Contender &contender,
                 const Baked &baked, const ShownLight &shown, const JobPool &jobs, BenchResult &result) {
    const std::vector<PositionErrors> errors = ErrorsByPlace(truth, shown);
    const auto causes = FindCauses(map, LayoutOf(map, baked, contender.line.format), truth, errors, jobs);
    const auto worst = WorstPositions(truth, shown, settings.worstCount, settings.worstBy);
    result.worst = WorstText(truth, worst, errors, causes, contender.line.name);
    if (!settings.drawWorst)
        return;
    const bool isBake = contender.line.name != kPlainName &&
                        contender.line.format == BakedFormat::GridSH; // `options` of the other lines is plain text
    const std::string options = settings.options + (isBake ? " " + contender.line.options : "");
    std::string setting = contender.line.name;
    if (options.find('-') != std::string::npos)
        setting += ": " + options;
    const std::string grid = contender.line.format == BakedFormat::LegacyGrid ? "legacy grid" : "SH grid";
    result.worstView = MakeErrorTopView(map, {truth, errors, causes, worst, settings.worstBy, grid, setting}, jobs);
}

/// The words of the text with one blank between them.
std::string OneSpaced(const std::string &text) {
    std::string spaced;
    for (const std::string &word : WordsOf(text))
        spaced += (spaced.empty() ? "" : " ") + word;
    return spaced;
}

/// Enters the errors of the listed setting and of the legacy grid.
void AddToErrorList(const Truth &truth, const BenchSettings &settings, const Contender &contender,
                    const ShownLight &shown, ErrorList &list) {
    if (contender.line.name == settings.errorsOf) {
        list.setting = contender.line.name;
        list.options = OneSpaced(settings.options + " " + contender.line.options);
        list.sh = ShownErrorsByPlace(truth, shown);
    } else if (contender.line.name == kLegacyName) {
        list.legacy = ShownErrorsByPlace(truth, shown);
    }
}

/// Bakes all contenders in turn, so that changes of the clock rate affect them alike, and keeps the least time of each.
/// Bare Embree is measured between the bakes for the same reason.
void BakeInTurn(const BenchMap &map, std::vector<Contender> &contenders, const Truth &truth,
                const EmbreeThroughput *raw, const BenchSettings &settings, const JobPool &jobs, Log &progress,
                BenchResult &result) {
    ErrorList list;
    std::vector<double> &rates = result.report.rawRates;
    const auto addRawRate = [&] {
        if (raw)
            rates.push_back(raw->PerSecond(settings.rawSeconds));
    };
    addRawRate();
    for (int repeat = 0; repeat < settings.repeats; ++repeat)
        for (Contender &contender : contenders) {
            progress.Print("{} ({} of {})\n", contender.line.name, repeat + 1, settings.repeats);
            const Baked baked = contender.bake();
            addRawRate();
            if (raw && rates.back() > 0) {
                const double rawRate = (rates[rates.size() - 2] + rates.back()) / 2;
                contender.line.sharesOfRaw.push_back(double(baked.cost.rays) / baked.cost.cpuSeconds / rawRate);
            }
            if (repeat == 0 || baked.cost.cpuSeconds < contender.line.cost.cpuSeconds)
                contender.line.cost = baked.cost;
            if (repeat > 0)
                continue;
            const ShownLight shown = ShownBy(contender.line.format, baked.bsp);
            contender.line.errors = MeasureErrors(truth, shown);
            if (settings.worstCount > 0 && contender.line.name == settings.worstOf)
                ReportWorst(map, truth, settings, contender, baked, shown, jobs, result);
            if (settings.listErrors)
                AddToErrorList(truth, settings, contender, shown, list);
        }
    if (settings.listErrors)
        result.errors = ErrorListJson(map.inputs.name, truth, list);
}

std::vector<Contender> Contenders(const BenchMap &map, ShaderLibrary &library, const BenchSettings &settings,
                                  const Game &game, const bspGridSHHeader_t &layout, const JobPool &jobs) {
    std::vector<Contender> all;
    const auto add = [&](std::string_view name, std::string_view text, BakedFormat format,
                         const LightOptions &options) {
        all.push_back({{std::string(name), std::string(text), format, {}, {}, {}},
                       [&map, &library, &jobs, options, format] { return Bake(map, options, format, library, jobs); }});
    };
    for (const BakeSetting &setting : settings.bakes) {
        const LightOptions options = LightOptionsFrom(settings.options + " " + setting.options, game);
        add(setting.name, setting.options, FormatOf(options), options);
    }
    if (!settings.measureBaselines)
        return all;
    all.push_back({{std::string(kPlainName), "one ray per light and point", BakedFormat::GridSH, {}, {}, {}},
                   [&map, &jobs, layout] { return BakeBaseline(map, layout, jobs); }});
    const LightOptions options = LightOptionsFrom(settings.options, game);
    add(kLegacyName, "no -sh", BakedFormat::LegacyGrid, options);
    add(kCubesName, "-ambientcubes", BakedFormat::AmbientCubes, options);
    return all;
}

/// Errors: the settings whose positions are listed are not measured, or of another kind.
void CheckListed(const std::vector<Contender> &contenders, const BenchSettings &settings) {
    const auto formatOf = [&](std::string_view list, const std::string &name) {
        for (const Contender &contender : contenders)
            if (contender.line.name == name)
                return contender.line.format;
        throw Error("{} of {}: expected the name of a setting that is measured", list, name);
    };
    if (settings.worstCount > 0) {
        const BakedFormat format = formatOf("worst positions", settings.worstOf);
        if (format == BakedFormat::AmbientCubes || format == BakedFormat::SparseGridSH)
            throw Error("worst positions of {}: expected a setting whose grid has cells of one size", settings.worstOf);
    }
    if (settings.listErrors) {
        const BakedFormat format = formatOf("errors", settings.errorsOf);
        if (format == BakedFormat::AmbientCubes || format == BakedFormat::LegacyGrid)
            throw Error("errors of {}: expected a setting with an SH grid", settings.errorsOf);
    }
}

} // namespace

std::vector<BakeSetting> DefaultBakes() {
    return {{std::string(kDefaultName), ""},
            {"fast", "-fast"},
            {"noskip", "-noskip"},
            {"gridscalesh 1", "-gridscalesh 1"},
            {"gridscalesh 1.5", "-gridscalesh 1.5"},
            {"gridscalesh 3", "-gridscalesh 3"},
            {"gridsh 64", "-gridsh 64 64 64"},
            {"fit", "-shfit"},
            {"64 64 64 fit", "-gridsh 64 64 64 -shfit"},
            {"adaptive 3", "-sherrortarget 3"},
            {"adaptive 1.5", "-sherrortarget 1.5"},
            {"adaptive 0.75", "-sherrortarget 0.75"},
            {"named", "-shlights"},
            {"named 64", "-shlights -gridsh 64 64 128"},
            {"named adaptive", "-shlights -shadaptive"}};
}

BenchFiles::BenchFiles(const GlobalOptions &global, const std::vector<std::string> &words,
                       const std::filesystem::path &program, const std::filesystem::path &bspPath,
                       const LightOptions &options, Log &log)
    : vfs_(OpenGameFiles(global, GameFolders(global, words, program), log)),
      library_(std::make_unique<ShaderLibrary>(vfs_, *global.game, options.shader, log)),
      map_(std::make_unique<BenchMap>(ReadBspFile(bspPath, global.Format(), log),
                                      ReadLightInputs(FilesOf(bspPath), log), options, *library_, log)) {}

bspGridSHHeader_t DefaultLayout(const BenchMap &map) {
    Log silent(Log::Nowhere());
    Entity world = map.stored.front();
    const GridLayout legacy = SetupGrid(map.bsp, world, silent);
    const GridLayout layout = SetupGridSH(map.bsp, legacy.size, map.options, silent);
    return {layout.mins, layout.size, layout.bounds, std::int32_t(layout.Count())};
}

BenchResult RunBench(const BenchMap &map, ShaderLibrary &library, const BenchSettings &given, const Game &game,
                     const JobPool &jobs, Log &progress) {
    BenchSettings settings = given;
    if (settings.bakes.empty())
        settings.bakes = DefaultBakes();
    if (settings.errorsOf.empty())
        settings.errorsOf = settings.bakes.front().name;
    BenchResult result;
    BenchReport &report = result.report;
    report.map = map.inputs.name;
    report.lights = map.lights.size();
    report.areaLights = std::size_t(std::count_if(map.lights.begin(), map.lights.end(),
                                                  [](const Light &light) { return light.type == LightType::Area; }));
    report.repeats = settings.repeats;
    report.threads = jobs.Threads();

    const bspGridSHHeader_t layout = DefaultLayout(map);
    auto contenders = Contenders(map, library, settings, game, layout, jobs);
    CheckListed(contenders, settings);
    progress.Print("reference\n");
    const Truth truth = CachedTruth(map, settings.truth, jobs, settings.cache, report.truthFromCache);
    report.positions = truth.points.size();
    report.truthNoise = truth.noise, report.truthRays = truth.rays, report.truthCpuSeconds = truth.cpuSeconds;
    report.floor = FloorError(truth);

    std::unique_ptr<EmbreeThroughput> raw;
    if (settings.measureRaw)
        raw = std::make_unique<EmbreeThroughput>(map, layout, settings.truth.seed);
    BakeInTurn(map, contenders, truth, raw.get(), settings, jobs, progress, result);
    for (Contender &contender : contenders)
        report.lines.push_back(std::move(contender.line));
    return result;
}

} // namespace q3::bench
