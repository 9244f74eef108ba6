// GPL-2.0-or-later. Lamps, and the light that one of them gives to the observed places.
#pragma once

#include "q3map2/recover/observed_light.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace q3 {

/// A point light that falls off with the square of the distance, which counts as at least 16 units.
struct Lamp {
    Vec3f origin;
    Vec3f intensity; ///< of the channels, in units of the key "light"

    /// The key "light", and the key "_color": light / the largest channel.
    float Intensity() const { return MaxComponent(intensity); }
    Vec3f Color() const { return Intensity() > 0 ? intensity * (1 / Intensity()) : Vec3f{1, 1, 1}; }
    /// Mean of the channels.
    float Strength() const { return (intensity.x + intensity.y + intensity.z) / 3; }
};

/// Text of a map source without brushes: worldspawn, and a light entity for each lamp.
std::string LampEntities(std::span<const Lamp> lamps);

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
    LampTracer(const ObservedMap &map, const LightSetup &setup) : map_(map), setup_(setup) {}

    /// Light at the places that the lamp reaches. As in the light stage, it gives none where that would be at most the
    /// falloff tolerance, so its intensity matters. Empty for a lamp in a solid. every: only each so many batches of
    /// places are traced, but at least two of each lightmap.
    LampColumn Trace(const Lamp &lamp, std::size_t every = 1) const;
    /// The distance beyond which a lamp of some strength gives less than `least`, byte scale.
    float ReachOf(float strength, float least) const;

  private:
    Light LightOf(const Lamp &lamp, float reach, int cluster) const;

    const ObservedMap &map_;
    const LightSetup &setup_;
};

} // namespace q3
