// GPL-2.0-or-later. Short rays among the few triangles around them.
#pragma once

#include "libs/math/bounds.h"
#include "q3map2/light/light_scene.h"

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

/// Triangles in rows for vector code. Where rays are short, testing each of those nearby is faster than walking through
/// the whole scene. Memory is reused.
class NearTriangles {
  public:
    void Add(const LightScene::BlockerTriangle &triangle);
    std::size_t Count() const { return surface_.size(); }
    /// Becomes those of `from` whose bounds are within `reach` of the box that rays start in. Game units.
    void Select(const NearTriangles &from, const Boundsf &starts, float reach);
    /// The same without those that lie behind the plane, normal . p = dist.
    void Select(const NearTriangles &from, const Boundsf &starts, float reach, const Vec3f &normal, float dist);
    enum class Outcome {
        Missed,  ///< no ray meets a triangle; `blockers` holds nothing
        Traced,  ///< `blockers` is set
        NotKnown ///< too many triangles or see-through ones are in the way; `blockers` is as it was
    };
    /// The first triangle beyond `nearest` on each ray of the packet that `live` says, as LightScene::TraceBlockers
    /// would find it. The beam holds all of them.
    Outcome Trace(const RayPacket &packet, const LaneMask &live, const RayBeam &beam, float nearest,
                  LightScene::Blockers &blockers);

  private:
    /// Rows of floats: bounds, then the first corner and the edges from it to the others.
    enum Row { kMinX, kMinY, kMinZ, kMaxX, kMaxY, kMaxZ, kX, kY, kZ, kAx, kAy, kAz, kBx, kBy, kBz, kRows };

    void KeepNear(const NearTriangles &from, const Boundsf &starts, float reach);
    void Copy(const NearTriangles &from);
    void Test(std::size_t triangle, const RayPacket &packet, const LaneMask &live, const RayBeam &beam, float nearest,
              LightScene::Blockers &blockers) const;

    std::array<std::vector<float>, kRows> rows_;
    std::vector<std::int32_t> surface_;
    std::vector<std::uint8_t> seeThrough_;
    std::vector<std::uint8_t> keep_; ///< of the triangles selected from
};

} // namespace q3
