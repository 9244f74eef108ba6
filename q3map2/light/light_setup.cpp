// GPL-2.0-or-later. A map ready to be lit: its surfaces, lights, scene and grids, set up from a .bsp and files beside
// it.
#include "q3map2/light/light_setup.h"
#include "q3map2/bspfile/switchable_lights.h"

#include "common/error.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/sources/hidden_lights.h"
#include "q3map2/light/sources/light_entities.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/shader/shader_table.h"

#include <algorithm>

namespace q3 {

namespace {

/// Whether the bsp stage has given the light a style, by its targetname.
bool IsNumberedSwitch(const Entity &light, const LightOptions &options) {
    return options.styleSlots && IsSwitchableLight(light);
}

/// Whether a light of `entities` aims at the entity, and none of them has its name.
bool IsMissingTarget(const Entity &entity, const std::vector<Entity> &entities) {
    const std::string_view name = entity.Value("targetname");
    return !name.empty() && !FindTarget(entities, name) && std::ranges::any_of(entities, [&](const Entity &light) {
        return IsLight(light) && keys::kTarget.Text(light) == name;
    });
}

struct NumberedEntities {
    std::vector<Entity> entities;
    std::vector<std::size_t> numbers; ///< by entity: its number in the .bsp or .map that it is from
};

/// The entities of the .bsp, with the lights of the .map source if there is one, since compilers strip lights from the
/// .bsp; also what these lights aim at, if the .bsp has no such entity. Without a .map, or with _keepLights, the lights
/// are those in the .bsp. Switchable lights that the bsp stage has numbered are always those of the .bsp.
NumberedEntities EntitiesWithLights(const std::vector<Entity> &entities, const LightInputs &inputs,
                                    const LightOptions &options, Log &log) {
    const bool keepsLights = keys::kKeepLights.Flag(entities.front());
    WarnOfBadKeys(entities.front(), 0, keys::kWorldLightKeys, log);
    WarnOfBadKeys(entities.front(), 0, keys::kStyleWorldKeys, log);
    WarnOfBadKeys(entities.front(), 0, keys::kMacroKeys, log);
    WarnOfForeignKeys(entities.front(), 0, KeyOwner::World, log);
    const std::vector<Entity> &sources = inputs.mapEntities && !keepsLights ? *inputs.mapEntities : entities;
    for (std::size_t i = 0; i < sources.size(); ++i)
        if (IsLight(sources[i])) {
            WarnOfBadLightKeys(sources[i], i, log);
            WarnOfForeignKeys(sources[i], i, KeyOwner::Light, log);
        }
    const bool replaced = inputs.mapEntities && !keepsLights;
    const auto isNumbered = [&](const Entity &light) { return IsNumberedSwitch(light, options); };
    NumberedEntities result;
    const auto take = [&](const std::vector<Entity> &from, const auto &wanted) {
        for (std::size_t i = 0; i < from.size(); ++i)
            if (wanted(from[i]))
                result.entities.push_back(from[i]), result.numbers.push_back(i);
    };
    take(entities, [&](const Entity &entity) { return !replaced || !IsLight(entity) || isNumbered(entity); });
    if (replaced) {
        take(sources, [&](const Entity &entity) { return IsLight(entity) && !isNumbered(entity); });
        take(sources,
             [&](const Entity &entity) { return !IsLight(entity) && IsMissingTarget(entity, result.entities); });
    }
    if (!inputs.seeksLamps && std::none_of(result.entities.begin(), result.entities.end(), IsLight))
        log.Warn("no light entities", "{}: no light entities, {}; surface, sun and sky lights still count", inputs.name,
                 inputs.mapEntities ? "neither in the .map nor in the .bsp"
                                    : "there is no .map next to the .bsp (if it is lost, -recoverlights finds lamps)");
    return result;
}

void LogLightCounts(const std::vector<Light> &lights, const SurfaceLightCounts &counts, Log &log) {
    const auto of = [&](LightType type) {
        return std::count_if(lights.begin(), lights.end(), [&](const Light &light) { return light.type == type; });
    };
    log.Count(of(LightType::Point), "point lights");
    log.Count(of(LightType::Spot), "spotlights");
    log.Count(counts.areaLights, "diffuse (area) lights");
    log.Count(of(LightType::Sun), "sun/sky lights");
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
    LogLightCounts(lights, counts, log);
    int group = -1;
    for (Light &light : lights)
        light.group = light.sample == 0 ? ++group : group;
    // Lights are traced in reverse order of creation, as in NetRadiant's q3map2: -cheapgrid depends on it.
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

SurfaceDefaults WithWorld(SurfaceDefaults defaults, const WorldLight &world) {
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
LightStyles NumberStyles(const LightOptions &options, const SurfaceTable &table, std::vector<Entity> &entities,
                         Log &log) {
    if (options.noStyles)
        return {};
    std::vector<Entity> lights;
    const auto needsStyle = [&](const Entity &entity) { return IsLight(entity) && !IsNumberedSwitch(entity, options); };
    std::ranges::copy_if(entities, std::back_inserter(lights), needsStyle);
    const bool switchable = options.switchable || keys::kSwitchable.Flag(entities.front());
    LightStyles styles(lights, entities.front(), switchable, StylesOfShaders(table), log);
    for (Entity &entity : entities)
        if (needsStyle(entity))
            styles.Set(entity);
    return styles;
}

/// Errors: a style that the file cannot hold. Engines look up the color of a style in a table.
void CheckStyles(const std::vector<Light> &lights) {
    for (const Light &light : lights)
        if (light.style < 0 || light.style > kLastStyle)
            throw Error("{}: light style {}, but the engine has styles 0 to {}",
                        light.label.empty() ? "a light of a surface" : light.label, light.style, kLastStyle);
}

/// What lights are made of, beside surfaces.
struct LightSources {
    const LightInputs &inputs;
    const std::vector<Entity> &bspEntities; ///< entities that the map keeps
    const BspSpace &space;
    const LightOptions &options;
    const WorldLight &world;
};

/// The lights of entities and surfaces. Sets `styles`, and in `table` texture lights and sky numbers.
std::vector<Light> CreateLightsLogged(const LightSources &from, SurfaceTable &table, LightStyles &styles,
                                      ShaderLibrary &library, Log &log) {
    auto [entities, numbers] = EntitiesWithLights(from.bspEntities, from.inputs, from.options, log);
    log.Section("CreateLights");
    ApplyTexLights(from.inputs.texLights, table, log);
    try {
        styles = NumberStyles(from.options, table, entities, log);
        auto lights = CreateLights(from.space, entities, table, from.options, from.world, library, log);
        if (from.options.styleSlots)
            CheckStyles(lights);
        for (Light &light : lights)
            if (light.entity >= 0)
                light.entity = int(numbers[std::size_t(light.entity)]);
        return lights;
    } catch (const Error &error) {
        throw Error("{}: {}", from.inputs.name, error.what());
    }
}

/// Legacy rays ignore surfaces nearer than this: half the longest side of a cell.
float IgnoreRadius(const GridLayout &layout) {
    return 0.5f * std::max({layout.size[0], layout.size[1], layout.size[2]});
}

} // namespace

LightSetup::LightSetup(const Bsp &map, const LightInputs &inputs, const LightOptions &given,
                       const SurfaceDefaults &defaults, ShaderLibrary &library, Log &log)
    : bsp(map), bspEntities(StoredEntities(map.entities, inputs.name)),
      layout(SetupGridLogged(map, bspEntities.front(), log)), world(ReadWorldLight(bspEntities.front(), given)),
      options(WithWorld(given, world)),
      table(MakeSurfaceTable(map, bspEntities, inputs.surfaceFile, inputs.name + ".srf", library, log,
                             WithWorld(defaults, world))),
      space(map, OpaqueBrushes(map, library)),
      lights(CreateLightsLogged({inputs, bspEntities, space, options, world}, table, styles, library, log)),
      props(LoadStaticProps(
          bspEntities, inputs.vfs, int(map.drawSurfaces.size()),
          [&inputs](std::string_view model) { return inputs.texLights.CastsTextureShadow(model); }, options, library,
          log)),
      scene(map, table, options, IgnoreRadius(layout), props.shadows), skySeenFrom(SkySeenFrom(space, table)),
      units(inputs.units) {
    props.shadows = {}; // the scene has a copy
    lights = CutCrossedLights(std::move(lights), space, scene);
    WarnOfHiddenLights(lights, space, options.noTrace ? nullptr : &scene, log);
    log.Count(scene.TriangleCount(), "occluder triangles");
}

} // namespace q3
