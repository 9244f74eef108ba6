// GPL-2.0-or-later. What luxels show instead of light.
#include "q3map2/lightmap/direct/debug_view.h"

#include "common/debug_color.h"

#include <algorithm>

namespace q3 {

namespace {

/// A unit vector as a colour.
Vec3f VectorColor(const Vec3f &v) {
    return (v + Vec3f{1, 1, 1}) * 127.5f;
}

/// A place as a colour: its share of the way through the box.
Vec3f PlaceColor(const Vec3f &place, const Boundsf &box) {
    Vec3f color;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float size = box.maxs[axis] - box.mins[axis];
        color[axis] = size > 0 ? 255 * std::clamp((place[axis] - box.mins[axis]) / size, 0.0f, 1.0f) : 0;
    }
    return color;
}

} // namespace

void DrawDebugView(DebugView show, RawLightmap &lightmap) {
    for (std::size_t i = 0; i < lightmap.luxelClusters.size(); ++i) {
        if (!lightmap.Mapped(i))
            continue;
        Vec3f &color = lightmap.light[0][i];
        switch (show) {
        case DebugView::Light:
            break;
        case DebugView::Surfaces:
            color = DebugColor(lightmap.surfaces.empty() ? 0 : lightmap.surfaces.front());
            break;
        case DebugView::Axis:
            color = VectorColor(lightmap.axis);
            break;
        case DebugView::Cluster:
            color = DebugColor(lightmap.luxelClusters[i]);
            break;
        case DebugView::Origin:
            color = PlaceColor(lightmap.positions[i], lightmap.bounds);
            break;
        case DebugView::Dirt: // FinishLuxels multiplies by it
            color = {255, 255, 255};
            break;
        case DebugView::NormalMap:
            color = VectorColor(lightmap.normals[i]);
            break;
        }
    }
}

} // namespace q3
