// GPL-2.0-or-later. Fur: copies of a surface stacked along its normals.
#include "q3map2/geometry/effects/fur.h"

#include <algorithm>

namespace q3 {
namespace {

constexpr int kMaxLayers = 256;

/// Moves each vertex along its normal by `distance` times its alpha.
void MoveAlongNormals(DrawSurface &surface, float distance) {
    for (DrawVert &vert : surface.verts)
        vert.xyz += vert.normal * (distance * float(vert.color[3]) / 255);
}

} // namespace

void MakeFur(std::size_t surface, Geometry &geometry) {
    DrawSurface &base = geometry.surfaces[surface];
    if (base.furred || base.shader == nullptr || base.Empty() || base.shader->geometry.fur.layers <= 0)
        return;
    const FurDirective fur = base.shader->geometry.fur;
    base.furred = true;
    MoveAlongNormals(base, fur.offset);
    const DrawSurface lowest = base; // a copy: appending invalidates references
    for (int layer = 1; layer < std::min(fur.layers, kMaxLayers); ++layer) {
        DrawSurface copy = lowest;
        copy.isCopy = true;
        MoveAlongNormals(copy, fur.offset * float(layer));
        for (DrawVert &vert : copy.verts)
            vert.color[3] = std::uint8_t(std::clamp(float(vert.color[3]) - fur.fade * 255, 0.f, 255.f));
        geometry.surfaces.push_back(std::move(copy));
    }
}

} // namespace q3
