// GPL-2.0-or-later. What a surface covers: its faces, the luxels under them, the gaps and clusters around it.
#include "q3map2/lightmap/raw/luxel_raster.h"

#include "q3map2/light/scene/open_parts.h"
#include "q3map2/light/scene/surface_table.h"

#include <algorithm>
#include <limits>
#include <span>

namespace q3 {

// ---- The triangles and quads that a surface is drawn as ----

namespace {

std::vector<Face> FacesOfPatch(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t number) {
    const bspDrawSurface_t &surface = in.bsp.drawSurfaces[number];
    const auto first = surfaces.verts.begin() + surface.firstVert;
    const auto mesh =
        Tessellated(MeshOf<SurfaceVertex>{surface.patchWidth, surface.patchHeight, {first, first + surface.numVerts}},
                    in.table[number].longestCurve);
    const auto corner = [&](const SurfaceVertex &v) {
        const auto nearer = [&](const SurfaceVertex &one, const SurfaceVertex &other) {
            return Length(one.xyz - v.xyz) < Length(other.xyz - v.xyz);
        };
        const auto nearest = std::min_element(first, first + surface.numVerts, nearer);
        return FaceCorner{v.xyz, v.normal, v.st, v.luxel, int(nearest - surfaces.verts.begin())};
    };
    MeshOf<FaceCorner> corners{mesh.width, mesh.height, {}};
    for (const SurfaceVertex &v : mesh.verts)
        corners.verts.push_back(corner(v));
    std::vector<Face> faces;
    for (int y = 0; y + 1 < mesh.height; ++y)
        for (int x = 0; x + 1 < mesh.width; ++x) {
            const auto quad = MeshQuad(corners, x, y);
            faces.emplace_back(quad.begin(), quad.end());
        }
    return faces;
}

} // namespace

std::vector<Face> FacesOf(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t number) {
    const bspDrawSurface_t &surface = in.bsp.drawSurfaces[number];
    if (surface.surfaceType == MST_PATCH)
        return FacesOfPatch(in, surfaces, number);
    std::vector<Face> faces;
    if (surface.surfaceType != MST_PLANAR && surface.surfaceType != MST_TRIANGLE_SOUP)
        return faces;
    for (int i = 0; i + 2 < surface.numIndexes; i += 3) {
        Face &face = faces.emplace_back();
        for (int k = 0; k < 3; ++k) {
            const int vertex = surface.firstVert + in.bsp.drawIndexes[std::size_t(surface.firstIndex + i + k)];
            const SurfaceVertex &v = surfaces.verts[std::size_t(vertex)];
            face.push_back({v.xyz, v.normal, v.st, v.luxel, vertex});
        }
    }
    return faces;
}

// ---- What is between two surfaces of one plane ----

namespace {

/// Surfaces this near to each other touch. Game units.
constexpr float kTouching = 0.2f;
/// A wall is looked for this far in front of the surfaces, where luxels are lit. Game units.
constexpr float kLift = 1;

/// The shortest segment found so far.
struct ShortestSegment {
    float distance2 = std::numeric_limits<float>::infinity();
    Vec3f from, to;

    /// Takes the segment from p to the nearest point of the edge from a to b, if it is shorter.
    void Add(const Vec3f &p, const Vec3f &a, const Vec3f &b) {
        const Vec3f along = b - a;
        const float length2 = Dot(along, along);
        const Vec3f q = a + along * (length2 > 0 ? std::clamp(Dot(p - a, along) / length2, 0.0f, 1.0f) : 0);
        if (const float d = Dot(p - q, p - q); d < distance2)
            distance2 = d, from = p, to = q;
    }
};

class GapFinder {
  public:
    GapFinder(const SurfaceInputs &in, const SurfaceLight &surfaces) : in_(in), surfaces_(surfaces) {}

    /// Surfaces do not overlap, so one end of the shortest segment is a vertex. If two vertices touch, their segment
    /// will do.
    ShortestSegment Between(int a, int b) const {
        ShortestSegment segment;
        for (const SurfaceVertex &p : Verts(a))
            for (const SurfaceVertex &q : Verts(b))
                segment.Add(p.xyz, q.xyz, q.xyz);
        if (segment.distance2 > kTouching * kTouching) {
            AddEdges(a, b, segment);
            AddEdges(b, a, segment);
        }
        return segment;
    }

  private:
    std::span<const SurfaceVertex> Verts(int surface) const {
        const bspDrawSurface_t &record = in_.bsp.drawSurfaces[std::size_t(surface)];
        return {surfaces_.verts.data() + record.firstVert, std::size_t(record.numVerts)};
    }
    /// From the vertices of a to the edges of triangles of b.
    void AddEdges(int a, int b, ShortestSegment &segment) const {
        const bspDrawSurface_t &record = in_.bsp.drawSurfaces[std::size_t(b)];
        const auto corners = Verts(b);
        for (int i = 0; i + 2 < record.numIndexes; i += 3) {
            const int *corner = in_.bsp.drawIndexes.data() + record.firstIndex + i;
            for (std::size_t k = 0; k < 3; ++k)
                for (const SurfaceVertex &p : Verts(a))
                    segment.Add(p.xyz, corners[std::size_t(corner[k])].xyz,
                                corners[std::size_t(corner[(k + 1) % 3])].xyz);
        }
    }

    const SurfaceInputs &in_;
    const SurfaceLight &surfaces_;
};

} // namespace

SurfaceGap GapBetween(const SurfaceInputs &in, const SurfaceLight &surfaces, int a, int b, const Vec3f &normal,
                      float reach) {
    if (!surfaces.bounds[std::size_t(a)].Touches(surfaces.bounds[std::size_t(b)], reach))
        return SurfaceGap::NoWall;
    const ShortestSegment segment = GapFinder(in, surfaces).Between(a, b);
    if (segment.distance2 <= kTouching * kTouching)
        return SurfaceGap::Touching;
    const Vec3f up = normal * kLift;
    return segment.distance2 <= reach * reach &&
                   StateOfSegment(in.space, segment.from + up, segment.to + up) == SegmentState::Blocked
               ? SurfaceGap::Wall
               : SurfaceGap::NoWall;
}

// ---- Clusters that see a surface ----

int VisibleClusters::ClusterIfAllowed(int cluster) {
    if (cluster < 0 || isVisible_.empty())
        return cluster;
    IsVisible &visible = isVisible_[std::size_t(cluster)];
    if (visible == IsVisible::Unknown) {
        const bool any = std::any_of(clusters_.begin(), clusters_.end(),
                                     [&](int ofSurface) { return space_.Visible(ofSurface, cluster); });
        visible = any ? IsVisible::Yes : IsVisible::No;
    }
    return visible == IsVisible::Yes ? cluster : kSolidCluster;
}

} // namespace q3
