// GPL-2.0-or-later. What is solid at a point, and what is in the way of light.
#pragma once

#include "q3map2/light/light_setup.h"
#include "q3map2/lightmap/explain/map_source.h"

#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// A ray from a receiver to a light, without its origin.
struct ShadowRay {
    Vec3f direction;    ///< unit
    float distance = 0; ///< game units
};

/// By which rules rays are traced.
struct RayRules {
    bool toSky = false;
    int skyIndex = -1;      ///< of the sun; -1: any sky
    bool ofSurface = false; ///< the receiver is a luxel
    int receiveShadows = 1; ///< its shadow group
};

/// Names solids and surfaces of a map. Keeps references.
class ObstacleFinder {
  public:
    ObstacleFinder(const LightSetup &setup, const MapSource &source) : setup_(setup), source_(source) {}

    /// What p is in by the rules of lighting: a solid leaf or an opaque brush.
    std::optional<Obstacle> SolidAt(const Vec3f &p) const;
    /// What stops the rays that do not arrive, the most frequent first. At most 16 rays.
    std::vector<Obstacle> Blocking(const Vec3f &from, std::span<const ShadowRay> shadowRays,
                                   const RayRules &rules) const;
    /// The entity or brush of a draw surface near p, which is on it.
    SourcePlace OfSurface(int surface, const Vec3f &p, const Vec3f &normal) const;
    std::string ShaderOf(int surface) const;

  private:
    int BrushAt(const Vec3f &p) const;
    Obstacle OfBrush(int brush, const Vec3f &at, const Vec3f &direction) const;
    Obstacle OfHit(const LightScene::Blockers &hits, std::size_t lane, const Vec3f &from, const ShadowRay &ray) const;

    const LightSetup &setup_;
    const MapSource &source_;
};

} // namespace q3
