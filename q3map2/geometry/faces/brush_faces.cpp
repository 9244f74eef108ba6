// GPL-2.0-or-later. Draw surfaces of brush sides.
#include "q3map2/geometry/faces/brush_faces.h"

#include <cmath>
#include <utility>

namespace q3 {
namespace {

float Snapped(float coordinate, bool snap) {
    return snap ? float(std::floor(8.0 * double(coordinate) + 0.5) / 8) : coordinate;
}

/// Computed in float like the established program, so that coordinates at a whole number round as they do there.
std::array<float, 2> TextureCoordinates(const BrushSide &side, const Vec3f &p) {
    std::array<float, 2> st{};
    for (std::size_t i = 0; i < 2; ++i) {
        const std::array<double, 4> &v = side.texture.vecs[i];
        st[i] = float(v[0]) * p.x + float(v[1]) * p.y + float(v[2]) * p.z + float(v[3]);
    }
    return st;
}

/// Texture coordinates of all vertices under -flat: the last texel of the image.
std::array<float, 2> FlatCoordinates(const ShaderInfo &shader) {
    return {1 - 1 / float(shader.geometry.textureWidth), 1 - 1 / float(shader.geometry.textureHeight)};
}

/// Whether `w` is the back face of a fog brush side. Fog brushes get back faces because they are seen from inside too.
bool IsBackFace(const BrushSide &side, const Polygon &w, const PlaneTable &planes) {
    return (side.shader->compileFlags & C_FOG) != 0 && Dot(WindingAreaVector(w), planes[side.planeNum].normal) > 0;
}

bool MakesSurface(const BrushSide &side) {
    if (side.shader == nullptr || side.culled || side.visibleHull.size() < 3)
        return false;
    const ShaderInfo &shader = *side.shader;
    return (shader.compileFlags & C_NODRAW) == 0 || shader.geometry.indexed || (shader.compileFlags & C_FOG) != 0;
}

} // namespace

int MakeFaceSurface(const MapEntity &entity, int brush, int side, const Polygon &w, Geometry &geometry,
                    const PlaneTable &planes, const BspContext &context) {
    const Brush &solid = entity.brushes[std::size_t(brush)];
    const BrushSide &from = solid.sides[std::size_t(side)];
    DrawSurface surface;
    surface.kind = SurfaceKind::Face;
    surface.shader = from.shader;
    surface.settings = solid.settings;
    surface.brush = brush, surface.side = side, surface.primitive = solid.primitive;
    surface.planeNum = IsBackFace(from, w, planes) ? from.planeNum ^ 1 : from.planeNum;
    surface.planar = true;
    const Vec3f normal(planes[surface.planeNum].normal);
    for (const Vec3f &p : w) {
        DrawVert vert;
        for (std::size_t i = 0; i < 3; ++i)
            vert.xyz[i] = Snapped(p[i], context.options.snapVertices);
        vert.normal = normal;
        vert.st = context.options.flat ? FlatCoordinates(*from.shader)
                                       : TextureCoordinates(from, vert.xyz + solid.textureOrigin);
        surface.bounds.Add(vert.xyz);
        surface.verts.push_back(vert);
    }
    geometry.surfaces.push_back(std::move(surface));
    return int(geometry.surfaces.size()) - 1;
}

void MakeFaceSurfaces(MapEntity &entity, Geometry &geometry, const PlaneTable &planes, const BspContext &context,
                      const SideParts &parts) {
    for (std::size_t b = 0; b < entity.brushes.size(); ++b)
        for (std::size_t s = 0; s < entity.brushes[b].sides.size(); ++s) {
            BrushSide &side = entity.brushes[b].sides[s];
            if (!MakesSurface(side))
                continue;
            const bool whole = side.shader->autosprite || side.shader->geometry.noClip;
            if (const auto found = parts.find(&side); !whole && found != parts.end()) {
                for (const Polygon &part : found->second)
                    side.surface = MakeFaceSurface(entity, int(b), int(s), part, geometry, planes, context);
                continue;
            }
            const Polygon &w = whole ? side.winding : side.visibleHull;
            side.surface = MakeFaceSurface(entity, int(b), int(s), w, geometry, planes, context);
            if ((side.shader->compileFlags & C_FOG) != 0)
                side.surface = MakeFaceSurface(entity, int(b), int(s), Reversed(w), geometry, planes, context);
        }
}

} // namespace q3
