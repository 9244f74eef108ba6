// GPL-2.0-or-later. Patches of a .bsp as meshes.
#include "q3map2/light/scene/light_patch.h"

#include <algorithm>
#include <utility>

namespace q3 {

Mesh TessellatePatch(const Bsp &bsp, const bspDrawSurface_t &surface, float longestCurve) {
    Mesh mesh{surface.patchWidth, surface.patchHeight, {}};
    for (int i = 0; i < surface.numVerts; ++i) {
        const bspDrawVert_t &v = bsp.drawVerts[std::size_t(surface.firstVert + i)];
        mesh.verts.push_back({Vec3f(v.xyz), Vec3f(v.normal), v.st});
    }
    return Tessellated(std::move(mesh), longestCurve);
}

float LongestCurve(const Bsp &bsp, const bspDrawSurface_t &surface) {
    const auto control = [&](int x, int y) {
        return Vec3f(bsp.drawVerts[std::size_t(surface.firstVert + y * surface.patchWidth + x)].xyz);
    };
    float longest = 0;
    for (int y = 0; y + 2 < surface.patchHeight; y += 2)
        for (int x = 0; x + 2 < surface.patchWidth; x += 2) {
            longest = std::max(longest, CurveLength(control(x, y), control(x + 1, y), control(x + 2, y)));
            longest = std::max(longest, CurveLength(control(x, y), control(x, y + 1), control(x, y + 2)));
        }
    return longest;
}

} // namespace q3
