// GPL-2.0-or-later. The triangles and quads that a surface is drawn as.
#include "q3map2/lightmap/raw/surface_faces.h"

#include "q3map2/light/scene/light_patch.h"

#include <algorithm>

namespace q3 {

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

} // namespace q3
