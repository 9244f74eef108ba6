// GPL-2.0-or-later. Lamps as light entities of a map source.
#include "q3map2/recover/lamp_entities.h"

#include "q3map2/bspfile/entities.h"

#include <fmt/format.h>

#include <vector>

namespace q3 {

std::string LampEntities(std::span<const Lamp> lamps) {
    std::vector<Entity> entities(1);
    entities.front().Set("classname", "worldspawn");
    for (const Lamp &lamp : lamps) {
        const Vec3f color = lamp.Color();
        Entity &entity = entities.emplace_back();
        entity.Set("classname", "light");
        entity.Set("origin", fmt::format("{:.1f} {:.1f} {:.1f}", lamp.origin.x, lamp.origin.y, lamp.origin.z));
        entity.Set("light", fmt::format("{:.2f}", lamp.Intensity()));
        if (!(color == Vec3f{1, 1, 1}))
            entity.Set("_color", fmt::format("{:.4f} {:.4f} {:.4f}", color.x, color.y, color.z));
    }
    return FormatEntities(entities);
}

} // namespace q3
