// GPL-2.0-or-later. Where the vertices of surfaces without lightmaps receive bounced light.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>

namespace q3 {

/// Vertices gather at points moved this far (at most a quarter of the way) toward the center of their surface, since
/// the edge of a surface often lies in the plane of another. Not along the normal: the center of a closed model lies
/// inside it. Game units.
inline constexpr float kInward = 2;

/// Whether the surface is lit at its vertices.
inline bool IsLitAtVertices(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t surface) {
    return surfaces.lightmapOf[surface] < 0 && !in.table[surface].shader->lightmap.noVertexLight;
}

/// Calls use(vertex, position to gather at) for the draw vertices of a surface.
template <typename Use>
void ForVertexReceivers(const SurfaceInputs &in, const SurfaceLight &surfaces, std::size_t number, const Use &use) {
    const bspDrawSurface_t &surface = in.bsp.drawSurfaces[number];
    Vec3f center;
    for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v)
        center += surfaces.verts[std::size_t(v)].xyz / float(surface.numVerts);
    for (int v = surface.firstVert; v < surface.firstVert + surface.numVerts; ++v) {
        const auto &[at, normal, st, luxel] = surfaces.verts[std::size_t(v)];
        const Vec3f way = center - at, inward = way - normal * Dot(way, normal);
        use(v, at + inward * std::min(0.25f, kInward / std::max(1.0f, Length(inward))));
    }
}

} // namespace q3
