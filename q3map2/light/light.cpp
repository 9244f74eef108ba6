// GPL-2.0-or-later. The light stage.
#include "q3map2/light/light.h"

#include "common/cpu_time.h"
#include "common/error.h"
#include "q3map2/bspfile/foreign_keys.h"
#include "q3map2/bspfile/grid_shares.h"
#include "q3map2/bspfile/light_curve_keys.h"
#include "q3map2/bspfile/light_style_keys.h"
#include "q3map2/light/cubes/ambient_cubes.h"
#include "q3map2/light/grid/gridsh_dering.h"
#include "q3map2/light/grid/gridsh_error.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sources/hidden_lights.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/sources/light_envelope.h"
#include "q3map2/light/sparse/sparse_bake.h"
#include "q3map2/shader/shader_table.h"

#include <algorithm>

namespace q3 {

namespace {

bool IsLight(const Entity &entity) {
    return StartsWithNoCase(entity.ClassName(), "light");
}

struct NumberedEntities {
    std::vector<Entity> entities;
    std::vector<std::size_t> numbers; ///< by entity: its number in the .bsp or .map that it is from
};

/// The entities of the .bsp, with the lights of the .map source if there is one, since compilers strip lights from the
/// .bsp. Without a .map, or with _keepLights, the lights are those in the .bsp.
NumberedEntities EntitiesWithLights(const std::vector<Entity> &entities, const LightInputs &inputs, Log &log) {
    const bool kept = keys::kKeepLights.Flag(entities.front());
    WarnOfBadKeys(entities.front(), 0, keys::kWorldLightKeys, log);
    WarnOfBadKeys(entities.front(), 0, keys::kStyleWorldKeys, log);
    WarnOfBadKeys(entities.front(), 0, keys::kMacroKeys, log);
    WarnOfForeignKeys(entities.front(), 0, KeyOwner::World, log);
    const std::vector<Entity> &sources = inputs.mapEntities && !kept ? *inputs.mapEntities : entities;
    for (std::size_t i = 0; i < sources.size(); ++i)
        if (IsLight(sources[i])) {
            WarnOfBadLightKeys(sources[i], i, log);
            WarnOfForeignKeys(sources[i], i, KeyOwner::Light, log);
        }
    const bool replaced = inputs.mapEntities && !kept;
    NumberedEntities result;
    const auto take = [&](const std::vector<Entity> &from, const auto &wanted) {
        for (std::size_t i = 0; i < from.size(); ++i)
            if (wanted(from[i]))
                result.entities.push_back(from[i]), result.numbers.push_back(i);
    };
    take(entities, [&](const Entity &entity) { return !replaced || !IsLight(entity); });
    if (replaced)
        take(sources, IsLight);
    if (std::none_of(result.entities.begin(), result.entities.end(), IsLight))
        log.Warn("no light entities", "{}: no light entities, {}; surface, sun and sky lights still count", inputs.name,
                 inputs.mapEntities ? "neither in the .map nor in the .bsp" : "there is no .map beside the .bsp");
    return result;
}

void CountLights(const std::vector<Light> &lights, const SurfaceLightCounts &counts, Log &log) {
    const auto of = [&](LightType type) {
        return std::count_if(lights.begin(), lights.end(), [&](const Light &light) { return light.type == type; });
    };
    log.Count(of(LightType::Point), "point lights");
    log.Count(of(LightType::Spot), "spotlights");
    log.Count(counts.areaLights, "diffuse (area) lights");
    log.Count(of(LightType::Sun), "sun/sky lights");
}

/// Lights prepared for SH grid and ambient cubes. Lights of styles other than 0 are left out: the formats cannot hold
/// them.
std::vector<Light> LightsForSH(const LightSetup &setup, Log &log) {
    int culled = 0;
    auto lights =
        SetupEnvelopes(setup.lights, LightPass::GridSH, setup.options, setup.space, setup.skySeenFrom, culled);
    if (const auto styled = std::erase_if(lights, [](const Light &light) { return light.style != 0; }); styled > 0)
        log.Count((long long)(styled), "lights of other styles than 0 left out: they change while the game runs");
    log.Count((long long)(lights.size()), "lights");
    log.Count(culled, "lights culled");
    return lights;
}

} // namespace

std::vector<bool> OpaqueBrushes(const Bsp &bsp, ShaderLibrary &library) {
    std::vector<bool> translucent(bsp.shaders.size());
    for (std::size_t i = 0; i < bsp.shaders.size(); ++i)
        translucent[i] = (library.Get(FieldName(bsp.shaders[i].shader)).compileFlags & C_TRANSLUCENT) != 0;
    std::vector<bool> opaque(bsp.brushes.size());
    const bspModel_t &world = bsp.models.front();
    for (int i = 0; i < world.numBSPBrushes; ++i) {
        const auto number = std::size_t(world.firstBSPBrush + i);
        const bspBrush_t &brush = bsp.brushes[number];
        bool any = false;
        for (int s = 0; s < brush.numSides && !any; ++s)
            any = translucent[std::size_t(bsp.brushSides[std::size_t(brush.firstSide + s)].shaderNum)];
        opaque[number] = !any;
    }
    return opaque;
}

std::vector<Light> CreateLights(const BspSpace &space, const std::vector<Entity> &entities, SurfaceTable &table,
                                const LightOptions &options, const WorldLight &world, ShaderLibrary &library,
                                Log &log) {
    std::vector<Light> lights = EntityLights(entities, options, log);
    SurfaceLightCounts counts;
    auto ofSurfaces = SurfaceLights(space, table, options, world, library, counts, log);
    std::move(ofSurfaces.begin(), ofSurfaces.end(), std::back_inserter(lights));
    CountLights(lights, counts, log);
    // Lights are traced in reverse order of creation, as in the established program: -cheapgrid depends on it.
    std::reverse(lights.begin(), lights.end());
    return lights;
}

namespace {

GridLayout SetupGridLogged(const Bsp &bsp, Entity &world, Log &log) {
    log.Section("SetupGrid");
    return SetupGrid(bsp, world, log);
}

LightOptions WithWorld(LightOptions options, const WorldLight &world) {
    options.tone.maxLight = world.maxLight;
    return options;
}

SurfaceDefaults WithAmbient(SurfaceDefaults defaults, const WorldLight &world) {
    defaults.ambient = world.ambient;
    if (defaults.macroTexture.empty())
        defaults.macroTexture = WithoutExtension(world.macroTexture);
    return defaults;
}

/// Light styles in shaders of surfaces.
std::set<int> StylesOfShaders(const SurfaceTable &table) {
    std::set<int> styles;
    for (const SurfaceEntry &entry : table) {
        styles.insert(entry.shader->lightStyle);
        for (const SunDirective &sun : entry.shader->suns)
            styles.insert(sun.style);
    }
    return styles;
}

/// Assigns style numbers to lights that need one, and sets their keys.
LightStyles NumberStyles(const LightSetup &setup, std::vector<Entity> &entities, Log &log) {
    if (setup.options.noStyles)
        return {};
    std::vector<Entity> lights;
    std::copy_if(entities.begin(), entities.end(), std::back_inserter(lights), IsLight);
    const bool switchable = setup.options.switchable || keys::kSwitchable.Flag(entities.front());
    LightStyles styles(lights, entities.front(), switchable, StylesOfShaders(setup.table), log);
    for (Entity &entity : entities)
        if (IsLight(entity))
            styles.Set(entity);
    return styles;
}

std::vector<Light> CreateLightsLogged(LightSetup &setup, const LightInputs &inputs, ShaderLibrary &library, Log &log) {
    auto [entities, numbers] = EntitiesWithLights(setup.stored, inputs, log);
    log.Section("CreateLights");
    ApplyTexLights(inputs.texLights, setup.table, log);
    try {
        setup.styles = NumberStyles(setup, entities, log);
        auto lights = CreateLights(setup.space, entities, setup.table, setup.options, setup.world, library, log);
        for (Light &light : lights)
            if (light.entity >= 0)
                light.entity = int(numbers[std::size_t(light.entity)]);
        return lights;
    } catch (const Error &error) {
        throw Error("{}: {}", inputs.name, error.what());
    }
}

/// Legacy rays ignore surfaces nearer than this: half the longest side of a cell.
float IgnoreRadius(const GridLayout &layout) {
    return 0.5f * std::max({layout.size[0], layout.size[1], layout.size[2]});
}

} // namespace

LightSetup::LightSetup(const Bsp &map, const LightInputs &inputs, const LightOptions &given,
                       const SurfaceDefaults &defaults, ShaderLibrary &library, Log &log)
    : bsp(map), stored(StoredEntities(map.entities, inputs.name)), layout(SetupGridLogged(map, stored.front(), log)),
      world(ReadWorldLight(stored.front(), given)), options(WithWorld(given, world)),
      table(MakeSurfaceTable(map, stored, inputs.surfaceFile, inputs.name + ".srf", library, log,
                             WithAmbient(defaults, world))),
      space(map, OpaqueBrushes(map, library)), lights(CreateLightsLogged(*this, inputs, library, log)),
      props(LoadStaticProps(
          stored, inputs.vfs, int(map.drawSurfaces.size()),
          [&inputs](std::string_view model) { return inputs.texLights.TextureShadow(model); }, options, library, log)),
      scene(map, table, options, IgnoreRadius(layout), props.shadows), skySeenFrom(SkySeenFrom(space, table)) {
    props.shadows = {}; // the scene has a copy
    WarnOfHiddenLights(lights, space, options.noTrace ? nullptr : &scene, log);
    log.Count((long long)(scene.TriangleCount()), "triangles that rays can meet");
}

std::vector<bspGridPoint_t> LightLegacyGrid(const LightSetup &setup, const IndirectLight *indirect, const JobPool &jobs,
                                            Log &log, GridStats &stats) {
    log.Section("TraceGrid");
    int culled = 0;
    const auto lights =
        SetupEnvelopes(setup.lights, LightPass::LegacyGrid, setup.options, setup.space, setup.skySeenFrom, culled);
    log.Count((long long)(lights.size()), "lights");
    log.Count(culled, "lights culled");
    const GridInputs in{setup.space, setup.scene, setup.options, setup.world, jobs, log, indirect};
    auto points = TraceGrid(in, setup.layout, lights, stats);
    stats.Print(log);
    return points;
}

namespace {

/// Factor of the number of rays at points of the sparse grid that the uniform one does not have: there the error of
/// interpolation is larger than noise.
constexpr float kSparseSamples = 0.5f;

void PrintDering(const DeringStats &changed, Log &log) {
    log.Count(changed.points, "points rid of negative lobes");
    log.Print("{:9.2f} of 255 is the largest change of displayed light\n", changed.largestChange);
}

/// Bakes the sparse grid. uniform: before deringing.
SparseGridSH BakeSparse(const GridInputs &all, const std::vector<Light> &lights, const WeakField *weak,
                        const LightGridSH &uniform, Log &log, GridStats &stats, SparseStats &sparse) {
    log.Section("TraceSparseGridSH");
    LightOptions options = all.options;
    options.shSamples *= kSparseSamples;
    const GridInputs in{all.space, all.scene, options, all.world, all.jobs, log, all.indirect};
    const ProbeIntegrator integrator(in, lights);
    const SmoothLight light(integrator, weak);
    const SparseGoal &goal = options.sparseGoal;
    const std::uint64_t raysBefore = stats.counts.rays;
    SparseGridSH grid = BakeSparseGrid(in, lights, light, uniform, goal, stats, sparse);
    log.Count((long long)(stats.counts.rays - raysBefore), "rays");
    PrintSparseStats(sparse, goal, log);
    if (options.shDering)
        PrintDering(sparse.dering, log);
    return grid;
}

} // namespace

BakedGridSH BakeGridSH(const LightSetup &setup, const IndirectLight *indirect, const JobPool &jobs, Log &log,
                       GridStats &stats) {
    const LightOptions &options = setup.options;
    log.Section("TraceGridSH");
    const GridLayout layout = SetupGridSH(setup.bsp, setup.layout.size, options, log);
    const std::vector<Light> lights = LightsForSH(setup, log);
    const GridInputs in{setup.space, setup.scene, options, setup.world, jobs, log, indirect};
    GridSHTracer tracer(in, layout, lights);
    BakedGridSH baked{tracer.TraceGridSH(stats), {}};
    GridStats shown = stats; // prints the counts of points that -info finds in the file, not those of this pass
    const GridShares shares = CountGridShares(setup.bsp, baked.uniform);
    shown.open = std::int64_t(shares.open);
    shown.filled = std::int64_t(shares.filled);
    shown.moved = 0;
    shown.Print(log);
    SparseStats sparse;
    if (options.shAdaptive)
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

std::optional<AmbientCubes> BakeAmbientCubes(const LightSetup &setup, const IndirectLight *indirect,
                                             const LightGridSH *gridSH, const JobPool &jobs, Log &log,
                                             GridStats &stats) {
    const LightOptions &options = setup.options;
    log.Section("TraceAmbientCubes");
    const CpuTimer timer;
    const LightGridSH *from = options.cubesFromSH ? gridSH : nullptr;
    const std::vector<Light> lights = from ? std::vector<Light>{} : LightsForSH(setup, log);
    const GridInputs in{setup.space, setup.scene, options, setup.world, jobs, log, indirect};
    const LeafCubes leafs = SampleLeafs(in, lights, from, stats);
    auto cubes = StoreCubes(setup.space, leafs, options.cubeTolerance, jobs, log);
    log.Count((long long)(stats.points), "places sampled");
    log.Count((long long)(cubes ? cubes->samples.size() : 0), "ambient cubes");
    log.Count((long long)(stats.open), "leafs with ambient cubes");
    log.Count((long long)(stats.counts.rays), "rays");
    log.Print("{:9.2f} CPU seconds\n", timer.Seconds());
    return cubes;
}

} // namespace q3
