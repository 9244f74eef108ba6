// GPL-2.0-or-later. The final pass over draw surfaces.
#include "q3map2/geometry/emit/bsp_writer.h"

#include "common/debug_color.h"
#include "common/error.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/geometry/effects/fog.h"
#include "q3map2/geometry/effects/surface_effects.h"
#include "q3map2/geometry/emit/emit_surfaces.h"
#include "q3map2/geometry/faces/face_surfaces.h"

#include <algorithm>

namespace q3 {

namespace {

constexpr std::string_view kDebugShader = "debugsurfaces";

bool IsPolygon(const DrawSurface &surface) {
    return (surface.kind == SurfaceKind::Face || surface.kind == SurfaceKind::Decal) && surface.indexes.empty();
}

BspSurfaceType RecordType(const DrawSurface &surface, const BspOptions &options) {
    switch (surface.kind) {
    case SurfaceKind::Patch:
        return MST_PATCH;
    case SurfaceKind::Flare:
        return MST_FLARE;
    case SurfaceKind::Foliage:
        return MST_FOLIAGE;
    case SurfaceKind::Triangles:
    case SurfaceKind::FogHull:
        return MST_TRIANGLE_SOUP;
    default:
        break;
    }
    const bool isBent = !surface.planar && surface.lightmapAxis == Vec3f{};
    const bool isLarge = int(surface.verts.size()) > options.maxSurfaceVerts;
    return isBent || isLarge || options.debugSurfaces ? MST_TRIANGLE_SOUP : MST_PLANAR;
}

std::array<std::uint8_t, 4> OpaqueDebugColor(std::size_t number) {
    const auto [r, g, b] = DebugColorBytes(number);
    return {r, g, b, 255};
}

/// Brings vertices and triangles into the order in which they are written.
void Arrange(DrawSurface &surface, const BspContext &context) {
    if (surface.shader->geometry.invert != surface.backSide)
        ReverseSurface(surface);
    if (surface.kind == SurfaceKind::Patch)
        return;
    // Not for sprites, which are quads, nor for foliage, whose instances are at the end of its vertices.
    if (context.options.debugInset && !surface.shader->autosprite && surface.kind != SurfaceKind::Foliage)
        InsetTriangles(surface);
    if (!surface.shader->autosprite)
        surface.indexes = OrderTriangles(surface.indexes);
    else if (surface.shader->geometry.autosprite2)
        OrderSpriteQuad(surface, context);
}

} // namespace

int BspWriter::SurfaceShader(const DrawSurface &surface) {
    const ShaderInfo &shader = *surface.shader;
    if (context_.options.debugSurfaces && surface.kind != SurfaceKind::Patch)
        return ShaderNumber(kDebugShader);
    if (!surface.collisionOnly)
        return ShaderNumber(shader);
    std::uint32_t flags = shader.surfaceFlags;
    for (const std::string_view parm : {"nodraw", "pointlight"})
        if (const SurfaceParm *found = context_.game.FindParm(parm))
            flags |= found->surfaceSet;
    return ShaderNumber(shader.name, flags, shader.contentFlags);
}

void BspWriter::WriteVerts(const DrawSurface &surface) {
    bspModel_t &model = bsp.models.back();
    const bool growsModel = bsp.models.size() > 1 && surface.kind != SurfaceKind::Foliage;
    for (const DrawVert &vert : surface.verts) {
        bspDrawVert_t record{};
        const Vec3f p = vert.xyz + vert.normal * surface.shader->geometry.offset;
        record.xyz = p.Array();
        record.st = vert.st;
        record.normal = vert.normal.Array();
        record.color.fill(context_.options.debugSurfaces ? OpaqueDebugColor(bsp.drawSurfaces.size()) : vert.color);
        bsp.drawVerts.push_back(record);
        if (growsModel) {
            model.mins = Min(Vec3f(model.mins), p).Array();
            model.maxs = Max(Vec3f(model.maxs), p).Array();
        }
    }
}

void BspWriter::WriteSurface(const DrawSurface &surface) {
    if (const std::string &name = surface.shader->name; name.size() > kMaxShaderName)
        context_.FailAt(surface.settings.entity, surface.primitive,
                        fmt::format("the shader name {} has {} characters, expected at most {}", name, name.size(),
                                    kMaxShaderName));
    bspDrawSurface_t record{};
    record.shaderNum = SurfaceShader(surface);
    record.fogNum = surface.fogNum;
    record.surfaceType = RecordType(surface, context_.options);
    const bool isFlare = record.surfaceType == MST_FLARE;
    if (isFlare)
        record.lightmapOrigin = surface.lightmapOrigin.Array();
    const bool keepsVectors = isFlare || record.surfaceType == MST_PATCH;
    for (std::size_t i = keepsVectors ? 0 : 2; i < 3; ++i)
        record.lightmapVecs[i] = surface.lightmapVecs[i].Array();
    if (record.surfaceType == MST_PATCH || record.surfaceType == MST_FOLIAGE) {
        record.patchWidth = surface.width;
        record.patchHeight = surface.height;
    }
    if (!isFlare) {
        record.firstVert = std::int32_t(bsp.drawVerts.size());
        record.numVerts = std::int32_t(surface.verts.size());
        WriteVerts(surface);
        record.firstIndex = runs_.FindOrAppend(bsp.drawIndexes, surface.indexes);
        record.numIndexes = std::int32_t(surface.indexes.size());
    }
    surfaceFile += SurfaceBlock(surface, int(bsp.drawSurfaces.size()), surface.shader->name, worldSettings_,
                                std::max(context_.options.sampleSize, context_.options.minSampleSize));
    bsp.drawSurfaces.push_back(record);
    const bool isSky = (surface.shader->compileFlags & C_SKY) != 0;
    if (isSky && std::find(skies_.begin(), skies_.end(), surface.shader) == skies_.end())
        skies_.push_back(surface.shader);
}

void BspWriter::EmitSurface(MapEntity &entity, Tree &tree, Geometry &geometry, std::size_t number) {
    const bool isWorld = bsp.models.size() == 1;
    if (!geometry.surfaces[number].furred) // fur layers are copies of a surface modified before
        ModifySurface(geometry.surfaces[number], entity, map_.World(), map_.planes);
    if (geometry.surfaces[number].kind != SurfaceKind::Flare) {
        MakeFur(number, geometry);
        MakeFoliage(number, geometry, context_);
        MakeShaderFlare(number, entity.origin, geometry, context_);
    }
    DrawSurface &surface = geometry.surfaces[number];
    if ((surface.shader->compileFlags & C_NODRAW) != 0 && surface.kind != SurfaceKind::Patch)
        return;
    BiasTexture(surface);
    if (!isWorld)
        surface.fogNum = FogOfModelSurface(surface, entity.origin, map_, geometry);
    bool inSkyBox = false;
    if (!FilterSurface(surface, int(bsp.drawSurfaces.size()), tree, map_.planes, inSkyBox))
        return;
    if (IsPolygon(surface))
        TriangulateFace(surface, context_);
    if (isWorld && inSkyBox && skyBox_)
        skyBoxCopies_.push_back(SkyBoxCopy(surface, int(bsp.drawSurfaces.size()), *skyBox_));
    Arrange(surface, context_);
    WriteSurface(surface);
}

/// Writes the copies of sky box surfaces and adds them to each leaf with a sky surface.
void BspWriter::EmitSkyBoxCopies(Tree &tree, Geometry &geometry) {
    std::vector<std::size_t> skyLeafs;
    const std::size_t firstOfModel = std::size_t(bsp.models.back().firstBSPSurface);
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const TreeNode &leaf = tree.nodes[i];
        const bool hasSky = std::any_of(leaf.surfaces.begin(), leaf.surfaces.end(), [&](int surface) {
            const auto number = std::size_t(bsp.drawSurfaces[std::size_t(surface)].shaderNum);
            return std::size_t(surface) >= firstOfModel &&
                   (context_.shaders.Get(FieldName(bsp.shaders[number].shader)).compileFlags & C_SKY) != 0;
        });
        if (leaf.IsLeaf() && !leaf.opaque && hasSky)
            skyLeafs.push_back(i);
    }
    for (DrawSurface &copy : skyBoxCopies_) {
        for (const std::size_t leaf : skyLeafs) {
            tree.nodes[leaf].surfaces.push_back(int(bsp.drawSurfaces.size()));
            for (const DrawVert &vert : copy.verts)
                tree.nodes[leaf].bounds.Add(vert.xyz);
        }
        Arrange(copy, context_);
        WriteSurface(copy);
        geometry.surfaces.push_back(std::move(copy));
    }
    skyBoxCopies_.clear();
}

void BspWriter::EmitSurfaces(MapEntity &entity, Tree &tree, Geometry &geometry, std::size_t first) {
    const std::size_t written = bsp.drawSurfaces.size();
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i) {
        if (geometry.surfaces.size() > std::size_t(context_.options.maxDrawSurfaces))
            throw Error("more than {} draw surfaces; -maxmapdrawsurfs N allows more", context_.options.maxDrawSurfaces);
        const DrawSurface &surface = geometry.surfaces[i];
        const bool isThere = !surface.Empty() || surface.kind == SurfaceKind::Flare;
        if (isThere && surface.shader && surface.kind != SurfaceKind::Bad)
            EmitSurface(entity, tree, geometry, i);
    }
    EmitSkyBoxCopies(tree, geometry);
    FixSideShaders(entity, geometry);
    context_.log.VerboseCount(bsp.drawSurfaces.size() - written, "draw surfaces written");
}

void BspWriter::EmitSkyImages() {
    for (const ShaderInfo *sky : skies_) {
        if (sky->skyImageBase.empty())
            continue;
        for (const std::string_view side : {"_lf", "_rt", "_ft", "_bk", "_up", "_dn"}) {
            bspDrawSurface_t record{};
            record.shaderNum = ShaderNumber(sky->skyImageBase + std::string(side));
            record.fogNum = -1;
            record.surfaceType = MST_FLARE;
            record.lightmapNum[0] = -1; // none
            bsp.drawSurfaces.push_back(record);
        }
    }
}

} // namespace q3
