// GPL-2.0-or-later. Entities, brushes and curves of a map source with the lines where they begin.
#include "q3map2/lightmap/explain/map_source.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/map/bsp_options.h"
#include "q3map2/map/map_parse.h"

#include <algorithm>
#include <filesystem>

namespace q3 {

namespace {

/// Points this near to a brush count as in it. Game units.
constexpr double kInBrush = 0.25;
/// The box of the control points of a curve is grown by this. Game units.
constexpr float kNearCurve = 4;

bool Holds(const Brush &brush, const PlaneTable &planes, const Vec3d &p) {
    return !brush.sides.empty() && std::ranges::all_of(brush.sides, [&](const BrushSide &side) {
        const Plane &plane = side.hasPlane ? side.plane : planes[side.planeNum];
        return plane.Distance(p) <= kInBrush;
    });
}

bool HasShader(const Brush &brush, std::string_view shader) {
    return std::ranges::any_of(
        brush.sides, [&](const BrushSide &side) { return side.shader && EqualNoCase(side.shader->name, shader); });
}

bool Holds(const Patch &patch, const Vec3f &p) {
    Boundsf box;
    for (const DrawVert &v : patch.verts)
        box.Add(v.xyz);
    return !patch.verts.empty() && box.Distance(p) <= kNearCurve;
}

} // namespace

MapSource::~MapSource() = default;

void MapSource::Read(std::string_view text, std::string_view name, const Game &game, ShaderLibrary &shaders, Log &log) {
    Log quiet(Log::Nowhere());
    const BspOptions options;
    const BspContext context{options, game, shaders, quiet};
    try {
        map_ = ReadMap(text, name, context);
        places_ = context.places;
    } catch (const Error &error) {
        log.Warn("map source", "no lines of the map source are named: {}", error.what());
    }
}

std::string MapSource::LocationOf(int entity, int primitive) const {
    const std::string place(places_ ? places_->Of(entity, primitive) : std::string_view{});
    return std::filesystem::path(place).filename().string();
}

SourcePlace MapSource::OfEntity(int number) const {
    SourcePlace place;
    place.entity = number;
    if (number < 0)
        return place;
    if (std::size_t(number) < entities_.size()) {
        const Entity &entity = entities_[std::size_t(number)];
        place.className = entity.ClassName(), place.targetName = entity.Value("targetname");
    }
    place.location = LocationOf(number, -1);
    return place;
}

SourcePlace MapSource::OfLight(int number) const {
    if (!lights_)
        return OfEntity(number);
    SourcePlace place;
    if (number < 0 || std::size_t(number) >= lights_->size())
        return place;
    const Entity &light = (*lights_)[std::size_t(number)];
    const auto same = std::ranges::find_if(entities_, [&](const Entity &other) {
        return other.ClassName() == light.ClassName() && other.Value("origin") == light.Value("origin");
    });
    if (same != entities_.end())
        return OfEntity(int(same - entities_.begin()));
    place.className = light.ClassName(), place.targetName = light.Value("targetname");
    return place;
}

SourcePlace MapSource::OfSurfaceEntity(int number) const {
    return hasSurfaceNumbers_ || number == 0 ? OfEntity(number) : SourcePlace{};
}

SourcePlace MapSource::OfBrush(const Vec3f &p, std::string_view shader) const {
    const Brush *found = nullptr;
    for (const MapEntity &entity : map_.entities)
        for (const Brush &brush : entity.brushes)
            if (Holds(brush, map_.planes, Vec3d(p - entity.brushOrigin)) &&
                (!found || (!HasShader(*found, shader) && HasShader(brush, shader))))
                found = &brush;
    if (!found)
        return {};
    SourcePlace place = OfEntity(found->settings.entity);
    place.primitive = found->primitive;
    place.location = LocationOf(place.entity, place.primitive);
    return place;
}

SourcePlace MapSource::OfCurve(const Vec3f &p, std::string_view shader, int entity) const {
    SourcePlace place = OfSurfaceEntity(entity);
    for (const MapEntity &owner : map_.entities)
        for (const Patch &patch : owner.patches)
            if ((!hasSurfaceNumbers_ || patch.settings.entity == entity) && patch.shader &&
                EqualNoCase(patch.shader->name, shader) && Holds(patch, p - owner.brushOrigin)) {
                place = OfEntity(patch.settings.entity);
                place.primitive = patch.primitive;
                place.location = LocationOf(place.entity, place.primitive);
                return place;
            }
    return place;
}

} // namespace q3
