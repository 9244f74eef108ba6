// GPL-2.0-or-later. The light stage.
#include "q3map2/light/light.h"

#include "common/error.h"
#include "q3map2/light/gridsh_dering.h"
#include "q3map2/light/gridsh_error.h"
#include "q3map2/light/light_space.h"

#include <algorithm>

namespace q3 {

namespace {

bool IsLight(const Entity &entity) {
    return StartsWithNoCase(entity.ClassName(), "light");
}

/// Entities with the lights that count: those of the .map source when there is one, since compilers strip them from the
/// .bsp; else what the .bsp kept.
std::vector<Entity> EntitiesWithLights(std::vector<Entity> entities, const LightInputs &inputs, Log &log) {
    const bool kept = entities.front().Flag("_keepLights");
    if (inputs.mapEntities && !kept) {
        std::erase_if(entities, IsLight);
        std::copy_if(inputs.mapEntities->begin(), inputs.mapEntities->end(), std::back_inserter(entities), IsLight);
    }
    if (std::none_of(entities.begin(), entities.end(), IsLight))
        log.Warn("no light entities", "{}: no light entities, {}; surface, sun and sky lights still count", inputs.name,
                 inputs.mapEntities ? "neither in the .map nor in the .bsp" : "there is no .map beside the .bsp");
    return entities;
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

/// Lights that these file formats have no place for: of other styles than 0.
std::size_t DropStyled(std::vector<Light> &lights) {
    return std::erase_if(lights, [](const Light &light) { return light.style != 0; });
}

void LightLegacyGrid(Bsp &bsp, const GridInputs &in, const GridLayout &layout, const std::vector<Light> &created,
                     const std::vector<bool> &skySeenFrom, GridStats &stats) {
    in.log.Section("TraceGrid");
    int culled = 0;
    const auto lights = SetupEnvelopes(created, LightPass::LegacyGrid, in.options, in.space, skySeenFrom, culled);
    in.log.Count((long long)(lights.size()), "lights");
    in.log.Count(culled, "lights culled");
    bsp.gridPoints = TraceGrid(in, layout, lights, stats);
    stats.Print(in.log, in.log.IsVerbose());
}

void LightGridInSH(Bsp &bsp, const GridInputs &in, const Float3 &legacySize, const std::vector<Light> &created,
                   const std::vector<bool> &skySeenFrom, GridStats &stats) {
    in.log.Section("TraceGridSH");
    const GridLayout layout = SetupGridSH(bsp, legacySize, in.options, in.log);
    int culled = 0;
    auto lights = SetupEnvelopes(created, LightPass::GridSH, in.options, in.space, skySeenFrom, culled);
    if (const std::size_t styled = DropStyled(lights); styled > 0)
        in.log.Count((long long)(styled), "lights of other styles than 0 left out: they change while the game runs");
    in.log.Count((long long)(lights.size()), "lights");
    in.log.Count(culled, "lights culled");
    bsp.gridSH = TraceGridSH(in, layout, lights, stats);
    bsp.gridSHContainer = in.options.shBspx ? GridSHContainer::Bspx : GridSHContainer::Lump;
    stats.Print(in.log, in.log.IsVerbose());
    if (in.options.shDering) {
        const DeringStats changed = DeringGridSH(*bsp.gridSH, in.options.shRadiance, in.jobs);
        in.log.Count(changed.points, "points rid of negative lobes");
        in.log.Print("{:9.2f} of 255 is the largest change of displayed light\n", changed.largestChange);
    }
    if (in.options.shError)
        PrintGridSHError(MeasureGridSH(in, *bsp.gridSH, lights), layout.size, legacySize, in.log);
}

void EraseKey(Entity &entity, std::string_view key) {
    std::erase_if(entity.pairs, [&](const auto &pair) { return EqualNoCase(pair.first, key); });
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

std::vector<Light> CreateLights(const Bsp &bsp, const std::vector<Entity> &entities, SurfaceTable &table,
                                const LightOptions &options, const WorldLight &world, ShaderLibrary &library,
                                Log &log) {
    std::vector<Light> lights = EntityLights(entities, options, log);
    SurfaceLightCounts counts;
    auto ofSurfaces = SurfaceLights(bsp, table, options, world, library, counts, log);
    std::move(ofSurfaces.begin(), ofSurfaces.end(), std::back_inserter(lights));
    CountLights(lights, counts, log);
    // The newest light counts first, as in the established program: -cheapgrid depends on it.
    std::reverse(lights.begin(), lights.end());
    return lights;
}

LightResult LightWorld(Bsp &bsp, const LightInputs &inputs, const LightOptions &options, ShaderLibrary &library,
                       const JobPool &jobs, Log &log) {
    std::vector<Entity> stored = ParseEntities(bsp.entities, inputs.name);
    if (stored.empty())
        stored.push_back({{{"classname", "worldspawn"}}});
    const std::vector<Entity> entities = EntitiesWithLights(stored, inputs, log);

    log.Section("SetupGrid");
    const GridLayout layout = SetupGrid(bsp, stored.front(), log);

    LightOptions settings = options;
    const WorldLight world = ReadWorldLight(stored.front(), options);
    settings.tone.maxLight = world.maxLight;
    SurfaceTable table = MakeSurfaceTable(bsp, stored, inputs.surfaceFile, inputs.name + ".srf", library, log);
    log.Section("CreateLights");
    const std::vector<Light> lights = [&] {
        try {
            return CreateLights(bsp, entities, table, settings, world, library, log);
        } catch (const Error &error) {
            throw Error("{}: {}", inputs.name, error.what());
        }
    }();

    log.Section("SetupTraceNodes");
    const BspSpace space(bsp, OpaqueBrushes(bsp, library));
    const float ignoreRadius = 0.5f * std::max({layout.size[0], layout.size[1], layout.size[2]});
    const LightScene scene(bsp, table, settings, ignoreRadius);
    log.Count((long long)(scene.TriangleCount()), "triangles that rays can meet");
    const std::vector<bool> skySeenFrom = SkySeenFrom(space, table);

    LightResult result;
    const GridInputs in{space, scene, settings, world, jobs, log};
    if (!options.noGrid)
        LightLegacyGrid(bsp, in, layout, lights, skySeenFrom, result.grid);
    bsp.gridSH.reset();
    EraseKey(stored.front(), kGridSHKey);
    if (options.sh) {
        LightGridInSH(bsp, in, layout.size, lights, skySeenFrom, result.gridSH);
        if (options.shRadiance)
            stored.front().Set(kGridSHKey, "radiance");
    }
    bsp.entities = FormatEntities(stored);
    return result;
}

} // namespace q3
