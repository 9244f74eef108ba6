// GPL-2.0-or-later. What is between two surfaces of one plane.
#include "q3map2/lightmap/raw/surface_gap.h"

#include "q3map2/light/scene/light_way.h"

#include <algorithm>
#include <limits>
#include <span>

namespace q3 {

namespace {

/// Surfaces this near to each other touch. Game units.
constexpr float kTouching = 0.2f;
/// A wall is looked for this far in front of the surfaces, where luxels are lit. Game units.
constexpr float kLift = 1;

/// The shortest way found so far.
struct ShortestWay {
    float distance2 = std::numeric_limits<float>::infinity();
    Vec3f from, to;

    /// Takes the way from p to the nearest point of the edge from a to b, if it is shorter.
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

    /// Surfaces do not overlap, so one end of the shortest way is a vertex. If two vertices touch, their way will do.
    ShortestWay Between(int a, int b) const {
        ShortestWay way;
        for (const SurfaceVertex &p : Verts(a))
            for (const SurfaceVertex &q : Verts(b))
                way.Add(p.xyz, q.xyz, q.xyz);
        if (way.distance2 > kTouching * kTouching) {
            AddEdges(a, b, way);
            AddEdges(b, a, way);
        }
        return way;
    }

  private:
    std::span<const SurfaceVertex> Verts(int surface) const {
        const bspDrawSurface_t &record = in_.bsp.drawSurfaces[std::size_t(surface)];
        return {surfaces_.verts.data() + record.firstVert, std::size_t(record.numVerts)};
    }
    /// From the vertices of a to the edges of triangles of b.
    void AddEdges(int a, int b, ShortestWay &way) const {
        const bspDrawSurface_t &record = in_.bsp.drawSurfaces[std::size_t(b)];
        const auto corners = Verts(b);
        for (int i = 0; i + 2 < record.numIndexes; i += 3) {
            const int *corner = in_.bsp.drawIndexes.data() + record.firstIndex + i;
            for (std::size_t k = 0; k < 3; ++k)
                for (const SurfaceVertex &p : Verts(a))
                    way.Add(p.xyz, corners[std::size_t(corner[k])].xyz, corners[std::size_t(corner[(k + 1) % 3])].xyz);
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
    const ShortestWay way = GapFinder(in, surfaces).Between(a, b);
    if (way.distance2 <= kTouching * kTouching)
        return SurfaceGap::Touching;
    const Vec3f up = normal * kLift;
    return way.distance2 <= reach * reach && WayBetween(in.space, way.from + up, way.to + up) == Way::Blocked
               ? SurfaceGap::Wall
               : SurfaceGap::NoWall;
}

} // namespace q3
