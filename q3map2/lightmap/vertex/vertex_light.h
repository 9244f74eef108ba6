// GPL-2.0-or-later. Light at the vertices of surfaces, and from where they are lit.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <span>
#include <utility>
#include <vector>

namespace q3 {

/// The places of the vertices of one surface. For one thread. Keeps references.
class VertexPlaces {
  public:
    /// clusters: of the surface.
    VertexPlaces(const SurfaceInputs &in, const bspDrawSurface_t &surface, std::span<const SurfaceVertex> verts,
                 bool twoSided, const std::vector<int> &clusters);

    /// Where shadow rays of a vertex start: 1/8 unit over it, and 1/4 unit towards the middle of the vertices that it
    /// shares edges with, clear of solids that touch it; right over it if only that is in the open.
    const Vec3f &RayOrigin(std::size_t vertex) const { return rayOrigins_[vertex]; }
    /// Cluster of the ray origin moved by `offset`, or kSolidCluster if the vertex may not be lit from there:
    /// - offset 0, the usual place: the cluster of the vertex, or of its ray origin if the vertex is in a solid;
    /// - other offsets, tried for vertices in solids: the place must be in the open, in front of the surface, and on
    ///   that side of a wall on which the surface comes out of the solid.
    int ClusterAt(std::size_t vertex, const Vec3f &offset);
    /// Pairs of vertices with an edge between them; an edge of two triangles occurs twice.
    const std::vector<std::pair<std::size_t, std::size_t>> &Edges() const { return edges_; }

  private:
    void FindEdges(const bspDrawSurface_t &surface);
    int OpenCluster(const Vec3f &p);
    Vec3f OpenOrigin(std::size_t vertex);

    const SurfaceInputs &in_;
    std::span<const SurfaceVertex> verts_;
    bool twoSided_;
    VisibleClusters clusters_;
    std::vector<std::pair<std::size_t, std::size_t>> edges_;
    std::vector<Vec3f> rayOrigins_;
    std::vector<Vec3f> middles_; ///< of the vertices that share edges with a vertex, lifted
};

/// How vertices of a draw surface are lit.
SurfaceLightSettings VertexSettings(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t surface);

/// Lights the vertices of all surfaces: surfaces without a lightmap by `lights` (from SetupEnvelopes for surfaces),
/// other surfaces from the nearest luxels of their lightmap. Adds the work done to `counts`.
void LightVertices(const SurfaceInputs &in, const std::vector<Light> &lights, const SurfacePass &pass,
                   SurfaceLight &surfaces, ContributionCounts &counts);

} // namespace q3
