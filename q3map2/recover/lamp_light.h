// GPL-2.0-or-later. Lamps, and the light that one of them gives to the observed places.
#pragma once

#include "q3map2/recover/observed_light.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// The cone of a spotlight: its radius is radiusByDist times the distance along the axis, as for Light::radiusByDist.
struct LampCone {
    Vec3f axis; ///< unit vector along which it shines
    float radiusByDist = 1;
};

/// Cones are at least this wide, 5 degrees of half angle: narrower ones would stand for single luxels.
inline constexpr float kLeastRadiusByDist = 0.0875f;

/// A point light or spotlight that falls off with the square of the distance, which counts as at least 16 units.
struct Lamp {
    Vec3f origin;
    Vec3f intensity; ///< of the channels, in units of the key "light"
    std::optional<LampCone> cone{};

    /// The key "light", and the key "_color": light / the largest channel.
    float Intensity() const { return MaxComponent(intensity); }
    Vec3f Color() const { return Intensity() > 0 ? intensity * (1 / Intensity()) : Vec3f{1, 1, 1}; }
    /// Mean of the channels.
    float Strength() const { return MeanOfChannels(intensity); }
};

/// A light entity for each lamp, and a target for each spotlight. first: number of the first target.
std::vector<Entity> LampEntities(std::span<const Lamp> lamps, std::size_t first);

/// What a lamp of intensity 1 gives to a place. Byte scale.
struct LampEntry {
    std::uint32_t place; ///< number in ObservedMap::light
    float light;
};
/// Of one lamp, by ascending place.
using LampColumn = std::vector<LampEntry>;

/// Traces lamps. Safe from several threads. Keeps references.
class LampTracer {
  public:
    /// fastPoint: see SetupEnvelopes.
    LampTracer(const ObservedMap &map, const LightSetup &setup, bool fastPoint)
        : map_(map), setup_(setup), surfacesEnd_(setup.options.fast || fastPoint) {}

    /// Light at the places that the lamp reaches. As in the light stage, it gives none where that would be at most the
    /// falloff tolerance, so its intensity matters. Empty for a lamp in a solid. every: only each so many batches of
    /// places are traced, but at least two of each surface.
    LampColumn Trace(const Lamp &lamp, std::size_t every = 1) const;
    /// The distance beyond which a lamp of some strength gives less than `least`, byte scale.
    float ReachOf(float strength, float least) const;

  private:
    Light LightOf(const Lamp &lamp, float reach, int cluster) const;

    const ObservedMap &map_;
    const LightSetup &setup_;
    bool surfacesEnd_; ///< on surfaces lamps end at the tolerance, as they always do in the legacy grid
};

} // namespace q3
