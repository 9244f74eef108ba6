// GPL-2.0-or-later. Plane, lightmap axis and sample size of draw surfaces.
#include "q3map2/geometry/surface/surface_class.h"

#include <algorithm>
#include <cmath>

namespace q3 {
namespace {

constexpr double kPlanar = 0.5;      ///< greatest distance of a planar surface's vertices from its plane, game units
constexpr float kAxisFacing = 0.25f; ///< minimum cosine between normals and lightmap axis
constexpr int kMaxSampleSize = 16384;

void FindPlane(DrawSurface &surface, PlaneTable &planes) {
    Plane plane;
    if (surface.planeNum >= 0)
        plane = planes[surface.planeNum];
    else {
        const auto v = std::ranges::find_if(surface.verts, [](const DrawVert &d) { return d.normal != Vec3f{}; });
        if (v != surface.verts.end())
            plane = {Vec3d(v->normal), Dot(Vec3d(v->normal), Vec3d(v->xyz))};
    }
    surface.planar = plane.normal != Vec3d{} && std::ranges::all_of(surface.verts, [&](const DrawVert &v) {
                         return std::abs(plane.Distance(Vec3d(v.xyz))) <= kPlanar;
                     });
    if (surface.planar && surface.planeNum < 0) {
        const std::array<Vec3d, 1> point{Vec3d(surface.verts.front().xyz)};
        surface.planeNum = planes.Find(plane.normal, plane.dist, point);
        surface.planar = surface.planeNum >= 0;
        if (surface.planar)
            plane = planes[surface.planeNum];
    }
    surface.lightmapVecs[2] = surface.planar ? Vec3f(plane.normal) : Vec3f{};
}

/// The first signed axis within 75 degrees of all normals; zero if there is none.
Vec3f CommonAxis(const DrawSurface &surface) {
    constexpr std::array<Vec3f, 6> kAxes{Vec3f{0, 0, -1}, Vec3f{0, 0, 1},  Vec3f{-1, 0, 0},
                                         Vec3f{1, 0, 0},  Vec3f{0, -1, 0}, Vec3f{0, 1, 0}};
    for (const Vec3f &axis : kAxes)
        if (std::ranges::all_of(surface.verts, [&](const DrawVert &v) { return Dot(v.normal, axis) >= kAxisFacing; }))
            return axis;
    return {};
}

Vec3f LightmapAxis(const DrawSurface &surface) {
    if (surface.shader->lightmap.axis != Vec3f{})
        return surface.shader->lightmap.axis;
    if (surface.kind == SurfaceKind::ForcedMeta)
        return {};
    return surface.planar ? DominantAxis(surface.lightmapVecs[2]) : CommonAxis(surface);
}

int SampleSize(const DrawSurface &surface, const BspOptions &options) {
    double size = options.sampleSize;
    if (surface.shader->lightmap.sampleSize > 0)
        size = surface.shader->lightmap.sampleSize;
    else if (surface.settings.sampleSize > 0)
        size = surface.settings.sampleSize;
    if (surface.settings.lightmapScale > 0)
        size *= double(surface.settings.lightmapScale);
    return int(std::clamp(size, double(std::clamp(options.minSampleSize, 1, kMaxSampleSize)), double(kMaxSampleSize)));
}

} // namespace

Vec3f DominantAxis(const Vec3f &normal) {
    constexpr float kTie = 0.0001f;
    const Vec3f a{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    if (a.z > a.x - kTie && a.z > a.y - kTie)
        return {0, 0, normal.z < 0 ? -1.f : 1.f};
    if (a.x > a.y - kTie && a.x > a.z - kTie)
        return {normal.x < 0 ? -1.f : 1.f, 0, 0};
    return {0, normal.y < 0 ? -1.f : 1.f, 0};
}

bool IsVertexLit(const DrawSurface &surface) {
    return (surface.shader->compileFlags & C_VERTEXLIT) != 0 || surface.kind == SurfaceKind::Triangles;
}

void ClassifySurface(DrawSurface &surface, PlaneTable &planes, const BspContext &context) {
    const bool plain = surface.kind == SurfaceKind::Face || surface.kind == SurfaceKind::Patch;
    if (!plain && int(surface.verts.size()) > context.options.maxVertexLitVerts)
        surface.kind = SurfaceKind::ForcedMeta;
    surface.bounds = {};
    for (const DrawVert &v : surface.verts)
        surface.bounds.Add(v.xyz);
    FindPlane(surface, planes);
    if (IsVertexLit(surface)) {
        surface.lightmapAxis = {};
        surface.sampleSize = 0;
        return;
    }
    surface.lightmapAxis = LightmapAxis(surface);
    surface.sampleSize = SampleSize(surface, context.options);
}

void ClassifySurfaces(Geometry &geometry, std::size_t first, PlaneTable &planes, const BspContext &context) {
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i)
        if (!geometry.surfaces[i].Empty() && geometry.surfaces[i].shader != nullptr)
            ClassifySurface(geometry.surfaces[i], planes, context);
}

} // namespace q3
