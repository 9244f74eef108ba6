// GPL-2.0-or-later. Short rays among the few triangles around them.
#pragma once

#include "libs/math/bounds.h"
#include "q3map2/light/scene/light_scene.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// What all rays of a packet pass through.
struct RayBeam {
    Vec3f from, to;      ///< bounds of where they start; of the whole rays if their directions differ
    bool narrow = false; ///< directions are the same
    Vec3f direction;
    float length = 0;
};
/// Of the packet's live rays.
RayBeam BeamOf(const RayPacket &packet);

/// Triangles in groups for vector code. Where rays are short, testing each of those nearby is faster than walking
/// through the whole scene. Memory is reused.
class NearTriangles {
  public:
    void Add(const LightScene::BlockerTriangle &triangle);
    std::size_t Count() const { return count_; }
    /// Becomes those of `from` whose bounds are within `reach` of the box that rays start in. Game units.
    void Select(const NearTriangles &from, const Boundsf &starts, float reach);
    /// The same without those that lie behind the plane, normal . p = dist.
    void Select(const NearTriangles &from, const Boundsf &starts, float reach, const Vec3f &normal, float dist);
    enum class Outcome {
        Missed,   ///< no ray meets a triangle; `blockers` holds nothing
        Traced,   ///< `blockers` is set
        Undecided ///< too many triangles or see-through ones are in the way; `blockers` is as it was
    };
    /// The first triangle beyond `nearest` on each ray of the packet that `live` says, as LightScene::TraceBlockers
    /// would find it. The beam holds all of them.
    Outcome Trace(const RayPacket &packet, const LaneMask &live, const RayBeam &beam, float nearest,
                  LightScene::Blockers &blockers);
    /// After Traced: the first triangle beyond each ray's own `nearest` on some of the same rays; Missed or Traced.
    Outcome TraceNextHit(const RayPacket &packet, const LaneMask &live, const Lanes &nearest,
                         LightScene::Blockers &blockers) const;

    /// Sixteen triangles: bounds, the first corner, the edges from it to the others, and those edges' cross product.
    struct Group {
        Lanes3 mins, maxs, corner, a, b, normal;
        std::array<std::int32_t, kPacketSize> surface;
        unsigned used = 0, seeThrough = 0; ///< bits of lanes
    };
    /// A number that is linear in where a ray starts: slope . start + middle.
    struct LinearForm {
        Lanes3 slope;
        Lanes middle;
    };
    /// Where rays of one direction meet the planes of sixteen triangles: in shares of the edges, and along the ray.
    struct Forms {
        LinearForm u, v, t;
        unsigned met = 0; ///< bits of triangles that some rays of the beam may meet
    };
    struct NarrowBeam;

  private:
    void Append(const Group &from, std::size_t lane);
    /// Sets `met` of forms_; Traced: some triangle may be met.
    Outcome FindMet(const RayBeam &beam, const NarrowBeam &narrow);

    std::size_t count_ = 0;
    std::vector<Group> groups_;
    std::vector<Boundsf> bounds_; ///< by group; none of those that were selected
    // Of the last beam.
    std::vector<Forms> forms_; ///< by group
    bool narrow_ = false;
    Vec3f middle_;
};

} // namespace q3
