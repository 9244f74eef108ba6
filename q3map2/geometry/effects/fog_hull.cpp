// GPL-2.0-or-later. The fog hull: a box around the map (world key _foghull).
#include "q3map2/geometry/effects/fog_hull.h"

#include "q3map2/bspfile/surface_keys.h"

#include <array>
#include <string>

namespace q3 {
namespace {

constexpr float kFogHullDistance = 128; ///< between the map and the box, game units

} // namespace

void MakeFogHull(const Map &map, Geometry &geometry, const BspContext &context) {
    const std::string_view name = keys::kFogHull.Text(map.entities.front().pairs);
    if (name.empty())
        return;
    Boundsf bounds;
    for (const Brush &brush : map.entities.front().brushes)
        bounds.Add(brush.bounds);
    if (bounds.Empty())
        return;
    DrawSurface hull;
    hull.kind = SurfaceKind::FogHull;
    hull.shader = &context.shaders.Get("textures/" + std::string(name));
    hull.fogNum = geometry.defaultFog;
    const Vec3f border{kFogHullDistance, kFogHullDistance, kFogHullDistance};
    const std::array<Vec3f, 2> corners{bounds.mins - border, bounds.maxs + border};
    const Vec3f center = bounds.Center();
    for (std::size_t i = 0; i < 8; ++i) {
        DrawVert vert;
        vert.xyz = {corners[i & 1].x, corners[i >> 1 & 1].y, corners[i >> 2 & 1].z};
        vert.normal = Normalize(center - vert.xyz);
        hull.bounds.Add(vert.xyz);
        hull.verts.push_back(vert);
    }
    hull.indexes = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    geometry.surfaces.push_back(std::move(hull));
}

} // namespace q3
