// GPL-2.0-or-later. What rays see.
#pragma once

#include "common/log.h"
#include "q3map2/light/batch/ray_packet.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/scene/surface_table.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace q3 {

/// Whose shadow rules count.
enum class ShadowRules {
    LegacyGrid, ///< as the established program: surfaces (and skies) nearer than a radius and all patches are ignored
    Exact       ///< everything that casts shadows does
};

/// Rays from surfaces ignore surfaces nearer than this: receivers lie a little off their own. Game units.
inline constexpr float kSurfaceIgnoreRadius = 1.5f;

/// All shadow casters of a map. Tracing is safe from several threads. Keeps a reference to the Bsp.
class LightScene {
  public:
    /// legacyIgnoreRadius: game units, ShadowRules::LegacyGrid. The table is only read here.
    LightScene(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, float legacyIgnoreRadius);
    ~LightScene();

    /// Point, spot and area lights: blocked by solids and by surfaces.
    void TraceToLight(RayPacket &packet, ShadowRules rules, RayCounts &counts) const;
    /// Suns: light arrives only where the first thing on the way is a sky, of that number unless -1.
    void TraceToSky(RayPacket &packet, int skyIndex, ShadowRules rules, RayCounts &counts) const;
    /// The same for receivers on surfaces. receiveShadows is their shadow group: 0 sees all light, 1 (the default) is
    /// shadowed by every caster, others as the keys _castShadows and _receiveShadows say. Surfaces nearer than
    /// kSurfaceIgnoreRadius are ignored, and so are corners of solids that a ray leaves within it.
    void TraceSurfaceToLight(RayPacket &packet, int receiveShadows, RayCounts &counts) const;
    void TraceSurfaceToSky(RayPacket &packet, int skyIndex, int receiveShadows, RayCounts &counts) const;
    /// Distance to the first blocker up to packet.distance, into packet.distance; skies count as open. For floodlight.
    void TraceDistance(RayPacket &packet, float ignoreRadius, RayCounts &counts) const;

    /// What the rays of a packet meet first.
    struct Blockers {
        LaneMask hit{};   ///< rays that something blocks within packet.distance
        Lanes distance;   ///< to it, where there is one
        IntLanes surface; ///< its draw surface; -1: a solid
    };
    enum class BlockerKind {
        Solids,       ///< those behind skies too
        LegacySolids, ///< without those that surfaces sunk into them open to the established program
        Surfaces ///< that cast shadows; see-through ones where their texel is opaque, for group 1 none on LegacySolids
    };
    /// The first blocker of a kind on each live ray beyond its `nearest`; none for receivers of group 0. For dirt, and
    /// floodlight on surfaces.
    void TraceBlockers(const RayPacket &packet, BlockerKind kind, int receiveShadows, const Lanes &nearest,
                       Blockers &blockers, RayCounts &counts) const;
    struct BlockerTriangle {
        std::array<Vec3f, 3> corners;
        int surface = -1;        ///< as in Blockers
        bool seeThrough = false; ///< its texels decide
    };
    /// All LegacySolids, and Surfaces for receivers of group 1.
    std::vector<BlockerTriangle> BlockerTriangles() const;

    std::size_t TriangleCount() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3
