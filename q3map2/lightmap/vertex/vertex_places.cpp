// GPL-2.0-or-later. From where the vertices of surfaces without lightmaps are lit.
#include "q3map2/lightmap/vertex/vertex_places.h"

#include "q3map2/light/scene/light_way.h"

namespace q3 {

namespace {

/// Shadow rays start this far over the vertex and this far inside its surface. Game units.
constexpr float kLift = 1.0f / 8, kInset = 1.0f / 4;
/// A vertex counts as inside a solid from this depth on. Game units.
constexpr float kSolidDepth = 0.125f;
/// Bisections that find where a way leaves a solid.
constexpr int kBisections = 12;

} // namespace

VertexPlaces::VertexPlaces(const SurfaceInputs &in, const bspDrawSurface_t &surface,
                           std::span<const SurfaceVertex> verts, bool twoSided, const std::vector<int> &clusters)
    : in_(in), verts_(verts), twoSided_(twoSided), clusters_(in.space, clusters), rayOrigins_(verts.size()),
      middles_(verts.size()) {
    FindEdges(surface);
    std::vector<Vec3f> around(verts.size());
    std::vector<float> counts(verts.size());
    for (const auto &[a, b] : edges_) {
        around[a] += verts[b].xyz, counts[a] += 1;
        around[b] += verts[a].xyz, counts[b] += 1;
    }
    for (std::size_t v = 0; v < verts.size(); ++v) {
        const Vec3f middle = counts[v] > 0 ? around[v] / counts[v] : verts[v].xyz, lift = verts[v].normal * kLift;
        const Vec3f inside = counts[v] > 0 ? Normalize(middle - verts[v].xyz) : Vec3f{};
        rayOrigins_[v] = verts[v].xyz + lift + inside * kInset;
        middles_[v] = middle + lift;
        // The surface may go on into a solid whose face the vertex is on.
        if (const Vec3f above = verts[v].xyz + lift; OpenCluster(rayOrigins_[v]) < 0 && OpenCluster(above) >= 0)
            rayOrigins_[v] = above;
    }
}

void VertexPlaces::FindEdges(const bspDrawSurface_t &surface) {
    if (surface.surfaceType == MST_PATCH) {
        const auto width = std::size_t(surface.patchWidth), height = std::size_t(surface.patchHeight);
        for (std::size_t y = 0; y < height; ++y)
            for (std::size_t x = 0; x < width; ++x) {
                if (x + 1 < width)
                    edges_.emplace_back(y * width + x, y * width + x + 1);
                if (y + 1 < height)
                    edges_.emplace_back(y * width + x, (y + 1) * width + x);
            }
        return;
    }
    for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
        const int *corner = in_.bsp.drawIndexes.data() + surface.firstIndex + i;
        for (std::size_t k = 0; k < 3; ++k)
            edges_.emplace_back(std::size_t(corner[k]), std::size_t(corner[(k + 1) % 3]));
    }
}

int VertexPlaces::OpenCluster(const Vec3f &p) {
    return clusters_.ClusterIfAllowed(in_.space.ClusterAt(p, -kSolidDepth));
}

int VertexPlaces::ClusterAt(std::size_t vertex, const Vec3f &offset) {
    if (offset == Vec3f{}) {
        const int cluster = OpenCluster(verts_[vertex].xyz);
        return cluster >= 0 ? cluster : OpenCluster(rayOrigins_[vertex]);
    }
    const Vec3f aside = rayOrigins_[vertex] + offset;
    const int cluster = twoSided_ || Dot(offset, verts_[vertex].normal) >= 0 ? OpenCluster(aside) : kSolidCluster;
    return cluster >= 0 && WayBetween(in_.space, WayOut(vertex), aside) != Way::Blocked ? cluster : kSolidCluster;
}

/// Where the way from a vertex in a solid towards its neighbors comes out; the ray origin if it does not.
Vec3f VertexPlaces::WayOut(std::size_t vertex) {
    Vec3f inside = rayOrigins_[vertex], outside = middles_[vertex];
    if (OpenCluster(outside) < 0)
        return inside;
    for (int step = 0; step < kBisections; ++step) {
        const Vec3f middle = (inside + outside) * 0.5f;
        (OpenCluster(middle) < 0 ? inside : outside) = middle;
    }
    return outside;
}

} // namespace q3
