// GPL-2.0-or-later. Hash of what reference light depends on.
#include "tools/measure/shbench/map_hash.h"

namespace q3::bench {

void AddGeometry(Hash &hash, const Bsp &bsp) {
    hash.Value(std::string_view(bsp.entities));
    hash.Records(bsp.shaders), hash.Records(bsp.planes), hash.Records(bsp.nodes), hash.Records(bsp.leafs);
    hash.Records(bsp.leafSurfaces), hash.Records(bsp.leafBrushes), hash.Records(bsp.models);
    hash.Records(bsp.brushes), hash.Records(bsp.brushSides);
    hash.Records(bsp.drawVerts), hash.Records(bsp.drawIndexes), hash.Records(bsp.drawSurfaces);
    hash.Records(bsp.visibility);
}

void AddSurfaces(Hash &hash, const SurfaceTable &table) {
    hash.Value(table.size());
    for (const SurfaceEntry &entry : table) {
        hash.Value(entry.origin), hash.Value(entry.castShadows), hash.Value(entry.longestCurve);
        hash.Value(entry.skyBoxCopy), hash.Value(entry.skyIndex), hash.Value(entry.shader->compileFlags);
        if ((entry.shader->compileFlags & (C_ALPHASHADOW | C_LIGHTFILTER)) == 0 || !entry.shader->lightImage)
            continue;
        hash.Value(entry.shader->imageFound), hash.Value(entry.shader->lightImage->width);
        hash.Records(entry.shader->lightImage->rgba);
    }
}

void AddLight(Hash &hash, const Light &light) {
    hash.Value(light.type), hash.Value(light.curve), hash.Value(light.twoSided), hash.Value(light.negative);
    hash.Value(light.color), hash.Value(light.photons), hash.Value(light.radiosity);
    hash.Value(light.origin), hash.Value(light.normal), hash.Value(light.fade), hash.Value(light.radiusByDist);
    const Attenuation &k = light.attenuation;
    hash.Value(k.constant), hash.Value(k.linear), hash.Value(k.quadratic);
    hash.Value(k.flatFrom), hash.Value(k.fadeFrom), hash.Value(k.end);
    hash.Value(light.cone.byAngles), hash.Value(light.cone.cosInner), hash.Value(light.cone.cosOuter);
    hash.Value(light.cone.exponent);
    hash.Value(light.extraDist), hash.Value(light.skyIndex), hash.Value(light.polygon.size());
    for (const Vec3f &corner : light.polygon)
        hash.Value(corner);
}

} // namespace q3::bench
