// GPL-2.0-or-later. Debug views: luxels show something other than light.
#include "q3map2/lightmap/direct/debug_view.h"

#include "common/debug_color.h"
#include "q3map2/lightmap/raw/vector_colors.h"

namespace q3 {

void DrawDebugView(DebugView view, RawLightmap &lightmap) {
    for (std::size_t i = 0; i < lightmap.luxelClusters.size(); ++i) {
        if (!lightmap.Mapped(i))
            continue;
        Vec3f &color = lightmap.light[0][i];
        switch (view) {
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
            color = PositionColor(lightmap.positions[i], lightmap.bounds);
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
