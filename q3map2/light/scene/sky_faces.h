// GPL-2.0-or-later. Skies as a few convex polygons.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/scene/shadow_casters.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// Nearest sky hits of the rays of a packet.
struct SkyHits {
    LaneMask hit{};      ///< rays that meet a sky
    LaneMask behind{};   ///< rays that meet it from behind
    Lanes distance;      ///< to the sky; without a hit, the length of the ray
    IntLanes skyIndex{}; ///< number of the sky; 0 without a hit
};

/// With more skies, convex pieces or edges, Embree finds the nearest triangle faster.
inline constexpr std::size_t kMostSkyFaces = 8, kMostSkyPieces = 16, kMostSkyEdges = 64;
/// Outlines this near to a convex polygon count as convex; pieces reach as far over their edges, so that no ray slips
/// through where they meet. Game units.
inline constexpr double kSkyOverlap = 1.0 / 16;
/// A linear function of points p: normal . p - dist. Game units.
struct SkyLinear {
    Vec3f normal;
    float dist;
};
/// The skies of most maps are the few large sides of a box. Testing all rays of a packet against these at once takes a
/// fraction of the time of Embree's nearest hit. Sides that are not convex are cut into convex pieces.
class SkyFaces {
  public:
    using Piece = std::vector<SkyLinear>; ///< by edge: distance, positive inside
    struct Face {
        SkyLinear plane; ///< facing the room
        std::vector<Piece> pieces;
        int skyIndex;
        double area;
    };

    /// indexes: sky number of each triangle.
    SkyFaces(const Triangles &skies, std::span<const int> indexes);
    /// Whether the skies are few convex pieces. Find may be called only then.
    bool Few() const { return few_; }
    /// The nearest face on each live ray between `nearest` and `farthest`. Rays on the edge of a face meet it.
    void Find(const Lanes3 &origin, const Lanes3 &direction, const Lanes &farthest, const LaneMask &live, float nearest,
              SkyHits &hits) const;
    const std::vector<Face> &Faces() const { return faces_; }

  private:
    void AddFace(std::span<const Winding<double>> pieces, int skyIndex);
    static void Test(const Face &face, const Lanes3 &origin, const Lanes3 &direction, float nearest, SkyHits &hits);

    bool few_ = false;
    std::vector<Face> faces_;
};

} // namespace q3
