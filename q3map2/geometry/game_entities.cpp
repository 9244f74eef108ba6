// GPL-2.0-or-later. Entities of the map source, as written for the game.
#include "q3map2/geometry/game_entities.h"

#include "common/text/text.h"
#include "q3map2/bspfile/bspfile_hdr.h"
#include "q3map2/bspfile/object_keys.h"
#include "q3map2/bspfile/surface_keys.h"
#include "q3map2/bspfile/written_keys.h"
#include "q3map2/geometry/compile_map.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

/// Keys that stages write into worldspawn of the .bsp; kept if present.
constexpr std::array<std::string_view, 3> kToolKeys = {"_q3map2_cmdline", "_q3map2_version", "gridsize"};
/// Keys that describe the light stored in the .bsp, so values in the map source are ignored.
constexpr std::array<std::string_view, 3> kLightKeys = {kGridSHKey, kToneKey, kRnmKey};

std::string_view CloneOf(const MapEntity &entity) {
    return keys::kInstance.Text(entity.pairs);
}

bool HasPrimitives(const MapEntity &entity) {
    return !entity.brushes.empty() || !entity.patches.empty();
}

/// Gives each clone the `model` value of the entity that it names.
void ShareModels(Map &map, const BspContext &context) {
    for (MapEntity &entity : map.entities) {
        const std::string_view name = CloneOf(entity);
        if (name.empty())
            continue;
        const auto parent = std::find_if(map.entities.begin(), map.entities.end(), [&](const MapEntity &other) {
            return EqualNoCase(keys::kCloneName.Text(other.pairs), name);
        });
        if (parent == map.entities.end() || !parent->pairs.Has("model")) {
            context.log.Warn("clone without parent", "{}: it is a clone of {}, but {}", entity.MessagePrefix(), name,
                             parent == map.entities.end() ? "no entity has that _clonename"
                                                          : "that entity has no model");
            continue;
        }
        const std::string model(parent->pairs.Value("model"));
        entity.pairs.Set("model", model);
    }
}

} // namespace

void NumberModels(Map &map, const BspContext &context) {
    int models = 1;
    for (std::size_t i = 0; i < map.entities.size(); ++i) {
        MapEntity &entity = map.entities[i];
        if (i == 0) {
            entity.model = 0;
            continue;
        }
        if (!CloneOf(entity).empty()) {
            entity.brushes.clear();
            entity.patches.clear();
        }
        if (HasPrimitives(entity)) {
            entity.model = models++;
            entity.pairs.Set("model", fmt::format("*{}", entity.model));
        }
    }
    ShareModels(map, context);
    context.log.VerboseCount(models, "models");
}

std::string GameEntities(const Map &map, const BspOptions &options) {
    const Entity &world = map.entities.front().pairs;
    const bool keepLights = options.keepLights || keys::kKeepLights.Flag(world);
    const bool keepModels = options.keepModels || keys::kKeepModels.Flag(world);
    std::vector<Entity> kept;
    for (const MapEntity &entity : map.entities) {
        const std::string_view name = entity.pairs.ClassName();
        const bool isCompiledIn =
            EqualNoCase(name, "_decal") || EqualNoCase(name, "_skybox") || EqualNoCase(name, "func_group") ||
            EqualNoCase(name, "group_info") ||
            (EqualNoCase(name, "misc_model") && !keepModels && !keys::kStaticProp.Flag(entity.pairs)) ||
            (StartsWithNoCase(name, "light") && !keepLights);
        if (&entity.pairs == &world || (!isCompiledIn && !entity.pairs.pairs.empty()))
            kept.push_back(entity.pairs);
    }
    return FormatEntities(kept);
}

void ReplaceEntities(Bsp &bsp, Map &map, const BspContext &context) {
    NumberModels(map, context);
    const std::vector<Entity> old = ParseEntities(bsp.entities, map.name);
    for (const std::string_view key : kToolKeys)
        if (!old.empty() && old.front().Has(key))
            map.World().pairs.Set(key, old.front().Value(key));
    for (const std::string_view key : kLightKeys) {
        map.World().pairs.Erase(key);
        if (!old.empty() && old.front().Has(key))
            map.World().pairs.Set(key, old.front().Value(key));
    }
    std::erase_if(map.World().pairs.pairs, [](const auto &pair) { return IsStyleKey(pair.first); });
    if (!old.empty())
        for (const auto &[key, value] : old.front().pairs)
            if (IsStyleKey(key))
                map.World().pairs.Set(key, value);
    bsp.entities = GameEntities(map, context.options);
    DropUnfitHdrLight(bsp, map.name, context.log);
}

} // namespace q3
