// GPL-2.0-or-later. Entities of the map source, as written for the game.
#include "q3map2/geometry/emit/game_entities.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/bspfile/switchable_lights.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

/// Keys that stages write into worldspawn of the .bsp; kept if present.
constexpr std::array<std::string_view, 3> kToolKeys = {"_q3map2_cmdline", "_q3map2_version", "gridsize"};
/// Keys that describe the light stored in the .bsp, so values in the map source are ignored.
constexpr std::array<std::string_view, 3> kLightKeys = {kGridSHKey, kToneKey, kRnmKey};

std::string_view NameOfOriginal(const MapEntity &entity) {
    return keys::kInstance.Text(entity.pairs);
}

/// Whether primitives of the entity become a model. Those of decals do not.
bool MayBeModel(const MapEntity &entity) {
    return !EqualNoCase(entity.pairs.ClassName(), "_decal");
}

/// Gives each clone the `model` value of the entity that it names.
void ShareModels(Map &map, const BspContext &context) {
    for (MapEntity &entity : map.entities) {
        const std::string_view name = NameOfOriginal(entity);
        if (name.empty())
            continue;
        const auto original = std::find_if(map.entities.begin(), map.entities.end(), [&](const MapEntity &other) {
            return EqualNoCase(keys::kCloneName.Text(other.pairs), name);
        });
        if (original == map.entities.end() || !original->pairs.Has("model")) {
            context.log.Warn("clone without parent", "{}: it is a clone of {}, but {}", entity.MessagePrefix(), name,
                             original == map.entities.end() ? "no entity has that _clonename"
                                                            : "that entity has no model");
            continue;
        }
        const std::string model(original->pairs.Value("model"));
        entity.pairs.Set("model", model);
    }
}

void NumberModels(Map &map, const BspContext &context) {
    int models = 1; // the world is the first
    for (std::size_t i = 0; i < map.entities.size(); ++i) {
        MapEntity &entity = map.entities[i];
        if (i == 0) {
            entity.model = 0;
            continue;
        }
        if (!MayBeModel(entity))
            continue;
        if (!NameOfOriginal(entity).empty()) {
            entity.brushes.clear();
            entity.patches.clear();
        }
        if (!entity.brushes.empty() || !entity.patches.empty()) {
            entity.model = models++;
            entity.pairs.Set("model", fmt::format("*{}", entity.model));
        }
    }
    ShareModels(map, context);
    context.log.VerboseCount(models, "models");
}

/// Games with light styles in their files: numbers the switchable lights. Errors: styles that engines do not have.
void SetUpLightStyles(Map &map, const BspContext &context) {
    if (!context.game.styleSlots)
        return;
    std::vector<Entity *> lights;
    for (MapEntity &entity : map.entities) {
        if (!IsLight(entity.pairs))
            continue;
        RestoreLightStyle(entity.pairs); // entities may come from a .bsp
        const int style = StyleInFile(entity.pairs);
        if (style > kLastStyle)
            throw Error("{}: light style {}, expected 0 to {}: engines of this game have no others",
                        entity.MessagePrefix(), style, kLastStyle);
        if (style >= kFirstSwitchStyle && !IsSwitchableLight(entity.pairs))
            context.log.Warn("style of switchable lights",
                             "{}: light style {}, but {} to {} belong to switchable lights, and this light has no "
                             "targetname: it is switched with the group that has this style, or stays dark",
                             entity.MessagePrefix(), style, kFirstSwitchStyle, kLastStyle);
        lights.push_back(&entity.pairs);
    }
    NumberSwitchableLights(lights, map.name);
}

} // namespace

void NumberEntities(Map &map, const BspContext &context) {
    NumberModels(map, context);
    SetUpLightStyles(map, context);
}

std::string GameEntities(const Map &map, const BspContext &context) {
    const BspOptions &options = context.options;
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
            (IsLight(entity.pairs) && !keepLights && !(context.game.styleSlots && IsSwitchableLight(entity.pairs)));
        if (&entity.pairs == &world || (!isCompiledIn && !entity.pairs.pairs.empty()))
            kept.push_back(entity.pairs);
    }
    return FormatEntities(kept);
}

void ReplaceEntities(Bsp &bsp, Map &map, const BspContext &context) {
    NumberEntities(map, context);
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
    bsp.entities = GameEntities(map, context);
    if (context.game.styleSlots && HaveOtherSwitches(old, ParseEntities(bsp.entities, map.name)))
        context.log.Warn("renumbered lights",
                         "{}: switchable lights have other styles than before: light the map again", map.name);
    DropUnfitLumps(bsp, map.name, context.log);
}

} // namespace q3
