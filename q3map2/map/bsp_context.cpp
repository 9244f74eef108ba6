// GPL-2.0-or-later. Messages of the bsp stage about entities and primitives.
#include "q3map2/map/bsp_context.h"

#include "common/error.h"
#include "q3map2/map/map.h"

namespace q3 {

std::string MapEntity::MessagePrefix() const {
    return location.empty() ? fmt::format("Entity {}", number) : fmt::format("Entity {}: {}", number, location);
}

void BspContext::WarnAt(std::string_view kind, int entity, int primitive, std::string_view text) const {
    log.WarnAt(kind, {.entity = entity, .primitive = primitive, .line = {}},
               fmt::format("Entity {}, Brush {}: {}", entity, primitive, text));
}

void BspContext::FailAt(int entity, int primitive, std::string_view text) const {
    const std::string located = fmt::format("Entity {}, Brush {}: {}", entity, primitive, text);
    log.Mark(LogLevel::Error, located, {.entity = entity, .primitive = primitive, .line = {}});
    throw Error("{}", located);
}

} // namespace q3
