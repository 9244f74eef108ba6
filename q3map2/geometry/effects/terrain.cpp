// GPL-2.0-or-later. Terrain from index maps: layers at the vertices set shader, alpha and height.
#include "q3map2/geometry/effects/terrain.h"

#include "q3map2/map/index_map.h"

#include <algorithm>
#include <cmath>

namespace q3 {
namespace {

/// Copy of `layer` in which unset properties come from the indexed shader.
ShaderInfo Inherited(const ShaderInfo &layer, const ShaderInfo &indexed) {
    ShaderInfo shader = layer;
    GeometryDirectives &own = shader.geometry;
    const GeometryDirectives &base = indexed.geometry;
    own.globalTexture |= base.globalTexture;
    own.forceMeta |= base.forceMeta;
    own.nonPlanar |= base.nonPlanar;
    if (shader.lightmap.shadeAngle == 0)
        shader.lightmap.shadeAngle = indexed.lightmap.shadeAngle;
    if (shader.lightmap.axis == Vec3f{})
        shader.lightmap.axis = indexed.lightmap.axis;
    if (!own.hasTexGen && base.hasTexGen) {
        own.hasTexGen = true;
        own.texGen = base.texGen;
    }
    return shader;
}

bool SameInheritance(const ShaderInfo &a, const ShaderInfo &b) {
    return a.name == b.name && a.geometry.globalTexture == b.geometry.globalTexture &&
           a.geometry.forceMeta == b.geometry.forceMeta && a.geometry.nonPlanar == b.geometry.nonPlanar &&
           a.lightmap.shadeAngle == b.lightmap.shadeAngle && a.lightmap.axis == b.lightmap.axis &&
           a.geometry.hasTexGen == b.geometry.hasTexGen && a.geometry.texGen == b.geometry.texGen;
}

const ShaderInfo *LayerShader(const IndexMap &map, int low, int high, const ShaderInfo &indexed, Geometry &geometry,
                              const BspContext &context) {
    const std::string name = low == high ? fmt::format("textures/{}_{}", map.shader, high)
                                         : fmt::format("textures/{}_{}to{}", map.shader, low, high);
    const ShaderInfo &layer = context.shaders.Get(name);
    ShaderInfo wanted = Inherited(layer, indexed);
    if (SameInheritance(layer, wanted))
        return &layer;
    for (const ShaderInfo &shader : geometry.ownShaders)
        if (SameInheritance(shader, wanted))
            return &shader;
    geometry.ownShaders.push_back(std::move(wanted));
    return &geometry.ownShaders.back();
}

void ApplyTo(DrawSurface &surface, const IndexMap &map, Geometry &geometry, const BspContext &context) {
    std::vector<int> layers;
    for (const DrawVert &vert : surface.verts)
        layers.push_back(map.LayerAt(vert.xyz));
    const auto [low, high] = std::minmax_element(layers.begin(), layers.end());
    surface.shader = LayerShader(map, *low, *high, *surface.shader, geometry, context);
    surface.bounds = {};
    for (std::size_t i = 0; i < surface.verts.size(); ++i) {
        DrawVert &vert = surface.verts[i];
        const float z = vert.xyz.z + map.OffsetOf(layers[i]);
        const bool snap = context.options.snapVertices && surface.kind == SurfaceKind::Face;
        vert.xyz.z = snap ? std::floor(z * 8 + 0.5f) / 8 : z;
        vert.color = {255, 255, 255, std::uint8_t(layers[i] == *high ? 255 : 0)};
        if (surface.shader->geometry.hasTexGen)
            for (std::size_t axis = 0; axis < 2; ++axis)
                vert.st[axis] = Dot(surface.shader->geometry.texGen[axis], vert.xyz);
        surface.bounds.Add(vert.xyz);
    }
}

} // namespace

void ApplyIndexedTerrain(const MapEntity &, Geometry &geometry, std::size_t first, const BspContext &context) {
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i) {
        DrawSurface &surface = geometry.surfaces[i];
        const bool fits = surface.kind == SurfaceKind::Face || surface.kind == SurfaceKind::Patch;
        if (fits && surface.shader != nullptr && surface.shader->geometry.indexed && surface.settings.indexMap &&
            !surface.Empty())
            ApplyTo(surface, *surface.settings.indexMap, geometry, context);
    }
}

} // namespace q3
