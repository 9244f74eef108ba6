// GPL-2.0-or-later. Results of a benchmark as text and JSON.
#include "tools/measure/shbench/report.h"

#include "common/text/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <sstream>

namespace q3::bench {

namespace {

constexpr std::string_view kOthers = "others"; ///< in size charts: the families of one line

double PerSecond(const BakeCost &cost) {
    return cost.cpuSeconds > 0 ? double(cost.rays) / cost.cpuSeconds : 0;
}

/// a / b, or a dash if b is 0.
std::string Ratio(double a, double b, std::string_view format = "{:.2f}") {
    return b > 0 ? fmt::format(fmt::runtime(format), a / b) : "-";
}

std::vector<std::string> Cells(const BenchReport &report, const BenchLine &line) {
    const BenchLine *defaultLine = report.Line(kDefaultName), *plainLine = report.Line(kPlainName);
    const BakeCost &cost = line.cost;
    return {line.name,
            fmt::format("{:.2f}", cost.cpuSeconds),
            fmt::format("{:.2f}", cost.setUpSeconds),
            Ratio(cost.cpuSeconds, defaultLine ? defaultLine->cost.cpuSeconds : 0),
            fmt::format("{:.3f}", double(cost.rays) / 1e6),
            fmt::format("{:.2f}", PerSecond(cost) / 1e6),
            line.ShareOfRaw() > 0 ? fmt::format("{:.3f}", line.ShareOfRaw()) : "-",
            fmt::format("{}", cost.points),
            fmt::format("{:.2f}", double(cost.bytes) / 1e6),
            fmt::format("{:.3f}", line.errors.rmse),
            fmt::format("{:.2f}", line.errors.percentile95),
            fmt::format("{:.2f}", line.errors.percentile99),
            Ratio(line.errors.rmse, report.floor, "{:.3f}"),
            fmt::format("{:.3f}", line.errors.grid),
            Ratio(line.errors.grid, plainLine ? plainLine->errors.grid : 0, "{:.3f}"),
            fmt::format("{:.2f}", 100 * line.errors.leak),
            fmt::format("{:.4f}", line.errors.relative)};
}

/// Whether charts of SH grids have the line.
bool IsSHGrid(const BenchLine &line) {
    return line.format == BakedFormat::GridSH || line.format == BakedFormat::SparseGridSH ||
           line.format == BakedFormat::NamedGridSH;
}

/// Options that set the size of cells or of the grid.
bool SetsSize(std::string_view word) {
    constexpr std::array<std::string_view, 5> kNames = {"-gridsh", "-gridscalesh", "-shadaptive", "-sherrortarget",
                                                        "-shbudget"};
    return std::ranges::any_of(kNames, [&](std::string_view name) { return EqualNoCase(name, word); });
}

/// Colors of the families of grids in size charts: the same on every map, whichever of them it has.
int FamilyColor(std::string_view family) {
    constexpr std::array<std::string_view, 4> kFamilies = {"uniform", "uniform -shfit", "sparse", kOthers};
    return int(std::ranges::find(kFamilies, family) - kFamilies.begin());
}

nlohmann::json LineJson(const BenchReport &report, const BenchLine &line) {
    const BenchLine *defaultLine = report.Line(kDefaultName), *plainLine = report.Line(kPlainName);
    const auto ratio = [](double a, double b) { return b > 0 ? nlohmann::json(a / b) : nlohmann::json(); };
    const BakeCost &cost = line.cost;
    return {{"name", line.name},
            {"options", line.options},
            {"family", IsSHGrid(line) && line.name != kPlainName ? nlohmann::json(FamilyOf(line)) : nlohmann::json()},
            {"cpuSeconds", cost.cpuSeconds},
            {"setUpCpuSeconds", cost.setUpSeconds},
            {"timeToDefault", ratio(cost.cpuSeconds, defaultLine ? defaultLine->cost.cpuSeconds : 0)},
            {"rays", cost.rays},
            {"raysPerCpuSecond", PerSecond(cost)},
            {"raysPerPassCpuSecond", ratio(double(cost.rays), cost.cpuSeconds - cost.setUpSeconds)},
            {"shareOfRaw", line.ShareOfRaw() > 0 ? nlohmann::json(line.ShareOfRaw()) : nlohmann::json()},
            {"sharesOfRaw", line.sharesOfRaw},
            {"points", cost.points},
            {"litPoints", cost.litPoints},
            {"lumpBytes", cost.bytes},
            {"displayedRmse", line.errors.rmse},
            {"displayed95", line.errors.percentile95},
            {"displayed99", line.errors.percentile99},
            {"timesFloor", ratio(line.errors.rmse, report.floor)},
            {"gridError", line.errors.grid},
            {"timesPlain", ratio(line.errors.grid, plainLine ? plainLine->errors.grid : 0)},
            {"leak", line.errors.leak},
            {"relativeRmse", line.errors.relative}};
}

} // namespace

double BenchLine::ShareOfRaw() const {
    if (sharesOfRaw.empty())
        return 0;
    std::vector<double> sorted = sharesOfRaw;
    std::sort(sorted.begin(), sorted.end());
    return (sorted[(sorted.size() - 1) / 2] + sorted[sorted.size() / 2]) / 2;
}

std::string FamilyOf(const BenchLine &line) {
    std::string family = line.format == BakedFormat::SparseGridSH  ? "sparse"
                         : line.format == BakedFormat::NamedGridSH ? "named"
                                                                   : "uniform";
    std::istringstream words(line.options);
    bool skips = false; // values of an option that sets the size
    for (std::string word; words >> word;) {
        if (word.starts_with('-'))
            skips = SetsSize(word);
        if (!skips)
            family += " " + word;
    }
    return family;
}

const BenchLine *BenchReport::Line(std::string_view name) const {
    const auto found = std::find_if(lines.begin(), lines.end(), [&](const BenchLine &l) { return l.name == name; });
    return found == lines.end() ? nullptr : &*found;
}

std::string AlignedTable(const std::vector<std::vector<std::string>> &rows) {
    std::vector<std::size_t> widths;
    for (const auto &row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) {
            widths.resize(std::max(widths.size(), i + 1));
            widths[i] = std::max(widths[i], row[i].size());
        }
    std::string text;
    for (const auto &row : rows) {
        for (std::size_t i = 0; i < row.size(); ++i)
            text += i == 0 ? fmt::format("{:<{}}", row[i], widths[i]) : fmt::format("  {:>{}}", row[i], widths[i]);
        text += '\n';
    }
    return text;
}

std::string TableText(const BenchReport &report) {
    std::string text = fmt::format("{}: {} positions, {} lights, {} of them area lights\n", report.map,
                                   report.positions, report.lights, report.areaLights);
    text += fmt::format("reference: {:.1f} M rays, {:.1f} CPU s{}, standard error {:.4f} levels\n",
                        double(report.truthRays) / 1e6, report.truthCpuSeconds,
                        report.truthFromCache ? " (from the cache)" : "", report.truthNoise);
    text += fmt::format("L2 truncation limit: {:.3f} levels, displayed RMSE of the exact L2 projection\n", report.floor);
    if (const auto [least, most] = std::minmax_element(report.rawRates.begin(), report.rawRates.end());
        !report.rawRates.empty())
        text += fmt::format("raw: {:.2f} to {:.2f} M rays per CPU s, measured {} times\n", *least / 1e6, *most / 1e6,
                            report.rawRates.size());
    text += fmt::format("bakes: {} threads, least CPU time of {}\n\n", report.threads, report.repeats);
    std::vector<std::vector<std::string>> rows = {{"setting", "CPU s", "set-up", "x default", "M rays", "M rays/s",
                                                   "of Embree", "points", "MB", "RMSE", "95 %", "99 %", "x limit",
                                                   "grid error", "x naive", "leak %", "rel RMSE"}};
    for (const BenchLine &line : report.lines)
        rows.push_back(Cells(report, line));
    return text + AlignedTable(rows);
}

std::string JsonText(const BenchReport &report) {
    nlohmann::json lines = nlohmann::json::array();
    for (const BenchLine &line : report.lines)
        lines.push_back(LineJson(report, line));
    const nlohmann::json all = {{"map", report.map},
                                {"positions", report.positions},
                                {"lights", report.lights},
                                {"areaLights", report.areaLights},
                                {"truth",
                                 {{"standardError", report.truthNoise},
                                  {"rays", report.truthRays},
                                  {"cpuSeconds", report.truthCpuSeconds},
                                  {"fromCache", report.truthFromCache}}},
                                {"floor", report.floor},
                                {"rawRaysPerCpuSecond", report.rawRates},
                                {"threads", report.threads},
                                {"repeats", report.repeats},
                                {"settings", lines}};
    return all.dump(2) + "\n";
}

Chart ErrorChart(const BenchReport &report) {
    Chart chart;
    chart.title = fmt::format("{}: error of the SH grid against time", report.map);
    chart.subtitle = fmt::format("{} positions, 26 normals; {} lights, {} of them area lights", report.positions,
                                 report.lights, report.areaLights);
    chart.x = {"CPU seconds (logarithmic)", AxisScale::Logarithmic};
    chart.y = {"displayed RMSE, 8-bit levels", AxisScale::Linear};
    ChartSeries settings{"settings", {}, false}, plain{"naive baseline", {}, false};
    for (const BenchLine &line : report.lines)
        if (IsSHGrid(line))
            (line.name == kPlainName ? plain : settings)
                .points.push_back({line.cost.cpuSeconds, line.errors.rmse, line.name});
    chart.series = {settings, plain};
    chart.level = report.floor;
    chart.levelLabel = fmt::format("L2 truncation limit {:.2f}", report.floor);
    return chart;
}

Chart SizeChart(const BenchReport &report) {
    Chart chart;
    chart.title = fmt::format("{}: error of the SH grid against its size", report.map);
    chart.subtitle = fmt::format("{} positions, 26 normals; L2 truncation limit {:.2f}", report.positions, report.floor);
    chart.x = {"megabytes (logarithmic)", AxisScale::Logarithmic};
    chart.y = {"grid error, 8-bit levels (logarithmic)", AxisScale::Logarithmic};
    std::vector<ChartSeries> families;
    for (const BenchLine &line : report.lines) {
        // The L2 projection is no measure of grids that name lights.
        if (!IsSHGrid(line) || line.name == kPlainName || line.format == BakedFormat::NamedGridSH)
            continue;
        const std::string name = FamilyOf(line);
        auto family = std::ranges::find(families, name, &ChartSeries::name);
        if (family == families.end())
            family = families.insert(family, {.name = name, .points = {}, .joined = true, .color = FamilyColor(name)});
        family->points.push_back({double(line.cost.bytes) / 1e6, line.errors.grid, line.name});
    }
    ChartSeries others{.name = std::string(kOthers), .points = {}, .joined = false, .color = FamilyColor(kOthers)};
    for (ChartSeries &family : families) {
        // A family with options of its own, such as "uniform -shfit", but only one line.
        if (family.points.size() == 1 && family.name.find(' ') != std::string::npos) {
            others.points.push_back(family.points.front());
            continue;
        }
        std::ranges::stable_sort(family.points, {}, &ChartPoint::x);
        chart.series.push_back(std::move(family));
    }
    if (!others.points.empty())
        chart.series.push_back(std::move(others));
    return chart;
}

std::string WorstText(const Truth &truth, const std::vector<WorstPosition> &worst,
                      const std::vector<PositionErrors> &errors, const std::vector<Cause> &causes,
                      std::string_view setting) {
    const auto vector = [](const Vec3f &v, double scale, int digits) {
        return fmt::format("{:.{}f} {:.{}f} {:.{}f}", double(v.x) * scale, digits, double(v.y) * scale, digits,
                           double(v.z) * scale, digits);
    };
    std::vector<std::vector<std::string>> rows = {{"no.", "position", "RMS", "limit", "grid", "largest", "normal",
                                                   "reference", "shown", "projection (levels)", "cause"}};
    for (const WorstPosition &place : worst) {
        const TruthPoint &point = truth.points[place.point];
        const PositionErrors &error = errors[place.point];
        rows.push_back({std::to_string(rows.size()), vector(point.position, 1, 0), fmt::format("{:.1f}", error.shown),
                        fmt::format("{:.1f}", error.floor), fmt::format("{:.1f}", error.grid),
                        fmt::format("{:.1f}", place.error), vector(Vec3f(Normals()[place.normal]), 1, 2),
                        vector(point.light[place.normal], 255, 1), vector(place.shown, 255, 1),
                        vector(ProjectedLight(point)[place.normal], 255, 1), std::string(NameOf(causes[place.point]))});
    }
    const auto shares = SharesByCause(causes, errors);
    std::vector<std::vector<std::string>> sums = {{"cause", "positions %", "squared grid error %"}};
    for (std::size_t i = 0; i < kCauses; ++i)
        sums.push_back({std::string(NameOf(Cause(i))), fmt::format("{:.1f}", 100 * shares[i].positions),
                        fmt::format("{:.1f}", 100 * shares[i].error)});
    return fmt::format("\nworst positions of {}\n{}\ncauses over all positions\n{}", setting, AlignedTable(rows),
                       AlignedTable(sums));
}

} // namespace q3::bench
