// GPL-2.0-or-later. Makes portals visible as surfaces (-debugportals).
#include "q3map2/geometry/effects/debug_portals.h"

#include "q3map2/geometry/surface/debug_surface.h"
#include "q3map2/tree/portals.h"

namespace q3 {

void MakePortalSurfaces(const Tree &tree, Geometry &geometry, const BspContext &context) {
    const ShaderInfo &shader = context.shaders.Get("debugportals");
    std::size_t number = 0;
    for (const TreePortal &portal : tree.portals)
        if (portal.polygon.size() >= 3 && IsPassable(tree, portal))
            geometry.surfaces.push_back(DebugSurface(portal.polygon, Vec3f(portal.plane.normal), shader, number++));
}

} // namespace q3
