// GPL-2.0-or-later. What a surface covers: its faces, the luxels under them, the gaps and clusters around it.
#pragma once

#include "libs/math/vec.h"
#include "libs/math/winding.h"
#include "q3map2/light/scene/light_space.h"
#include "q3map2/light/scene/surface_table.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <vector>

namespace q3 {

// ---- Faces that a surface is drawn as ----

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

// ---- Clusters that see a surface ----

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

// ---- Projection of luxels ----

/// World axes (0 x, 1 y, 2 z) of a projected raw lightmap: u to the next column, v to the next row, `along` projection.
struct LuxelAxes {
    std::size_t u = 0, v = 1, along = 2;
};

/// Projection along the largest component of `axis`; ties prefer z, then x.
inline LuxelAxes AxesOf(const Vec3f &axis) {
    const float x = std::abs(axis.x), y = std::abs(axis.y), z = std::abs(axis.z);
    if (z >= x && z >= y)
        return {0, 1, 2};
    return x >= y ? LuxelAxes{1, 2, 0} : LuxelAxes{0, 2, 1};
}

/// p projected along a world axis onto the plane normal . p = dist; normal[along] is not zero.
inline Vec3f OntoPlane(Vec3f p, std::size_t along, const Vec3f &normal, float dist) {
    p[along] -= (Dot(normal, p) - dist) / normal[along];
    return p;
}

// ---- Luxels that a surface covers: by subdivision into samples at most a threshold apart, or row by row ----

/// Edges along an axis of the lightmap (ends differ by less on the other axis) are sampled too: subdividing the
/// triangle may skip luxels along them. Luxels.
inline constexpr float kAxisEdge = 0.01f;

/// Squared distance of two vertices in the lightmap. Square luxels.
inline float LuxelDistance2(const SurfaceVertex &a, const SurfaceVertex &b) {
    const float s = a.luxel[0] - b.luxel[0], t = a.luxel[1] - b.luxel[1];
    return s * s + t * t;
}

/// The midpoint of an edge. kOneNormal: the normals of its ends are equal, and taken as they are.
template <bool kOneNormal> SurfaceVertex Midpoint(const SurfaceVertex &a, const SurfaceVertex &b) {
    if constexpr (kOneNormal) {
        SurfaceVertex middle;
        middle.xyz = (a.xyz + b.xyz) * 0.5f;
        middle.normal = a.normal;
        for (std::size_t i = 0; i < 2; ++i) {
            middle.st[i] = (a.st[i] + b.st[i]) * 0.5f;
            middle.luxel[i] = (a.luxel[i] + b.luxel[i]) * 0.5f;
        }
        return middle;
    } else
        return HalfwayVert(a, b);
}

/// SubdivideTriangle with the squared edge lengths ab, bc, ca, the longest of which is above the threshold.
template <bool kOneNormal, typename Sample>
void SubdivideEdges(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c, float ab, float bc,
                    float ca, float threshold2, const Sample &sample) {
    // Tested before the call: more than half of all calls would return at once.
    const auto halve = [&](const SurfaceVertex &p, const SurfaceVertex &q, const SurfaceVertex &r, float pq, float qr,
                           float rp) {
        if (std::max(pq, std::max(qr, rp)) > threshold2)
            SubdivideEdges<kOneNormal>(p, q, r, pq, qr, rp, threshold2, sample);
    };
    const float longest = std::max(ab, std::max(bc, ca));
    if (ab == longest) {
        const SurfaceVertex m = Midpoint<kOneNormal>(a, b);
        sample(m);
        const float am = LuxelDistance2(a, m), mb = LuxelDistance2(m, b), mc = LuxelDistance2(m, c);
        halve(m, b, c, mb, bc, mc);
        halve(a, m, c, am, mc, ca);
    } else if (bc == longest) {
        const SurfaceVertex m = Midpoint<kOneNormal>(b, c);
        sample(m);
        const float bm = LuxelDistance2(b, m), mc = LuxelDistance2(m, c), ma = LuxelDistance2(m, a);
        halve(a, m, c, ma, mc, ca);
        halve(a, b, m, ab, bm, ma);
    } else {
        const SurfaceVertex m = Midpoint<kOneNormal>(c, a);
        sample(m);
        const float cm = LuxelDistance2(c, m), ma = LuxelDistance2(m, a), bm = LuxelDistance2(b, m);
        halve(a, b, m, ab, bm, ma);
        halve(m, b, c, bm, bc, cm);
    }
}

/// Halves the longest edge until none is longer than the root of `threshold2` (above 0); calls sample(vertex) for each
/// midpoint.
template <bool kOneNormal, typename Sample>
void SubdivideTriangle(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c, float threshold2,
                       const Sample &sample) {
    const float ab = LuxelDistance2(a, b), bc = LuxelDistance2(b, c), ca = LuxelDistance2(c, a);
    if (std::max(ab, std::max(bc, ca)) > threshold2)
        SubdivideEdges<kOneNormal>(a, b, c, ab, bc, ca, threshold2, sample);
}

/// The same for a quad: halves the pair of opposite edges that holds the longest.
template <bool kOneNormal, typename Sample>
void SubdivideQuad(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c, const SurfaceVertex &d,
                   float threshold2, const Sample &sample) {
    const float abOrCd = std::max(LuxelDistance2(a, b), LuxelDistance2(c, d));
    const float bcOrDa = std::max(LuxelDistance2(b, c), LuxelDistance2(d, a));
    if (!(std::max(abOrCd, bcOrDa) > threshold2))
        return;
    const bool halvesAb = abOrCd >= bcOrDa;
    const SurfaceVertex m = halvesAb ? Midpoint<kOneNormal>(a, b) : Midpoint<kOneNormal>(b, c);
    const SurfaceVertex n = halvesAb ? Midpoint<kOneNormal>(c, d) : Midpoint<kOneNormal>(d, a);
    sample(m);
    sample(n);
    if (halvesAb) {
        SubdivideQuad<kOneNormal>(a, m, n, d, threshold2, sample);
        SubdivideQuad<kOneNormal>(m, b, c, n, threshold2, sample);
    } else {
        SubdivideQuad<kOneNormal>(a, b, m, n, threshold2, sample);
        SubdivideQuad<kOneNormal>(n, m, c, d, threshold2, sample);
    }
}

/// Luxel of a coordinate in a lightmap of that size; NaN gives 0. Limited as float: coordinates of broken maps may be
/// more than an int holds, and what the conversion gives then depends on the processor.
inline int LuxelOf(float coordinate, int size) {
    return coordinate > 0 ? int(std::min(coordinate, float(size - 1))) : 0;
}

/// Corners of a triangle in lightmap coordinates. Luxels.
using LuxelTriangle = std::array<std::array<float, 2>, 3>;

/// The point of the triangle nearest to p.
inline std::array<float, 2> NearestInside(const LuxelTriangle &triangle, const std::array<float, 2> &p) {
    std::array<float, 2> nearest = triangle[0];
    float least = std::numeric_limits<float>::infinity();
    int left = 0, right = 0; // edges that p is to the left, to the right of
    for (std::size_t i = 0; i < 3; ++i) {
        const auto &a = triangle[i], &b = triangle[(i + 1) % 3];
        const float ex = b[0] - a[0], ey = b[1] - a[1], px = p[0] - a[0], py = p[1] - a[1];
        const float side = ex * py - ey * px, length2 = ex * ex + ey * ey;
        left += side > 0, right += side < 0;
        const float along = length2 > 0 ? std::clamp((px * ex + py * ey) / length2, 0.0f, 1.0f) : 0;
        const std::array<float, 2> q{a[0] + ex * along, a[1] + ey * along};
        const float dx = p[0] - q[0], dy = p[1] - q[1];
        if (const float distance2 = dx * dx + dy * dy; distance2 < least)
            least = distance2, nearest = q;
    }
    return (left > 0) != (right > 0) ? p : nearest;
}

/// Whether p is in the triangle; points on its edges are.
inline bool Contains(const LuxelTriangle &triangle, const std::array<float, 2> &p) {
    return NearestInside(triangle, p) == p;
}

/// Whether the center of luxel (x, y) is in the triangle, or outside it by no more than rounding.
inline bool ContainsCenter(const LuxelTriangle &triangle, int x, int y) {
    constexpr float kRounding = 1.0f / 256; // luxels
    const std::array<float, 2> center{float(x) + 0.5f, float(y) + 0.5f}, nearest = NearestInside(triangle, center);
    return std::abs(nearest[0] - center[0]) < kRounding && std::abs(nearest[1] - center[1]) < kRounding;
}

/// Range of coordinates along an axis of the lightmap.
struct LuxelSpan {
    float from = std::numeric_limits<float>::infinity(), to = -from;
    void Add(float at) { from = std::min(from, at), to = std::max(to, at); }
};

/// Extent on the first axis of the part of a triangle that is between `top` and `bottom` on the second axis.
inline LuxelSpan SpanBetween(const LuxelTriangle &triangle, float top, float bottom) {
    LuxelSpan span;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto &p = triangle[i], &q = triangle[(i + 1) % 3];
        if (p[1] >= top && p[1] <= bottom)
            span.Add(p[0]);
        for (const float line : {top, bottom})
            if ((p[1] < line) != (q[1] < line))
                span.Add(p[0] + (q[0] - p[0]) * ((line - p[1]) / (q[1] - p[1])));
    }
    return span;
}

/// Calls luxel(x, y) for each luxel that the triangle touches.
template <typename Luxel>
void ForCoveredLuxels(const LuxelTriangle &triangle, int width, int height, const Luxel &luxel) {
    LuxelSpan tall;
    for (const auto &corner : triangle)
        tall.Add(corner[1]);
    for (int y = LuxelOf(tall.from, height), last = LuxelOf(tall.to, height); y <= last; ++y) {
        const LuxelSpan row = SpanBetween(triangle, float(y), float(y + 1));
        for (int x = LuxelOf(row.from, width), end = LuxelOf(row.to, width); x <= end; ++x)
            luxel(x, y);
    }
}

/// Mean of the corners of the triangle clipped to luxel (x, y), which it touches.
inline std::array<float, 2> ClippedCenter(const LuxelTriangle &triangle, int x, int y) {
    Winding<float> clipped, rest;
    for (const auto &corner : triangle)
        clipped.push_back({corner[0], corner[1], 0});
    WindingCutter<float> cutter;
    const auto cut = [&](const Vec3f &normal, float dist) {
        cutter.Classify(clipped, normal, dist, 0);
        cutter.Back(clipped, rest);
        if (rest.empty()) { // the triangle only touches the luxel, by an edge or a corner
            float least = std::numeric_limits<float>::infinity();
            for (const Vec3f &p : clipped)
                least = std::min(least, Dot(normal, p));
            std::copy_if(clipped.begin(), clipped.end(), std::back_inserter(rest),
                         [&](const Vec3f &p) { return Dot(normal, p) == least; });
        }
        clipped.swap(rest);
    };
    cut({1, 0, 0}, float(x + 1)), cut({-1, 0, 0}, float(-x));
    cut({0, 1, 0}, float(y + 1)), cut({0, -1, 0}, float(-y));
    Vec3f sum;
    for (const Vec3f &p : clipped)
        sum += p;
    return {sum.x / float(clipped.size()), sum.y / float(clipped.size())};
}

/// Calls edge(p, q) for the edges of the triangle that run along an axis of the lightmap.
template <typename Edge> void ForAxisEdges(const std::array<SurfaceVertex, 3> &triangle, const Edge &edge) {
    for (std::size_t i = 0; i < 3; ++i) {
        const SurfaceVertex &p = triangle[i], &q = triangle[(i + 1) % 3];
        if (std::abs(p.luxel[0] - q.luxel[0]) < kAxisEdge || std::abs(p.luxel[1] - q.luxel[1]) < kAxisEdge)
            edge(p, q);
    }
}

} // namespace q3
