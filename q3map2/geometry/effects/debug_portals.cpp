// GPL-2.0-or-later. Portals as visible surfaces.
#include "q3map2/geometry/effects/debug_portals.h"

#include "common/debug_color.h"
#include "q3map2/tree/portals.h"

#include <vector>

namespace q3 {
namespace {

constexpr std::uint8_t kPortalAlpha = 32;

/// Triangle fan around the first point.
std::vector<int> FanIndexes(std::size_t points) {
    std::vector<int> indexes;
    for (int i = 2; i < int(points); ++i)
        indexes.insert(indexes.end(), {0, i - 1, i});
    return indexes;
}

} // namespace

void MakePortalSurfaces(const Tree &tree, Geometry &geometry, const BspContext &context) {
    const ShaderInfo &shader = context.shaders.Get("debugportals");
    std::size_t number = 0;
    for (const TreePortal &portal : tree.portals) {
        if (portal.polygon.size() < 3 || !IsPassable(tree, portal))
            continue;
        const auto color = DebugColorBytes(number++);
        DrawSurface surface;
        surface.kind = SurfaceKind::Triangles;
        surface.shader = &shader;
        for (const Vec3f &point : portal.polygon) {
            DrawVert vert;
            vert.xyz = point;
            vert.normal = Vec3f(portal.plane.normal);
            vert.color = {color[0], color[1], color[2], kPortalAlpha};
            surface.bounds.Add(point);
            surface.verts.push_back(vert);
        }
        surface.indexes = FanIndexes(surface.verts.size());
        geometry.surfaces.push_back(std::move(surface));
    }
}

} // namespace q3
