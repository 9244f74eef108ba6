// GPL-2.0-or-later. Samples of triangles and quads no farther apart than a threshold in luxels.
#pragma once

#include "q3map2/light/light_patch.h"
#include "q3map2/lightmap/lightmaps.h"

namespace q3 {

/// Edges whose ends differ by less along an axis of the lightmap get samples of their own. Luxels.
inline constexpr float kThinEdge = 0.01f;

/// What tells apart samples of a triangle where all normals are the same and no image bends them.
struct LuxelVertex {
    using Pair = float __attribute__((vector_size(2 * sizeof(float)))); ///< one operation for both
    Pair luxel{};
};

inline float LuxelDistance2(const SurfaceVertex &a, const SurfaceVertex &b) {
    const float s = a.luxel[0] - b.luxel[0], t = a.luxel[1] - b.luxel[1];
    return s * s + t * t;
}
inline float LuxelDistance2(LuxelVertex a, LuxelVertex b) {
    const LuxelVertex::Pair way = a.luxel - b.luxel, squares = way * way;
    return squares[0] + squares[1];
}

/// The vertex between two whose normals are equal, if kFlat: the normal is not made a unit vector anew.
template <bool kFlat> SurfaceVertex Between(const SurfaceVertex &a, const SurfaceVertex &b) {
    if constexpr (kFlat) {
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

template <bool kFlat> LuxelVertex Between(const LuxelVertex &a, const LuxelVertex &b) {
    return {(a.luxel + b.luxel) * 0.5f};
}

/// How vertices are handed down: in registers if they fit.
template <typename Vertex>
using PassVertex = std::conditional_t<sizeof(Vertex) <= 2 * sizeof(float), Vertex, const Vertex &>;

/// SubdivideTriangle, the squared lengths of whose edges are known; the longest of them is above the threshold.
template <bool kFlat, typename Vertex, typename Sample>
void SubdivideEdges(PassVertex<Vertex> a, PassVertex<Vertex> b, PassVertex<Vertex> c, float ab, float bc, float ca,
                    float threshold2, const Sample &sample) {
    // Asked before the call: more than half of all triangles are the last.
    const auto halve = [&](PassVertex<Vertex> p, PassVertex<Vertex> q, PassVertex<Vertex> r, float pq, float qr,
                           float rp) {
        if (std::max(pq, std::max(qr, rp)) > threshold2)
            SubdivideEdges<kFlat, Vertex>(p, q, r, pq, qr, rp, threshold2, sample);
    };
    const float longest = std::max(ab, std::max(bc, ca));
    if (ab == longest) {
        const Vertex m = Between<kFlat>(a, b);
        sample(m);
        const float am = LuxelDistance2(a, m), mb = LuxelDistance2(m, b), mc = LuxelDistance2(m, c);
        halve(m, b, c, mb, bc, mc);
        halve(a, m, c, am, mc, ca);
    } else if (bc == longest) {
        const Vertex m = Between<kFlat>(b, c);
        sample(m);
        const float bm = LuxelDistance2(b, m), mc = LuxelDistance2(m, c), ma = LuxelDistance2(m, a);
        halve(a, m, c, ma, mc, ca);
        halve(a, b, m, ab, bm, ma);
    } else {
        const Vertex m = Between<kFlat>(c, a);
        sample(m);
        const float cm = LuxelDistance2(c, m), ma = LuxelDistance2(m, a), bm = LuxelDistance2(b, m);
        halve(a, b, m, ab, bm, ma);
        halve(m, b, c, bm, bc, cm);
    }
}

/// Halves the longest edge until none is longer than the root of `threshold2` (above 0); sample(vertex) gets each
/// point made on the way.
template <bool kFlat, typename Vertex, typename Sample>
void SubdivideTriangle(const Vertex &a, const Vertex &b, const Vertex &c, float threshold2, const Sample &sample) {
    const float ab = LuxelDistance2(a, b), bc = LuxelDistance2(b, c), ca = LuxelDistance2(c, a);
    if (std::max(ab, std::max(bc, ca)) > threshold2)
        SubdivideEdges<kFlat, Vertex>(a, b, c, ab, bc, ca, threshold2, sample);
}

/// The points that SubdivideTriangle makes of p, q, q, in the same order, but each once.
template <typename Sample> void SubdivideEdge(LuxelVertex p, LuxelVertex q, float threshold2, const Sample &sample) {
    if (!(LuxelDistance2(p, q) > threshold2))
        return;
    const LuxelVertex m = Between<true>(p, q);
    sample(m);
    SubdivideEdge(m, q, threshold2, sample);
    SubdivideEdge(p, m, threshold2, sample);
}

/// The same for a quad: halves the pair of opposite edges that holds the longest.
template <bool kFlat, typename Sample>
void SubdivideQuad(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c, const SurfaceVertex &d,
                   float threshold2, const Sample &sample) {
    const float even = std::max(LuxelDistance2(a, b), LuxelDistance2(c, d));
    const float odd = std::max(LuxelDistance2(b, c), LuxelDistance2(d, a));
    if (!(std::max(even, odd) > threshold2))
        return;
    const bool first = even >= odd;
    const SurfaceVertex m = first ? Between<kFlat>(a, b) : Between<kFlat>(b, c);
    const SurfaceVertex n = first ? Between<kFlat>(c, d) : Between<kFlat>(d, a);
    sample(m);
    sample(n);
    if (first) {
        SubdivideQuad<kFlat>(a, m, n, d, threshold2, sample);
        SubdivideQuad<kFlat>(m, b, c, n, threshold2, sample);
    } else {
        SubdivideQuad<kFlat>(a, b, m, n, threshold2, sample);
        SubdivideQuad<kFlat>(n, m, c, d, threshold2, sample);
    }
}

/// Calls edge(p, q) for the edges of the triangle that run along an axis of the lightmap.
template <typename Vertex, typename Edge> void ForThinEdges(const std::array<Vertex, 3> &triangle, const Edge &edge) {
    for (std::size_t i = 0; i < 3; ++i) {
        const Vertex &p = triangle[i], &q = triangle[(i + 1) % 3];
        if (std::abs(p.luxel[0] - q.luxel[0]) < kThinEdge || std::abs(p.luxel[1] - q.luxel[1]) < kThinEdge)
            edge(p, q);
    }
}

} // namespace q3
