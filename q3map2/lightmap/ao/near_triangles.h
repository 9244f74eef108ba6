// GPL-2.0-or-later. Brute-force intersection of short rays with the few triangles around them.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/light/scene/light_scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// Bounds of the origins and ends of the packet's live rays.
Boundsf RayBounds(const RayPacket &packet);

/// Triangles in groups of 16 for vector code. Where rays are short, testing all triangles nearby is faster than Embree:
/// without it a bake of lightmaps with -dirty takes 9 to 15 % longer. Memory is reused.
class NearTriangles {
  public:
    void Add(const LightScene::BlockerTriangle &triangle);
    std::size_t Count() const { return count_; }
    /// Replaces the contents: the triangles of `from` whose bounds are within `reach` (game units) of the ray origins'
    /// box.
    void Select(const NearTriangles &from, const Boundsf &starts, float reach);
    /// The same without triangles that are wholly behind the plane normal . p = dist.
    void Select(const NearTriangles &from, const Boundsf &starts, float reach, const Vec3f &normal, float dist);
    enum class Outcome {
        Missed,   ///< no ray hits a triangle; do not read `blockers`
        Traced,   ///< `blockers` is set
        Undecided ///< too many triangles, or transparent ones, are in the bounds; `blockers` is as it was
    };
    /// The first hit beyond `tnear` of each live ray, as of LightScene::TraceBlockers. bounds: RayBounds of the rays.
    Outcome Trace(const RayPacket &packet, const LaneMask &live, const Boundsf &bounds, float tnear,
                  LightScene::Blockers &blockers);
    /// After Traced, for some of the same rays: the first hit beyond each ray's own `tnear`. Missed or Traced.
    Outcome TraceNextHit(const RayPacket &packet, const LaneMask &live, const Lanes &tnear,
                         LightScene::Blockers &blockers) const;

    /// Sixteen triangles: bounds, the first corner, and the edges from it to the second and the third.
    struct Group {
        Lanes3 mins, maxs, corner, edge1, edge2;
        std::array<std::int32_t, kPacketSize> surface;
        unsigned used = 0, seeThrough = 0; ///< a bit for each lane
    };

  private:
    void Append(const Group &from, std::size_t lane);
    /// Sets inBounds_; Traced: some triangle is in the bounds.
    Outcome FindInBounds(const Boundsf &bounds);

    std::size_t count_ = 0;
    std::vector<Group> groups_;
    std::vector<Boundsf> bounds_;    ///< by group; empty after Select
    std::vector<unsigned> inBounds_; ///< by group: bits of triangles in the latest bounds
};

} // namespace q3
