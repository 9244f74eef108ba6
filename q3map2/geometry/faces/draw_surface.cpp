// GPL-2.0-or-later. Draw surfaces of the bsp stage: their record, plane, lightmap axis and sample size.
#include "q3map2/geometry/faces/draw_surface.h"

#include "common/debug_color.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Plane, lightmap axis and sample size of draw surfaces ----

namespace {

constexpr double kMaxOffPlane = 0.5; ///< greatest distance of a planar surface's vertices from its plane, game units
constexpr float kAxisFacing = 0.25f; ///< minimum cosine between normals and lightmap axis

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
                         return std::abs(plane.Distance(Vec3d(v.xyz))) <= kMaxOffPlane;
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
    constexpr float kTie = 0.0001f; // of components
    const Vec3f a{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    if (a.z > a.x - kTie && a.z > a.y - kTie)
        return {0, 0, normal.z < 0 ? -1.f : 1.f};
    if (a.x > a.y - kTie && a.x > a.z - kTie)
        return {normal.x < 0 ? -1.f : 1.f, 0, 0};
    return {0, normal.y < 0 ? -1.f : 1.f, 0};
}

std::optional<SideNumber> SideOf(const DrawSurface &surface) {
    const bool isOriginal = surface.kind == SurfaceKind::Face && !surface.isCopy && surface.parent < 0;
    if (!isOriginal || surface.brush < 0 || surface.side < 0)
        return std::nullopt;
    return SideNumber{surface.brush, surface.side};
}

std::vector<SideNumber> SidesOf(const DrawSurface &surface) {
    if (const auto side = SideOf(surface))
        return {*side};
    return surface.parent < 0 ? surface.mergedSides : std::vector<SideNumber>();
}

bool IsVertexLit(const DrawSurface &surface) {
    return (surface.shader->compileFlags & C_VERTEXLIT) != 0 || surface.kind == SurfaceKind::Triangles;
}

void ClassifySurface(DrawSurface &surface, PlaneTable &planes, const BspContext &context) {
    const bool mayBeLarge = surface.kind == SurfaceKind::Face || surface.kind == SurfaceKind::Patch;
    if (!mayBeLarge && int(surface.verts.size()) > context.options.maxVertexLitVerts)
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

// ---- Draw surfaces that show internal polygons of the compiler (-debugportals, -debugclip) ----

namespace {
constexpr std::uint8_t kDebugAlpha = 32;
}

DrawSurface DebugSurface(const Polygon &polygon, const Vec3f &normal, const ShaderInfo &shader, std::size_t number) {
    const auto color = DebugColorBytes(number);
    DrawSurface surface;
    surface.kind = SurfaceKind::Triangles;
    surface.shader = &shader;
    for (const Vec3f &point : polygon) {
        DrawVert vert;
        vert.xyz = point;
        vert.normal = normal;
        vert.color = {color[0], color[1], color[2], kDebugAlpha};
        surface.bounds.Add(point);
        surface.verts.push_back(vert);
    }
    for (int i = 2; i < int(polygon.size()); ++i) // a fan around the first point
        surface.indexes.insert(surface.indexes.end(), {0, i - 1, i});
    return surface;
}

// ---- Spatial hash of points, equal within a tolerance ----

namespace {

constexpr double kCell = 0.5; ///< edge of a cell, game units
/// Draw vertices lie on multiples of 1/8. Cell borders halfway between these keep vertices off the borders.
constexpr double kCellShift = 0.0625;
constexpr double kMaxCell = 1e9; ///< number of a cell on an axis

} // namespace

std::size_t PointTable::CellHash::operator()(const Cell &c) const {
    // 2^64 / golden ratio: Fibonacci hashing, Knuth, The Art of Computer Programming, volume 3, 6.4.
    constexpr std::size_t kGolden = 0x9E3779B97F4A7C15ull;
    const auto mix = [](std::size_t h, long long v) { return (h ^ std::size_t(v)) * kGolden; };
    const std::size_t h = mix(mix(mix(0, c.x), c.y), c.z);
    return h ^ (h >> 32);
}

PointTable::Cell PointTable::CellOf(const Vec3f &p, double x, double y, double z) const {
    // No map has points beyond the limit; if any, they share a cell.
    const auto cell = [](double v) {
        return (long long)(std::floor(std::clamp((v + kCellShift) / kCell, -kMaxCell, kMaxCell)));
    };
    return {cell(double(p.x) + x), cell(double(p.y) + y), cell(double(p.z) + z)};
}

int PointTable::FindIn(const Cell &cell, const Vec3f &p) const {
    const auto found = cells_.find(cell);
    if (found == cells_.end())
        return -1;
    for (const int i : found->second) {
        const Vec3d d = Vec3d(points_[std::size_t(i)]) - Vec3d(p);
        if (std::abs(d.x) <= tolerance_ && std::abs(d.y) <= tolerance_ && std::abs(d.z) <= tolerance_)
            return i;
    }
    return -1;
}

int PointTable::FindOrAdd(const Vec3f &p) {
    const Cell lo = CellOf(p, -tolerance_, -tolerance_, -tolerance_),
               hi = CellOf(p, tolerance_, tolerance_, tolerance_);
    int first = -1;
    for (long long x = lo.x; x <= hi.x; ++x)
        for (long long y = lo.y; y <= hi.y; ++y)
            for (long long z = lo.z; z <= hi.z; ++z) {
                const int found = FindIn({x, y, z}, p);
                if (found >= 0 && (first < 0 || found < first))
                    first = found;
            }
    if (first >= 0)
        return first;
    points_.push_back(p);
    cells_[CellOf(p, 0, 0, 0)].push_back(int(points_.size()) - 1);
    return int(points_.size()) - 1;
}

} // namespace q3
