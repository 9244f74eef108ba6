// GPL-2.0-or-later. Draw surfaces of patches, and patches that are drawn as triangles.
#include "q3map2/geometry/faces/patch_surfaces.h"

#include "q3map2/map/map_patch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {

// ---- Draw surfaces of patches ----

namespace {

constexpr double kEqualEpsilon = 0.001; ///< game units, and components of normals

bool AreEqual(const Vec3f &a, const Vec3f &b) {
    const Vec3d d = Vec3d(a) - Vec3d(b);
    return std::abs(d.x) <= kEqualEpsilon && std::abs(d.y) <= kEqualEpsilon && std::abs(d.z) <= kEqualEpsilon;
}

/// Gives a flat patch a plane number, and the plane's normal at all vertices.
void FlattenPatch(DrawSurface &surface, PlaneTable &planes) {
    const DrawVert &first = surface.verts.front();
    const Vec3d normal(first.normal), origin(first.xyz);
    surface.planar = std::ranges::all_of(surface.verts, [&](const DrawVert &v) {
        return AreEqual(v.normal, first.normal) && std::abs(Dot(Vec3d(v.xyz) - origin, normal)) <= kEqualEpsilon;
    });
    if (!surface.planar)
        return;
    const std::array<Vec3d, 1> point{origin};
    surface.planeNum = planes.Find(normal, Dot(normal, origin), point);
    surface.planar = surface.planeNum >= 0;
    if (!surface.planar)
        return;
    surface.lightmapVecs[2] = Vec3f(planes[surface.planeNum].normal);
    for (DrawVert &v : surface.verts)
        v.normal = surface.lightmapVecs[2];
}

/// offset: from vertices to where they are in the map source, as for faces of brushes.
void SetTextureCoordinates(DrawSurface &surface, const Vec3f &offset, const BspOptions &options) {
    const GeometryDirectives &shader = surface.shader->geometry;
    for (DrawVert &v : surface.verts) {
        if (shader.hasTexGen)
            v.st = {Dot(shader.texGen[0], v.xyz + offset), Dot(shader.texGen[1], v.xyz + offset)};
        if (options.flat)
            v.st = {1 - 1 / float(shader.textureWidth), 1 - 1 / float(shader.textureHeight)};
    }
}

} // namespace

void MakePatchSurfaces(MapEntity &entity, Geometry &geometry, PlaneTable &planes, const BspContext &context) {
    for (std::size_t i = 0; i < entity.patches.size(); ++i) {
        Patch &patch = entity.patches[i];
        if (patch.verts.empty())
            continue;
        SetPatchNormals(patch);
        DrawSurface surface;
        surface.kind = SurfaceKind::Patch;
        surface.shader = patch.shader;
        surface.settings = patch.settings;
        surface.patch = int(i), surface.primitive = patch.primitive;
        surface.width = patch.width, surface.height = patch.height;
        surface.longestCurve = patch.longestCurve;
        surface.verts = patch.verts;
        surface.lightmapVecs = {patch.lodBounds.mins, patch.lodBounds.maxs, Vec3f{}};
        for (const DrawVert &v : surface.verts)
            surface.bounds.Add(v.xyz);
        FlattenPatch(surface, planes);
        SetTextureCoordinates(surface, entity.brushOrigin, context.options);
        geometry.surfaces.push_back(std::move(surface));
    }
}

// ---- Patches that are drawn as triangles ----

namespace {

const Patch *PatchOf(const DrawSurface &surface, const MapEntity &entity) {
    return surface.patch >= 0 && std::size_t(surface.patch) < entity.patches.size()
               ? &entity.patches[std::size_t(surface.patch)]
               : nullptr;
}

bool IsDrawnAsTriangles(const DrawSurface &surface, const Patch *patch, const BspOptions &options) {
    if (surface.kind != SurfaceKind::Patch || surface.shader == nullptr || surface.Empty() || surface.collisionOnly)
        return false;
    if (!options.patchMeta && (patch == nullptr || !patch->patchMeta))
        return false;
    return (options.meta || surface.shader->geometry.forceMeta) && !surface.shader->autosprite;
}

DrawSurface TriangleSurfaceOf(const DrawSurface &surface, int subdivisions) {
    const PatchMesh mesh = TessellatedSurface(surface, subdivisions);
    DrawSurface result = surface;
    result.kind = SurfaceKind::ForcedMeta;
    result.verts = mesh.verts;
    result.width = result.height = 0;
    result.longestCurve = 0;
    result.patch = -1;
    result.lightmapAxis = {};
    result.lightmapVecs = {};
    for (const auto &[a, b, c] : MeshTriangles(mesh))
        result.indexes.insert(result.indexes.end(), {a, b, c});
    return result;
}

bool Collides(const ShaderInfo &shader, const Game &game) {
    const SurfaceParm *clip = game.FindParm("playerclip");
    return (shader.compileFlags & C_SOLID) || (clip && (shader.contentFlags & clip->contentSet));
}

} // namespace

PatchMesh TessellatedSurface(const DrawSurface &surface, int subdivisions) {
    Patch patch;
    patch.shader = surface.shader;
    patch.width = surface.width, patch.height = surface.height;
    patch.verts = surface.verts;
    patch.longestCurve = surface.longestCurve;
    return TessellatePatch(patch, subdivisions);
}

void MakePatchMeshes(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context) {
    const std::size_t count = geometry.surfaces.size();
    for (std::size_t i = first; i < count; ++i) {
        const Patch *patch = PatchOf(geometry.surfaces[i], entity);
        if (!IsDrawnAsTriangles(geometry.surfaces[i], patch, context.options))
            continue;
        const int ofPatch = patch == nullptr ? 0 : patch->patchSubdivisions;
        const int subdivisions = ofPatch > 0 ? ofPatch : context.options.subdivisions;
        geometry.surfaces.push_back(TriangleSurfaceOf(geometry.surfaces[i], subdivisions));
        DrawSurface &source = geometry.surfaces[i];
        if (Collides(*source.shader, context.game))
            source.collisionOnly = true;
        else
            source.verts.clear();
    }
}

} // namespace q3
