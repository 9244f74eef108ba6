// GPL-2.0-or-later. A map lit again with lamps that were found, and how it differs from the light that it stores.
#include "q3map2/recover/relit_map.h"

#include "q3map2/light/options/light_tone.h"
#include "q3map2/lightmap/raw/lightmap_setup.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace q3 {

std::vector<Entity> EntitiesWithLamps(const RecoverInputs &in, std::span<const Lamp> lamps) {
    std::vector<Entity> entities = StoredEntities(in.bsp.entities, in.inputs.name);
    std::ranges::move(LampEntities(lamps, entities.size()), std::back_inserter(entities));
    return entities;
}

std::vector<Entity> SourceOfLamps(const RecoverInputs &in, std::span<const Lamp> lamps) {
    std::vector<Entity> source(1);
    source.front().Set("classname", "worldspawn");
    const std::vector<Entity> entities = EntitiesWithLamps(in, lamps);
    const auto isTarget = [&](const Entity &entity) {
        const std::string_view name = entity.Value("targetname");
        return !name.empty() && std::ranges::any_of(entities, [&](const Entity &light) {
            return IsLight(light) && light.Value("target") == name;
        });
    };
    std::ranges::copy_if(entities, std::back_inserter(source),
                         [&](const Entity &entity) { return IsLight(entity) || isTarget(entity); });
    return source;
}

RelitMap Relight(const RecoverInputs &in, const ObservedMap &map, std::span<const Lamp> lamps) {
    Bsp bsp = in.bsp;
    bsp.entities = FormatEntities(EntitiesWithLamps(in, lamps));
    LightInputs inputs = in.inputs;
    inputs.mapEntities.reset();
    const LightSetup setup(bsp, inputs, in.options, SurfaceDefaultsOf(in.lightmap), in.library, in.log);
    SurfacePasses passes(setup, in.lightmap, in.jobs, in.log);
    passes.Run();
    GridStats stats;
    RelitMap relit;
    if (!map.gridNumbers.empty())
        relit.grid = LightLegacyGrid(setup, passes.ForGrids(), in.jobs, in.log, stats);
    relit.light = LightAtPlaces(map, setup, passes, relit.grid);
    return relit;
}

RelitDifference Compare(const Bsp &bsp, const ObservedMap &map, const RelitMap &relit) {
    RelitDifference difference;
    difference.unexplained.resize(map.firstGrid);
    double sum = 0;
    for (const ObservedSurface &surface : map.surfaces) {
        const ToneMapper mapper(surface.scale, surface.brightness, map.tone);
        for (std::size_t i = surface.first; i < surface.first + surface.at.size(); ++i) {
            const auto stored = mapper.Bytes(map.light[i].stored);
            const auto now = mapper.Bytes(Max(relit.light[i], surface.least));
            for (std::size_t channel = 0; channel < 3; ++channel) {
                const int d = int(stored[channel]) - int(now[channel]);
                difference.unexplained[i] += float(d) / 3;
                sum += double(d * d);
            }
        }
    }
    if (map.firstGrid > 0)
        difference.surfaces = std::sqrt(sum / (3 * double(map.firstGrid)));
    sum = 0;
    for (const std::uint32_t number : map.gridNumbers)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const bspGridPoint_t &stored = bsp.gridPoints[number], &now = relit.grid[number];
            const int ambient = int(stored.ambient[0][channel]) - int(now.ambient[0][channel]);
            const int directed = int(stored.directed[0][channel]) - int(now.directed[0][channel]);
            sum += double(ambient * ambient + directed * directed);
        }
    if (!map.gridNumbers.empty())
        difference.grid = std::sqrt(sum / (6 * double(map.gridNumbers.size())));
    return difference;
}

std::string UnexplainedText(const ObservedMap &map, const RelitDifference &difference, const std::string &name) {
    std::string text = fmt::format("{{\"format\": \"q3map2-sh unexplained light\", \"version\": 1, "
                                   "\"map\": {}, \"unit\": \"bytes\", \"positions\": [",
                                   nlohmann::json(fmt::format("maps/{}.bsp", name)).dump());
    for (std::size_t i = 0; i < difference.unexplained.size(); ++i) {
        const Vec3f &p = map.positions[i];
        text += fmt::format("{}\n[{:.1f}, {:.1f}, {:.1f}, {:.1f}]", i == 0 ? "" : ",", p.x, p.y, p.z,
                            difference.unexplained[i]);
    }
    return text + "\n]}\n";
}

} // namespace q3
