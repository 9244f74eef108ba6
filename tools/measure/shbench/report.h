// GPL-2.0-or-later. Results of a benchmark as text and JSON.
#pragma once

#include "tools/measure/shbench/bakes.h"
#include "tools/measure/shbench/causes.h"
#include "tools/measure/shbench/chart.h"

#include <string>
#include <vector>

namespace q3::bench {

/// One measured setting.
struct BenchLine {
    std::string name, options;
    BakedFormat format = BakedFormat::GridSH;
    BakeCost cost;
    ShownErrors errors;
    /// For each bake: rays per CPU second, divided by bare Embree's mean just before and after. Empty: not measured.
    std::vector<double> sharesOfRaw;
    /// Median of sharesOfRaw; 0 if empty.
    double ShareOfRaw() const;
};

/// Name of the family of a line: lines that differ in the size of the grid alone. "uniform" or "sparse", then the
/// options without those that set the size of cells or of the grid.
std::string FamilyOf(const BenchLine &line);

/// Everything measured on one map.
struct BenchReport {
    std::string map;
    std::size_t positions = 0, lights = 0, areaLights = 0;
    double truthNoise = 0, truthCpuSeconds = 0;
    std::uint64_t truthRays = 0;
    bool truthFromCache = false;
    double floor = 0; ///< displayed RMSE of the exact L2 projection
    /// Rays per CPU second of bare Embree, before the first bake and after each one. Empty: not measured.
    std::vector<double> rawRates;
    int repeats = 1, threads = 1;
    std::vector<BenchLine> lines;

    /// The line of that name, or null.
    const BenchLine *Line(std::string_view name) const;
};

/// Rows of equal column widths: the first column aligned left, the others right. The first row is the header.
std::string AlignedTable(const std::vector<std::vector<std::string>> &rows);

/// The report as a table with a head, and as JSON.
std::string TableText(const BenchReport &report);
std::string JsonText(const BenchReport &report);
/// CPU seconds, logarithmic, against displayed RMSE, with the floor. The legacy grid and ambient cubes are left out.
Chart ErrorChart(const BenchReport &report);
/// Grid error of SH grids against their megabytes, both logarithmic. Lines of one family are joined; the plain baker,
/// the legacy grid and ambient cubes are left out.
Chart SizeChart(const BenchReport &report);
/// The worst positions of a setting with their causes, then the shares of all causes. `errors` and `causes`: of all
/// positions.
std::string WorstText(const Truth &truth, const std::vector<WorstPosition> &worst,
                      const std::vector<PositionErrors> &errors, const std::vector<Cause> &causes,
                      std::string_view setting);

/// Names of the lines that others are compared with.
inline constexpr std::string_view kDefaultName = "default", kPlainName = "naive baseline", kLegacyName = "legacy grid",
                                  kCubesName = "ambient cubes";

} // namespace q3::bench
