// GPL-2.0-or-later. Entities, brushes and curves of a map source with the lines where they begin.
#pragma once

#include "common/log.h"
#include "q3map2/lightmap/explain/explanation.h"
#include "q3map2/map/map.h"

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

class ShaderLibrary;
struct Game;
class MapPlaces;

/// Finds what a map source says about a place. Without a source it knows only the given entities.
class MapSource {
  public:
    /// entities: of the source as the light stage read it, or of the .bsp without one. lights: those that numbers of
    /// lights refer to, if they are others. hasSurfaceNumbers: surfaces name their entities by numbers in `entities`.
    MapSource(std::vector<Entity> entities, std::optional<std::vector<Entity>> lights, bool hasSurfaceNumbers)
        : entities_(std::move(entities)), lights_(std::move(lights)), hasSurfaceNumbers_(hasSurfaceNumbers) {}
    ~MapSource();
    MapSource(const MapSource &) = delete;
    MapSource &operator=(const MapSource &) = delete;

    /// Reads a map source. A source that cannot be read is left out, with a warning.
    void Read(std::string_view text, std::string_view name, const Game &game, ShaderLibrary &shaders, Log &log);

    SourcePlace OfEntity(int number) const;
    /// The entity of a light.
    SourcePlace OfLight(int number) const;
    /// The entity of a surface, by SurfaceEntry::entity.
    SourcePlace OfSurfaceEntity(int number) const;
    /// The brush that holds p, one with a side of that shader if there are several; else an empty place.
    SourcePlace OfBrush(const Vec3f &p, std::string_view shader) const;
    /// The curve of that entity with that shader whose box holds p; else the entity.
    SourcePlace OfCurve(const Vec3f &p, std::string_view shader, int entity) const;

  private:
    std::string LocationOf(int entity, int primitive) const;

    std::vector<Entity> entities_;
    std::optional<std::vector<Entity>> lights_;
    bool hasSurfaceNumbers_ = true;
    Map map_;
    std::shared_ptr<const MapPlaces> places_; ///< null without a source
};

} // namespace q3
