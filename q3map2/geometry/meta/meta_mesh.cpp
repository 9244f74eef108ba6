// GPL-2.0-or-later. The meta step: triangles with shared vertices from faces.
#include "q3map2/geometry/meta/meta_mesh.h"

#include "q3map2/geometry/faces/triangulate.h"
#include "q3map2/geometry/meta/meta_merge.h"
#include "q3map2/geometry/meta/meta_smooth.h"
#include "q3map2/geometry/surface/surface_class.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace q3 {
namespace {

constexpr double kMinEdge = 0.125; ///< game units
constexpr float kSameTexture = 1e-4f;

bool SameCorner(const DrawVert &a, const DrawVert &b) {
    return SameVector(a.normal, b.normal) && std::abs(a.st[0] - b.st[0]) <= kSameTexture &&
           std::abs(a.st[1] - b.st[1]) <= kSameTexture && a.color[3] == b.color[3];
}

bool HasShortEdge(const std::array<DrawVert, 3> &corners) {
    for (std::size_t i = 0; i < 3; ++i)
        // Written so that NaN, which forced may contain, counts as short.
        if (!(Length(Vec3d(corners[(i + 1) % 3].xyz) - Vec3d(corners[i].xyz)) >= kMinEdge))
            return true;
    return false;
}

/// The plane of the surface, or of the corners. Zero normal: collinear corners.
Plane TrianglePlane(const DrawSurface &surface, const std::array<DrawVert, 3> &corners, const PlaneTable &planes) {
    if (surface.planar && surface.planeNum >= 0)
        return planes[surface.planeNum];
    const Vec3d a(corners[0].xyz), b(corners[1].xyz), c(corners[2].xyz);
    const Vec3d normal = Normalize(Cross(c - a, b - a));
    return {normal, Dot(normal, a)};
}

Vec3f TriangleAxis(const DrawSurface &surface, const Plane &plane) {
    if (surface.lightmapAxis != Vec3f{} || IsVertexLit(surface))
        return surface.lightmapAxis;
    if (surface.shader->lightmap.axis != Vec3f{})
        return surface.shader->lightmap.axis;
    return DominantAxis(Vec3f(plane.normal));
}

/// Whether the surface takes part in the meta step.
bool IsMetaSurface(const DrawSurface &surface, const BspOptions &options) {
    if (surface.Empty() || surface.shader == nullptr || surface.shader->autosprite)
        return false;
    // Faces of too many corners for one surface of an engine are cut up in any case.
    const bool isLarge = int(surface.verts.size()) > options.maxVertexLitVerts;
    if (!options.meta && !surface.shader->geometry.forceMeta && !isLarge)
        return false;
    return surface.kind == SurfaceKind::Face || surface.kind == SurfaceKind::Decal ||
           surface.kind == SurfaceKind::ForcedMeta;
}

} // namespace

bool SameVector(const Vec3f &a, const Vec3f &b) {
    const Vec3d d = Vec3d(a) - Vec3d(b);
    return std::abs(d.x) <= kSameVectorEpsilon && std::abs(d.y) <= kSameVectorEpsilon &&
           std::abs(d.z) <= kSameVectorEpsilon;
}

int MetaMesh::KeyOf(const DrawSurface &surface) {
    MetaKey key;
    key.shaderOrder = shaderOrder_.try_emplace(surface.shader, int(shaderOrder_.size())).first->second;
    key.fogNum = surface.fogNum;
    key.entity = surface.settings.entity;
    key.castShadows = surface.settings.castShadows, key.receiveShadows = surface.settings.receiveShadows;
    key.sampleSize = surface.sampleSize;
    key.ambient = surface.settings.ambient;
    key.backSide = surface.backSide;
    // Searched from the back, because the newest key nearly always matches.
    const auto found = std::find(keys_.rbegin(), keys_.rend(), key);
    if (found != keys_.rend())
        return int(keys_.rend() - found) - 1;
    keys_.push_back(key);
    return int(keys_.size()) - 1;
}

int MetaMesh::VertOf(const DrawVert &vert) {
    const int group = positions_.FindOrAdd(vert.xyz);
    if (group == int(groups_.size()))
        groups_.emplace_back();
    std::vector<int> &members = groups_[std::size_t(group)];
    for (const int i : members)
        if (SameCorner(verts_[std::size_t(i)].vert, vert))
            return i;
    members.push_back(int(verts_.size()));
    verts_.push_back({vert, group, {}});
    return members.back();
}

bool MetaMesh::HasTriangle(const MetaTriangle &triangle) const {
    const std::vector<int> &candidates = verts_[std::size_t(triangle.verts[0])].triangles;
    return std::ranges::any_of(candidates, [&](int i) {
        const MetaTriangle &other = triangles_[std::size_t(i)];
        return other.key == triangle.key && std::ranges::is_permutation(other.verts, triangle.verts);
    });
}

void MetaMesh::Link(MetaTriangle triangle, const std::array<DrawVert, 3> &corners, bool refuseRepeated,
                    const DrawSurface *surface, const BspContext *context) {
    for (std::size_t i = 0; i < 3; ++i)
        triangle.verts[i] = VertOf(corners[i]);
    if (refuseRepeated && HasTriangle(triangle)) {
        context->WarnAt("duplicate triangle", surface->settings.entity, surface->primitive,
                        "two triangles of shader " + surface->shader->name +
                            " have the same corners; one of them is left out");
        return;
    }
    for (const int v : triangle.verts)
        verts_[std::size_t(v)].triangles.push_back(int(triangles_.size()));
    triangles_.push_back(triangle);
}

void MetaMesh::Add(const DrawSurface &surface, int number, const PlaneTable &planes, const BspContext &context) {
    const int key = KeyOf(surface);
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3) {
        std::array<DrawVert, 3> corners;
        for (std::size_t c = 0; c < 3; ++c)
            corners[c] = surface.verts[std::size_t(surface.indexes[i + c])];
        MetaTriangle triangle;
        triangle.plane = TrianglePlane(surface, corners, planes);
        if (HasShortEdge(corners) || triangle.plane.normal == Vec3d{})
            continue;
        for (DrawVert &corner : corners)
            if (corner.normal == Vec3f{})
                corner.normal = Vec3f(triangle.plane.normal);
        triangle.key = key, triangle.surface = number;
        triangle.planeNum = surface.planar ? surface.planeNum : -1;
        triangle.lightmapAxis = TriangleAxis(surface, triangle.plane);
        Link(triangle, corners, true, &surface, &context);
    }
}

void MetaMesh::ReplaceNormals(const std::vector<std::array<Vec3f, 3>> &normals) {
    const std::vector<MetaTriangle> triangles = std::exchange(triangles_, {});
    const std::vector<MetaVert> verts = std::exchange(verts_, {});
    for (std::vector<int> &group : groups_)
        group.clear();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        std::array<DrawVert, 3> corners;
        for (std::size_t c = 0; c < 3; ++c) {
            corners[c] = verts[std::size_t(triangles[t].verts[c])].vert;
            corners[c].normal = normals[t][c];
        }
        Link(triangles[t], corners, false, nullptr, nullptr);
    }
}

void MakeMetaSurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context) {
    MetaMesh mesh;
    int strips = 0, fans = 0, forced = 0;
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i) {
        DrawSurface &surface = geometry.surfaces[i];
        if (!IsMetaSurface(surface, context.options))
            continue;
        if (surface.kind == SurfaceKind::ForcedMeta)
            ++forced;
        else {
            const std::size_t verts = surface.verts.size();
            TriangulateFace(surface, context);
            ++(surface.verts.size() > verts ? fans : strips);
        }
        mesh.Add(surface, int(i), planes, context);
        surface.verts.clear(), surface.indexes.clear();
    }
    if (mesh.Triangles().empty())
        return;
    Log &log = context.log;
    log.VerboseCount(strips, "strip faces");
    log.VerboseCount(fans, "fan faces");
    log.VerboseCount(forced, "forced meta surfaces");
    log.VerboseCount(mesh.GroupCount(), "meta positions");
    log.VerboseCount(int(mesh.Triangles().size()), "meta triangles");
    SmoothNormals(mesh, geometry, context);
    const std::size_t before = geometry.surfaces.size();
    MergeTriangles(mesh, geometry, planes, context);
    std::size_t verts = 0;
    for (std::size_t i = before; i < geometry.surfaces.size(); ++i)
        verts += geometry.surfaces[i].verts.size();
    log.VerboseCount(int(geometry.surfaces.size() - before), "merged surfaces");
    log.VerboseCount((long long)(verts), "merged vertices");
}

} // namespace q3
