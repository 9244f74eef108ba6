// GPL-2.0-or-later. How time grows with lights and with grid points.
#pragma once

#include "tools/measure/shbench/bakes.h"
#include "tools/measure/shbench/chart.h"

#include <string>
#include <vector>

namespace q3::bench {

/// One bake of a series.
struct ScalingStep {
    std::string series;
    double size = 0; ///< lights or points
    BakeCost cost;
};

/// A map whose shaders are not in any game.
struct LightHall {
    Bsp bsp;
    std::string shaderText; ///< of the lamps
};
/// Point lights, or ceiling lamps, which are two area lights each.
enum class HallLights { Points, Lamps };
/// A hall of 2048 x 2048 x 512 units with pillars, lit by `lights` lights of a constant total intensity at random
/// positions.
LightHall MakeLightHall(int lights, HallLights kind);

/// Least CPU time of `repeats` for 1, 10, ... up to `maxLights` point lights, and lamps.
std::vector<ScalingStep> ScaleLights(const LightOptions &options, const Game &game, const JobPool &jobs, int maxLights,
                                     int repeats, Log &progress);
/// The same for -gridscalesh 1, 1.5, 2, 3, 4.
std::vector<ScalingStep> ScaleCells(const BenchMap &map, ShaderLibrary &library, const LightOptions &options,
                                    const JobPool &jobs, int repeats, Log &progress);

/// The steps as a table, and as JSON. sizeName: heading and member of ScalingStep::size.
std::string ScalingTable(const std::vector<ScalingStep> &steps, const std::string &sizeName);
std::string ScalingJson(const std::vector<ScalingStep> &steps, const std::string &sizeName);
/// What a scaling chart shows.
enum class ScalingValue { CpuSeconds, Rays };
/// The value against size; both axes logarithmic, with a line of slope one.
Chart ScalingChart(const std::vector<ScalingStep> &steps, const std::string &sizeName, const std::string &title,
                   ScalingValue value);

} // namespace q3::bench
