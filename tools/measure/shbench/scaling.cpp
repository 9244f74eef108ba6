// GPL-2.0-or-later. How time grows with lights and with grid points.
#include "tools/measure/shbench/scaling.h"

#include "common/error.h"
#include "common/files/files.h"
#include "tests/support/scene/scene_builder.h"
#include "tools/measure/shbench/report.h"
#include "tools/measure/shbench/truth_lights.h"

#include <glib.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <memory>

namespace q3::bench {

namespace {

constexpr float kHallSize = 2048, kHallHeight = 512, kPillarWidth = 64; ///< game units
constexpr int kPillars = 4;                                             ///< along x and along y: kPillars^2 in all
constexpr double kTotalIntensity = 8000;                                ///< key "light" of all point lights together
constexpr double kTotalLampValue = 2'000'000;                           ///< q3map_surfacelight of all lamps together
constexpr float kLampSize = 16;                                         ///< side of its square, game units
constexpr std::string_view kLampShader = "textures/shbench/lamp";

/// A temporary folder, removed at the end.
class TemporaryFolder {
  public:
    TemporaryFolder() {
        GError *error = nullptr;
        const std::unique_ptr<char, void (*)(void *)> path(g_dir_make_tmp("shbench-XXXXXX", &error), g_free);
        if (!path) {
            const std::string reason = error->message;
            g_error_free(error);
            throw Error("cannot make a temporary folder: {}", reason);
        }
        path_ = path.get();
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder &) = delete;
    TemporaryFolder &operator=(const TemporaryFolder &) = delete;
    const std::filesystem::path &Path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// Makes the folder a game folder with one script.
void WriteScript(const std::filesystem::path &folder, const std::string &script) {
    std::filesystem::create_directories(folder / "scripts");
    ReplaceTextFile(folder / "scripts/shaderlist.txt", "shbench\n");
    ReplaceTextFile(folder / "scripts/shbench.shader", script);
}

/// Cost of the bake that took the least CPU time.
BakeCost LeastCost(const BenchMap &map, ShaderLibrary &library, const LightOptions &options, const JobPool &jobs,
                   int repeats) {
    BakeCost least;
    for (int repeat = 0; repeat < repeats; ++repeat) {
        const BakeCost cost = Bake(map, options, FormatOf(options), library, jobs).cost;
        if (repeat == 0 || cost.cpuSeconds < least.cpuSeconds)
            least = cost;
    }
    return least;
}

double ValueOf(const ScalingStep &step, ScalingValue value) {
    return value == ScalingValue::Rays ? double(step.cost.rays) : step.cost.cpuSeconds;
}

} // namespace

LightHall MakeLightHall(int lights, HallLights kind) {
    SceneBuilder builder;
    const SceneShader wall{"textures/shbench/wall"};
    builder.SetInterior({0, 0, 0}, {kHallSize, kHallSize, kHallHeight}, wall);
    for (int x = 0; x < kPillars; ++x)
        for (int y = 0; y < kPillars; ++y) {
            const Vec3f at{(float(x) + 0.5f) * kHallSize / kPillars, (float(y) + 0.5f) * kHallSize / kPillars, 0};
            const Vec3f half{kPillarWidth / 2, kPillarWidth / 2, 0};
            builder.AddBox(at - half, at + half + Vec3f{0, 0, kHallHeight}, wall);
        }
    constexpr std::uint64_t kSeed = 12345;
    Random random(kSeed);
    const auto within = [&](float low, float high) { return low + float(Unit(random)) * (high - low); };
    const SceneShader lamp{std::string(kLampShader)};
    for (int i = 0; i < lights; ++i) {
        // x in a gap between the rows of pillars: 0.2 or 0.8 of the way from one row's left edge to the next.
        const float x =
            (float(int(Unit(random) * kPillars)) + (Unit(random) < 0.5 ? 0.2f : 0.8f)) * kHallSize / kPillars;
        // Clear of walls, floor and ceiling.
        const Vec3f at{x + within(-64, 64), within(32, kHallSize - 32), within(64, kHallHeight - 16)};
        if (kind == HallLights::Lamps) {
            const float x1 = at.x + kLampSize, y1 = at.y + kLampSize, z = at.z;
            builder.AddQuad({{{at.x, at.y, z}, {x1, at.y, z}, {x1, y1, z}, {at.x, y1, z}}}, lamp);
        } else
            builder.AddEntity({{{"classname", "light"},
                                {"origin", fmt::format("{} {} {}", at.x, at.y, at.z)},
                                {"light", fmt::format("{}", kTotalIntensity / lights)}}});
    }
    builder.SetWorldKey("_keepLights", "1");
    LightHall hall;
    hall.bsp = builder.Build();
    hall.shaderText = fmt::format("{}\n{{\n\tsurfaceparm nomarks\n\tq3map_surfacelight {}\n\tq3map_lightRGB 1 1 1\n"
                                  "\tq3map_backsplash 0 0\n}}\n",
                                  kLampShader, kTotalLampValue / lights);
    return hall;
}

std::vector<ScalingStep> ScaleLights(const LightOptions &options, const Game &game, const JobPool &jobs, int maxLights,
                                     int repeats, Log &progress) {
    std::vector<ScalingStep> steps;
    for (const HallLights kind : {HallLights::Points, HallLights::Lamps})
        for (int lights = 1; lights <= maxLights; lights *= 10) {
            LightHall hall = MakeLightHall(lights, kind);
            const bool lamps = kind == HallLights::Lamps;
            const TemporaryFolder folder;
            WriteScript(folder.Path(), hall.shaderText);
            Log silent(Log::Nowhere());
            VirtualFileSystem vfs(silent);
            vfs.Mount(folder.Path(), game.archiveExtension);
            ShaderLibrary library(vfs, game, options.shader, silent);
            const BenchMap map(std::move(hall.bsp), {"hall", {}, {}}, options, library, silent);
            progress.Print("{} {}\n", lights, lamps ? "lamps" : "point lights");
            steps.push_back({lamps ? "area lights" : "point lights", double(map.lights.size()),
                             LeastCost(map, library, options, jobs, repeats)});
        }
    return steps;
}

std::vector<ScalingStep> ScaleCells(const BenchMap &map, ShaderLibrary &library, const LightOptions &options,
                                    const JobPool &jobs, int repeats, Log &progress) {
    std::vector<ScalingStep> steps;
    for (const float scale : {1.0f, 1.5f, 2.0f, 3.0f, 4.0f}) {
        progress.Print("-gridscalesh {}\n", scale);
        LightOptions scaled = options;
        scaled.gridSizeSH.reset();
        scaled.gridScaleSH = scale;
        const BakeCost cost = LeastCost(map, library, scaled, jobs, repeats);
        steps.push_back({map.inputs.name, double(cost.points), cost});
    }
    return steps;
}

std::string ScalingTable(const std::vector<ScalingStep> &steps, const std::string &sizeName) {
    std::vector<std::vector<std::string>> rows = {
        {"series", sizeName, "CPU s", "set-up", "M rays", "lit points", "us per lit point"}};
    for (const ScalingStep &step : steps) {
        const double lit = double(std::max<std::int64_t>(1, step.cost.litPoints));
        rows.push_back({step.series, fmt::format("{:.0f}", step.size), fmt::format("{:.3f}", step.cost.cpuSeconds),
                        fmt::format("{:.3f}", step.cost.setUpSeconds),
                        fmt::format("{:.3f}", double(step.cost.rays) / 1e6), fmt::format("{}", step.cost.litPoints),
                        fmt::format("{:.2f}", 1e6 * step.cost.cpuSeconds / lit)});
    }
    return AlignedTable(rows);
}

std::string ScalingJson(const std::vector<ScalingStep> &steps, const std::string &sizeName) {
    nlohmann::json all = nlohmann::json::array();
    for (const ScalingStep &step : steps)
        all.push_back({{"series", step.series},
                       {sizeName, step.size},
                       {"cpuSeconds", step.cost.cpuSeconds},
                       {"setUpCpuSeconds", step.cost.setUpSeconds},
                       {"rays", step.cost.rays},
                       {"points", step.cost.points},
                       {"litPoints", step.cost.litPoints}});
    return all.dump(2) + "\n";
}

Chart ScalingChart(const std::vector<ScalingStep> &steps, const std::string &sizeName, const std::string &title,
                   ScalingValue value) {
    Chart chart;
    chart.title = title;
    chart.x = {sizeName, AxisScale::Logarithmic};
    chart.y = {value == ScalingValue::Rays ? "rays" : "CPU seconds", AxisScale::Logarithmic};
    for (const ScalingStep &step : steps) {
        if (chart.series.empty() || chart.series.back().name != step.series)
            chart.series.push_back({.name = step.series, .points = {}, .joined = true});
        chart.series.back().points.push_back({step.size, ValueOf(step, value), {}});
    }
    // A line of slope 1 through the middle point of the first series.
    if (!chart.series.empty()) {
        const auto &points = chart.series.front().points;
        const ChartPoint &middle = points[points.size() / 2];
        chart.slopeOne = {middle.x, middle.y, "proportional growth"};
    }
    return chart;
}

} // namespace q3::bench
