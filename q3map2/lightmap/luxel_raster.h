// GPL-2.0-or-later. Samples of triangles and quads no farther apart than a threshold in luxels.
#pragma once

#include "q3map2/light/light_patch.h"
#include "q3map2/lightmap/lightmaps.h"

namespace q3 {

/// Edges whose ends differ by less along an axis of the lightmap get samples of their own. Luxels.
inline constexpr float kThinEdge = 0.01f;

inline float LuxelDistance2(const SurfaceVertex &a, const SurfaceVertex &b) {
    const float s = a.luxel[0] - b.luxel[0], t = a.luxel[1] - b.luxel[1];
    return s * s + t * t;
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

/// Halves the longest edge until none is longer than the root of `threshold2` (above 0); sample(vertex) gets each
/// point made on the way.
template <bool kFlat, typename Sample>
void SubdivideTriangle(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c, float threshold2,
                       const Sample &sample) {
    const float ab = LuxelDistance2(a, b), bc = LuxelDistance2(b, c), ca = LuxelDistance2(c, a);
    const float longest = std::max(ab, std::max(bc, ca));
    if (!(longest > threshold2))
        return;
    if (ab == longest) {
        const SurfaceVertex m = Between<kFlat>(a, b);
        sample(m);
        SubdivideTriangle<kFlat>(m, b, c, threshold2, sample);
        SubdivideTriangle<kFlat>(a, m, c, threshold2, sample);
    } else if (bc == longest) {
        const SurfaceVertex m = Between<kFlat>(b, c);
        sample(m);
        SubdivideTriangle<kFlat>(a, m, c, threshold2, sample);
        SubdivideTriangle<kFlat>(a, b, m, threshold2, sample);
    } else {
        const SurfaceVertex m = Between<kFlat>(c, a);
        sample(m);
        SubdivideTriangle<kFlat>(a, b, m, threshold2, sample);
        SubdivideTriangle<kFlat>(m, b, c, threshold2, sample);
    }
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

/// Samples along the edges of the triangle that run along an axis of the lightmap.
template <bool kFlat, typename Sample>
void SampleThinEdges(const std::array<SurfaceVertex, 3> &triangle, float threshold2, const Sample &sample) {
    for (std::size_t i = 0; i < 3; ++i) {
        const SurfaceVertex &p = triangle[i], &q = triangle[(i + 1) % 3];
        if (std::abs(p.luxel[0] - q.luxel[0]) < kThinEdge || std::abs(p.luxel[1] - q.luxel[1]) < kThinEdge)
            SubdivideTriangle<kFlat>(p, q, q, threshold2, sample);
    }
}

} // namespace q3
