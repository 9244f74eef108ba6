// GPL-2.0-or-later. Draw surfaces that show internal polygons of the compiler (-debugportals, -debugclip).
#include "q3map2/geometry/surface/debug_surface.h"

#include "common/debug_color.h"

namespace q3 {

namespace {
constexpr std::uint8_t kDebugAlpha = 32;
}

DrawSurface DebugSurface(const Polygon &polygon, const Vec3f &normal, const ShaderInfo &shader, std::size_t number) {
    const auto color = DebugColorBytes(number);
    DrawSurface surface;
    surface.kind = SurfaceKind::Triangles;
    surface.shader = &shader;
    for (const Vec3f &point : polygon) {
        DrawVert vert;
        vert.xyz = point;
        vert.normal = normal;
        vert.color = {color[0], color[1], color[2], kDebugAlpha};
        surface.bounds.Add(point);
        surface.verts.push_back(vert);
    }
    for (int i = 2; i < int(polygon.size()); ++i) // a fan around the first point
        surface.indexes.insert(surface.indexes.end(), {0, i - 1, i});
    return surface;
}

} // namespace q3
