// GPL-2.0-or-later. Patches that are drawn as triangles.
#include "q3map2/geometry/faces/patch_mesh.h"

#include "q3map2/map/map_patch.h"

namespace q3 {
namespace {

const Patch *PatchOf(const DrawSurface &surface, const MapEntity &entity) {
    return surface.patch >= 0 && std::size_t(surface.patch) < entity.patches.size()
               ? &entity.patches[std::size_t(surface.patch)]
               : nullptr;
}

bool IsMeshed(const DrawSurface &surface, const Patch *patch, const BspOptions &options) {
    if (surface.kind != SurfaceKind::Patch || surface.shader == nullptr || surface.Empty() || surface.collisionOnly)
        return false;
    if (!options.patchMeta && (patch == nullptr || !patch->patchMeta))
        return false;
    return (options.meta || surface.shader->geometry.forceMeta) && !surface.shader->autosprite;
}

DrawSurface MeshOfPatch(const DrawSurface &surface, int subdivisions) {
    Patch patch;
    patch.shader = surface.shader;
    patch.width = surface.width, patch.height = surface.height;
    patch.verts = surface.verts;
    patch.longestCurve = surface.longestCurve;
    const PatchMesh mesh = TessellatePatch(patch, subdivisions);
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

void MakePatchMeshes(const MapEntity &entity, Geometry &geometry, std::size_t first, const BspContext &context) {
    const std::size_t count = geometry.surfaces.size();
    for (std::size_t i = first; i < count; ++i) {
        const Patch *patch = PatchOf(geometry.surfaces[i], entity);
        if (!IsMeshed(geometry.surfaces[i], patch, context.options))
            continue;
        const int own = patch == nullptr ? 0 : patch->patchSubdivisions;
        geometry.surfaces.push_back(MeshOfPatch(geometry.surfaces[i], own > 0 ? own : context.options.subdivisions));
        DrawSurface &source = geometry.surfaces[i];
        if (Collides(*source.shader, context.game))
            source.collisionOnly = true;
        else
            source.verts.clear();
    }
}

} // namespace q3
