// GPL-2.0-or-later. Drawn surfaces as triangles in an Embree scene, for rays that ask what they meet first.
#pragma once

#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/scene/light_embree.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <array>
#include <vector>

namespace q3 {

/// A triangle of a draw surface. u and v are barycentric coordinates as Embree has them: of corners 1 and 2.
struct FaceTriangle {
    int surface = 0;
    std::array<FaceCorner, 3> corners;
    Vec3f front; ///< normal on the front side, not normalized

    static std::array<float, 3> Weights(float u, float v) { return {1 - u - v, u, v}; }
    Vec3f PositionAt(float u, float v) const {
        return Blend(u, v, [](const FaceCorner &c) { return c.xyz; });
    }
    /// The interpolated normal of the surface, not normalized.
    Vec3f NormalAt(float u, float v) const {
        return Blend(u, v, [](const FaceCorner &c) { return c.normal; });
    }
    std::array<float, 2> LuxelAt(float u, float v) const { return BlendPair(u, v, &FaceCorner::luxel); }
    std::array<float, 2> TextureAt(float u, float v) const { return BlendPair(u, v, &FaceCorner::st); }
    /// The draw vertex of the corner with the greatest weight.
    int NearestVertex(float u, float v) const;

  private:
    template <typename Of> Vec3f Blend(float u, float v, const Of &of) const {
        const std::array<float, 3> weights = Weights(u, v);
        return Vec3f{} + of(corners[0]) * weights[0] + of(corners[1]) * weights[1] + of(corners[2]) * weights[2];
    }
    std::array<float, 2> BlendPair(float u, float v, std::array<float, 2> FaceCorner::*of) const {
        const std::array<float, 3> weights = Weights(u, v);
        std::array<float, 2> sum{};
        for (std::size_t axis = 0; axis < 2; ++axis)
            sum[axis] = weights[0] * (corners[0].*of)[axis] + weights[1] * (corners[1].*of)[axis] +
                        weights[2] * (corners[2].*of)[axis];
        return sum;
    }
};

/// Add faces, then Commit; const and safe from several threads from then on.
class FaceScene {
  public:
    /// Adds a convex face of a draw surface.
    void Add(int surface, const Face &face);
    void Commit();

    /// First hits of the rays of a packet, by ray; triangle: null for rays that are not live or meet nothing.
    struct Hits {
        std::array<const FaceTriangle *, kPacketSize> triangle{};
        std::array<float, kPacketSize> u{}, v{};
        /// Whether ray i met the front of its triangle.
        bool InFront(std::size_t i, const RayPacket &rays) const {
            return Dot(triangle[i]->front, rays.direction[i]) < 0;
        }
    };
    Hits FirstHits(const RayPacket &rays, RayCoherence coherence) const;
    /// Clears the live lanes of rays that meet a triangle within their distance, from either side.
    void TraceOccluded(RayPacket &rays) const;

  private:
    std::vector<FaceTriangle> triangles_;
    ScenePtr scene_;
};

} // namespace q3
