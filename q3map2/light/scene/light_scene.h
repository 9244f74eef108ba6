// GPL-2.0-or-later. Shadow casters and the rays traced against them.
#pragma once

#include "common/log.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/options/light_options.h"
#include "q3map2/light/scene/shadow_casters.h"
#include "q3map2/light/scene/surface_table.h"

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace q3 {

/// Which surfaces block rays from grid points.
enum class ShadowRules {
    LegacyGrid, ///< as NetRadiant's q3map2: surfaces (and skies) nearer than a radius and all patches are ignored
    Exact       ///< everything that casts shadows does
};

/// Rays from surfaces ignore surfaces nearer than this: receivers lie slightly off their own surface. Game units.
inline constexpr float kSurfaceIgnoreRadius = 1.5f;

/// All shadow casters of a map. Tracing is safe from several threads. Keeps a reference to the Bsp.
class LightScene {
  public:
    /// legacyIgnoreRadius: of ShadowRules::LegacyGrid, game units. The table and the props are
    /// copied.
    LightScene(const Bsp &bsp, const SurfaceTable &table, const LightOptions &options, float legacyIgnoreRadius,
               const PropShadows &props = {});
    ~LightScene();

    /// Point, spot and area lights: blocked by solids and by surfaces.
    void TraceToLight(RayPacket &packet, ShadowRules rules, RayCounts &counts) const;
    /// Suns: light arrives only where the first hit is a sky, with number skyIndex unless that is -1.
    void TraceToSky(RayPacket &packet, int skyIndex, ShadowRules rules, RayCounts &counts) const;
    /// TraceToLight and TraceToSky for receivers on surfaces. receiveShadows is their shadow group: 0 sees all light, 1
    /// (the default) is shadowed by every caster, others as the keys _castShadows and _receiveShadows say. Surfaces
    /// nearer than kSurfaceIgnoreRadius are ignored, and so are corners of solids that a ray leaves within that
    /// distance.
    void TraceSurfaceToLight(RayPacket &packet, int receiveShadows, RayCounts &counts) const;
    void TraceSurfaceToSky(RayPacket &packet, int skyIndex, int receiveShadows, RayCounts &counts) const;
    /// Shortens packet.distance to the first blocker beyond ignoreRadius; skies count as open. For floodlight in grids.
    void TraceDistance(RayPacket &packet, float ignoreRadius, RayCounts &counts) const;

    /// What the rays of a packet hit first.
    struct Blockers {
        LaneMask hit{};    ///< rays that something blocks within packet.distance
        LaneMask behind{}; ///< rays that hit a one-sided surface from behind
        Lanes distance;    ///< to the hit, where `hit` is set
        IntLanes surface;  ///< draw surface that is hit, or surface number of a PropCaster; -1: a solid
    };
    enum class BlockerKind {
        Solids,       ///< hull of all solid leafs, also behind skies
        LegacySolids, ///< without leafs that are not solid to NetRadiant's q3map2: LegacySolidLeafs
        Casters, ///< solids, and shadow casters for group 1 (whatever the group asked for) without see-through ones
        Surfaces ///< shadow casters; see-through ones at opaque texels; for group 1 none on faces of LegacySolids
    };
    /// The first blocker of a kind on each live ray beyond its `nearest`; none for receivers of group 0.
    void TraceBlockers(const RayPacket &packet, BlockerKind kind, int receiveShadows, const Lanes &nearest,
                       Blockers &blockers, RayCounts &counts) const;
    /// A triangle that TraceBlockers can hit.
    struct BlockerTriangle {
        std::array<Vec3f, 3> corners;
        int surface = -1;        ///< as in Blockers
        bool seeThrough = false; ///< blocks only at opaque texels
    };
    /// All LegacySolids, and Surfaces for receivers of group 1.
    std::vector<BlockerTriangle> BlockerTriangles() const;

    /// A hash of a triangle that rays can meet, with all that decides what it does to them, and its box.
    struct Fingerprint {
        std::uint64_t hash = 0;
        Boundsf box;
    };
    /// Those of all triangles, by hash. Two scenes with the same fingerprints in a region do the same to rays there.
    const std::vector<Fingerprint> &Fingerprints() const;
    /// Whether light can pass through some triangles and be changed.
    bool HasFilters() const;

    /// Number of triangles that rays to lights and skies can meet, without those of the legacy grid.
    std::size_t TriangleCount() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace q3
