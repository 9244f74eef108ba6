// GPL-2.0-or-later. Messages of the bsp stage about entities and primitives.
#include "q3map2/map/bsp_context.h"

#include "common/error.h"
#include "q3map2/map/map.h"

#include <algorithm>
#include <utility>

namespace q3 {

std::string MapEntity::MessagePrefix() const {
    return location.empty() ? fmt::format("Entity {}", number) : fmt::format("Entity {}: {}", number, location);
}

void MapPlaces::Set(int entity, int primitive, std::string location) {
    const auto e = std::size_t(std::max(entity, 0)), p = std::size_t(std::max(primitive, -1) + 1);
    if (places_.size() <= e)
        places_.resize(e + 1);
    if (places_[e].size() <= p)
        places_[e].resize(p + 1);
    places_[e][p] = std::move(location);
}

std::string_view MapPlaces::Of(int entity, int primitive) const {
    if (entity < 0 || std::size_t(entity) >= places_.size())
        return {};
    const std::vector<std::string> &places = places_[std::size_t(entity)];
    const auto p = std::size_t(std::max(primitive, -1) + 1);
    if (p < places.size() && !places[p].empty())
        return places[p];
    return places.empty() ? std::string_view() : std::string_view(places.front());
}

std::string BspContext::Located(int entity, int primitive, std::string_view text,
                                std::optional<std::string_view> location) const {
    const std::string_view place = location ? *location : places->Of(entity, primitive);
    return fmt::format("Entity {}{}: {}{}{}", entity, primitive < 0 ? "" : fmt::format(", Brush {}", primitive), place,
                       place.empty() ? "" : ": ", text);
}

void BspContext::WarnAt(std::string_view kind, int entity, int primitive, std::string_view text,
                        std::optional<std::string_view> location) const {
    log.WarnAt(kind, {.entity = entity, .primitive = std::max(primitive, 0), .line = {}},
               Located(entity, primitive, text, location));
}

void BspContext::FailAt(int entity, int primitive, std::string_view text,
                        std::optional<std::string_view> location) const {
    const std::string located = Located(entity, primitive, text, location);
    log.Mark(LogLevel::Error, located, {.entity = entity, .primitive = std::max(primitive, 0), .line = {}});
    throw Error("{}", located);
}

} // namespace q3
