// GPL-2.0-or-later. Bakes of a map that is set up: legacy grid, SH grid, ambient cubes.
#include "q3map2/light/grid_bakes.h"

#include "common/platform/platform.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/light/cubes/ambient_cubes.h"
#include "q3map2/light/grid/gridsh_error.h"
#include "q3map2/light/named/named_bake.h"
#include "q3map2/light/sparse/sparse_bake.h"

#include <algorithm>
#include <set>
#include <string>

namespace q3 {

namespace {

/// Factor of the number of rays at points of the sparse grid that the uniform one does not have: there the error of
/// interpolation is larger than noise.
constexpr float kSparseSamples = 0.5f;

void PrintDering(const DeringStats &changed, Log &log) {
    log.Count(changed.points, "points rid of negative lobes");
    log.Print("{:9.2f} levels: largest change of displayed light\n", changed.largestChange);
}

/// Bakes the sparse grid. from: inputs of the uniform grid. uniform: that grid, before deringing.
SparseGridSH BakeSparse(const GridInputs &from, const std::vector<Light> &lights, const WeakField *weak,
                        const LightGridSH &uniform, Log &log, GridStats &stats, SparseStats &sparse) {
    log.Section("TraceSparseGridSH");
    LightOptions options = from.options;
    options.shSamples *= kSparseSamples;
    const GridInputs in{from.space, from.scene, options, from.world, from.jobs, log, from.indirect, {}, from.units};
    const ProbeIntegrator integrator(in, lights);
    const LightAtPositions light(integrator, weak);
    const SparseGoal &goal = options.sparseGoal;
    const std::uint64_t raysBefore = stats.counts.rays;
    SparseGridSH grid = BakeSparseGrid(in, lights, light, uniform, goal, stats, sparse);
    log.Count(stats.counts.rays - raysBefore, "rays");
    PrintSparseStats(sparse, goal, log);
    if (options.shDering)
        PrintDering(sparse.dering, log);
    return grid;
}

bool IsStyled(const Light &light) {
    return light.style != 0;
}

} // namespace

std::vector<Light> LightsForSH(const LightSetup &setup, StyledLights styles, Log &log) {
    int culled = 0;
    auto lights =
        SetupEnvelopes(setup.lights, LightPass::GridSH, setup.options, setup.space, setup.skySeenFrom, culled);
    if (styles == StyledLights::Keep) {
        if (const auto high = std::erase_if(lights, [](const Light &light) { return light.style > kLastStyle; });
            high > 0)
            log.Warn("SH light of high styles",
                     "{} of styles above {} left out of the SH grid, which has no higher ones", Counted(high, "lights"),
                     kLastStyle);
        if (const auto styled = std::ranges::count_if(lights, IsStyled); styled > 0)
            log.Count(styled, "lights of other styles than 0, named wherever they reach");
    } else if (const auto styled = std::erase_if(lights, IsStyled); styled > 0) {
        log.Count(styled, "lights of other styles than 0 left out: they change while the game runs");
        if (lights.empty())
            log.Warn("SH light without lights",
                     "no light has style 0: the SH grid stores only light that never changes and stays dark");
    }
    log.Count(lights.size(), "lights");
    log.Count(culled, "lights culled");
    return lights;
}

namespace {

/// Warns of lights whose style found no slot at some points.
void WarnOfDroppedStyles(const std::vector<Light> &lights, const GridStats &stats, Log &log) {
    DroppedLightCounts dropped;
    for (const auto &[style, points] : stats.dropped) {
        std::set<std::string> names; // an area light is many lights of one name
        for (const Light &light : lights)
            if (light.style == style && names.insert(StyledLightName(light)).second)
                dropped.Add(StyledLightName(light), points);
        if (names.empty())
            dropped.Add(fmt::format("bounced light of style {}", style), points);
    }
    dropped.Warn("light", "grid points", log);
}

} // namespace

std::vector<bspGridPoint_t> LightLegacyGrid(const LightSetup &setup, const BouncedLight &bounced, const JobPool &jobs,
                                            Log &log, GridStats &stats) {
    log.Section("TraceGrid");
    int culled = 0;
    const auto lights =
        SetupEnvelopes(setup.lights, LightPass::LegacyGrid, setup.options, setup.space, setup.skySeenFrom, culled);
    log.Count(lights.size(), "lights");
    log.Count(culled, "lights culled");
    const GridInputs in{.space = setup.space,
                        .scene = setup.scene,
                        .options = setup.options,
                        .world = setup.world,
                        .jobs = jobs,
                        .log = log,
                        .indirect = bounced.steady.get(),
                        .styled = bounced.styled,
                        .units = setup.units};
    auto points = TraceGrid(in, setup.layout, lights, stats);
    stats.Print(log);
    WarnOfDroppedStyles(lights, stats, log);
    return points;
}

BakedGridSH BakeGridSH(const LightSetup &setup, const IndirectLight *indirect, const JobPool &jobs, Log &log,
                       GridStats &stats) {
    const LightOptions &options = setup.options;
    log.Section("TraceGridSH");
    const GridLayout layout = SetupGridSH(setup.bsp, setup.layout.size, options, log);
    const std::vector<Light> lights = LightsForSH(setup, StyledLights::LeaveOut, log);
    const GridInputs in{setup.space, setup.scene, options, setup.world, jobs, log, indirect, {}, setup.units};
    GridSHTracer tracer(in, layout, lights);
    BakedGridSH baked{tracer.TraceGridSH(stats), {}};
    if (setup.units && setup.units->IsPart())
        return baked;
    GridStats shown = stats; // prints the counts of points that -info finds in the file, not those of this pass
    const GridPointCounts counts = CountGridPoints(setup.bsp, baked.uniform);
    shown.open = std::int64_t(counts.open);
    shown.filled = std::int64_t(counts.filled);
    shown.moved = 0;
    shown.Print(log);
    SparseStats sparse;
    if (options.shAdaptive && !options.shLights)
        baked.sparse = BakeSparse(in, lights, tracer.Weak(), baked.uniform, log, stats, sparse);
    if (options.shDering) {
        const DeringStats changed = DeringGridSH(baked.uniform, options.shRadiance, jobs);
        if (options.sh)
            PrintDering(changed, log);
    }
    if (options.shError && options.sh)
        PrintGridSHError(MeasureGridSH(in, baked.uniform, lights), layout.size, setup.layout.size, log);
    if (options.shError && sparse.measured)
        PrintSparseGridError(*sparse.measured, log);
    return baked;
}

NamedGridSH BakeNamedGridSH(const LightSetup &setup, const IndirectLight *indirect, const JobPool &jobs, Log &log,
                            GridStats &stats) {
    const LightOptions &options = setup.options;
    log.Section("TraceNamedGridSH");
    const CpuTimer timer;
    // Adaptive cells begin at twice the edge: where lights are named, few need to be smaller.
    const float scale = options.shAdaptive ? 2.0f : 1.0f;
    Float3 size = CellOfGridSH(setup.layout.size, options);
    for (float &edge : size)
        edge *= scale;
    const GridLayout layout = LayoutGridSH(setup.bsp, size);
    log.Print("{} of {:g} {:g} {:g}\n", options.shAdaptive ? "First cells" : "Cells", layout.size[0], layout.size[1],
              layout.size[2]);
    const std::vector<Light> lights = LightsForSH(setup, StyledLights::Keep, log);
    const GridInputs in{setup.space, setup.scene, options, setup.world, jobs, log, indirect, {}, setup.units};
    NamedStats named;
    NamedGridSH grid = BakeNamedGrid(in, layout, lights, stats, named);
    PrintNamedStats(named, options.sparseGoal, log);
    for (const auto &[light, cells] : named.dropped)
        log.Warn("styled light without a name", "the SH grid leaves out {} in {}: too many lights with styles reach it",
                 light, Counted(cells, "cells"));
    if (options.shError) {
        std::vector<Light> steady = lights;
        std::erase_if(steady, IsStyled);
        PrintSparseGridError(ErrorOfNamedGrid(ExactReceivers(in, steady), grid), log);
    }
    log.Print("{:9.2f} CPU seconds\n", timer.Seconds());
    return grid;
}

std::optional<AmbientCubes> BakeAmbientCubes(const LightSetup &setup, const IndirectLight *indirect,
                                             const LightGridSH *gridSH, const JobPool &jobs, Log &log,
                                             GridStats &stats) {
    const LightOptions &options = setup.options;
    log.Section("TraceAmbientCubes");
    const CpuTimer timer;
    const LightGridSH *from = options.cubesFromSH ? gridSH : nullptr;
    const std::vector<Light> lights = from ? std::vector<Light>{} : LightsForSH(setup, StyledLights::LeaveOut, log);
    const GridInputs in{setup.space, setup.scene, options, setup.world, jobs, log, indirect, {}, setup.units};
    const LeafCubes leafs = SampleLeafs(in, lights, from, stats);
    auto cubes = StoreCubes(setup.space, leafs, options.cubeTolerance, jobs, log);
    log.Count(stats.points, "places sampled");
    log.Count(cubes ? cubes->samples.size() : 0, "ambient cubes");
    log.Count(stats.open, "leafs with ambient cubes");
    log.Count(stats.counts.rays, "rays");
    log.Print("{:9.2f} CPU seconds\n", timer.Seconds());
    return cubes;
}

} // namespace q3
