// GPL-2.0-or-later. Faces that a surface is drawn as, what is between two surfaces of one plane, and clusters that see
// a surface.
#pragma once

#include "q3map2/light/scene/light_space.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// A corner of a triangle or quad of a draw surface.
struct FaceCorner {
    Vec3f xyz, normal;
    std::array<float, 2> st{}, luxel{};
    int vertex = 0; ///< the nearest draw vertex
};
using Face = std::vector<FaceCorner>;

/// Triangles of a surface, quads of a curve; clockwise seen from the front.
std::vector<Face> FacesOf(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t surface);

// ---- What is between two surfaces of one plane ----

enum class SurfaceGap {
    Touching, ///< no gap
    NoWall,   ///< farther apart than `reach`, or with only open space in between
    Wall      ///< a solid is on the shortest segment from one to the other
};

/// What is between draw surfaces a and b, which lie in one plane with that normal. reach: game units.
SurfaceGap GapBetween(const SurfaceInputs &in, const SurfaceLight &surfaces, int a, int b, const Vec3f &normal,
                      float reach);

/// Filter for the positions from which a surface may be lit: their cluster must see a cluster of the surface. Caches
/// PVS results, so it is not thread-safe: use one object per thread.
class VisibleClusters {
  public:
    /// `clusters`: of the surface; empty: all are allowed. Keeps references to both.
    VisibleClusters(const BspSpace &space, const std::vector<int> &clusters)
        : space_(space), clusters_(clusters), isVisible_(clusters.empty() ? 0 : std::size_t(space.ClusterCount())) {}
    /// The cluster, or kSolidCluster if it is not allowed.
    int ClusterIfAllowed(int cluster);

  private:
    enum class IsVisible : std::uint8_t { Unknown, No, Yes };
    const BspSpace &space_;
    const std::vector<int> &clusters_;
    std::vector<IsVisible> isVisible_; ///< by cluster
};

} // namespace q3
