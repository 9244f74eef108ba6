// GPL-2.0-or-later. Skies along one direction.
#pragma once

#include "libs/math/bounds.h"
#include "q3map2/light/scene/sky_faces.h"

#include <array>
#include <cstdint>

namespace q3 {

/// The skies that rays of one direction can meet from receivers of a box, for many packets of them. How far it is to a
/// sky, and how far inside of an edge a ray meets its plane, are linear in the ray's origin, so most skies and edges
/// are decided for the whole box.
class SkyBeam {
  public:
    /// For rays from receivers of the box, which is not empty. The skies are few.
    SkyBeam(const SkyFaces &skies, const Vec3f &direction, const Boundsf &box);
    /// Live rays that meet a sky of that number (-1: of any) first, from `nearest` (not negative) to `distance`, end
    /// there; the others live no longer. Rays on the edge of a sky meet it.
    void Clip(const Lanes3 &origin, int skyIndex, float nearest, Lanes &distance, LaneMask &live) const;

  private:
    struct Range {
        std::size_t from = 0, to = 0;
    };
    struct Face {
        SkyLinear distance; ///< from an origin
        int skyIndex;
        Range pieces; ///< those that some rays meet and others do not; none: all rays meet the face
    };
    struct Box {
        Vec3d center, half;
    };
    void Add(const SkyFaces::Face &face, const Vec3d &direction, const Box &box);

    std::size_t faceCount_ = 0, pieceCount_ = 0, edgeCount_ = 0;
    std::array<Face, kMostSkyFaces> faces_;
    std::array<Range, kMostSkyPieces> pieces_;   ///< of edges_
    std::array<SkyLinear, kMostSkyEdges> edges_; ///< towards the inside
};

} // namespace q3
