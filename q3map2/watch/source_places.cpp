// GPL-2.0-or-later. Where things of a map source are: primitives that messages name, and lights.
#include "q3map2/watch/source_places.h"

#include "common/error.h"
#include "q3map2/map/map_parse.h"
#include "q3map2/shader/shader_library.h"

#include <algorithm>

namespace q3 {

std::vector<Entity> LightsOfSource(const std::string &text) {
    std::vector<Entity> lights;
    try {
        for (Entity &entity : ParseMapEntities(text, "map"))
            if (IsLight(entity))
                lights.push_back(std::move(entity));
    } catch (const Error &) { // the bsp stage reports it
        lights.clear();
    }
    return lights;
}

SourcePlaces::SourcePlaces(const std::string &text, const Game &game) {
    Log silent(Log::Nowhere());
    try {
        const std::vector<Entity> entities = ParseMapEntities(text, "map");
        for (std::size_t i = 0; i < entities.size(); ++i)
            if (const auto origin = entities[i].Vector({"origin"}))
                entities_.emplace(int(i), *origin);
        // Without game files no brush is an origin brush, so all stay where the source has them.
        const VirtualFileSystem nothing(silent);
        ShaderLibrary shaders(nothing, game, {}, silent);
        const BspOptions options;
        const Map map = ReadMap(text, "map", {.options = options, .game = game, .shaders = shaders, .log = silent});
        for (const MapEntity &entity : map.entities) {
            for (const Brush &brush : entity.brushes)
                primitives_.try_emplace({brush.settings.entity, brush.primitive}, brush.bounds.Center());
            for (const Patch &patch : entity.patches) {
                Boundsf bounds;
                for (const DrawVert &vert : patch.verts)
                    bounds.Add(vert.xyz);
                primitives_.try_emplace({patch.settings.entity, patch.primitive}, bounds.Center());
            }
        }
    } catch (const Error &) { // the bsp stage reports it
    }
}

std::optional<Vec3f> SourcePlaces::Of(int entity, int primitive) const {
    if (const auto found = primitives_.find({entity, primitive}); found != primitives_.end())
        return found->second;
    if (const auto found = entities_.find(entity); found != entities_.end())
        return found->second;
    return std::nullopt;
}

} // namespace q3
