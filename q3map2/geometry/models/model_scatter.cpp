// GPL-2.0-or-later. Models that shaders scatter over their surfaces.
#include "q3map2/geometry/models/model_scatter.h"

#include "q3map2/geometry/models/models.h"
#include "q3map2/map/map_patch.h"

#include <algorithm>
#include <cmath>

namespace q3 {
namespace {

constexpr std::size_t kMaxTriangles = std::size_t(1) << 18;
constexpr float kMinDensity = 1; ///< smallest edge length to which surfaces are split, game units

DrawVert Mean(const DrawVert &a, const DrawVert &b) {
    DrawVert v;
    v.xyz = (a.xyz + b.xyz) * 0.5f;
    v.normal = Normalize(a.normal + b.normal);
    for (std::size_t i = 0; i < 2; ++i)
        v.st[i] = (a.st[i] + b.st[i]) / 2;
    for (std::size_t i = 0; i < 4; ++i)
        v.color[i] = std::uint8_t((a.color[i] + b.color[i]) / 2);
    return v;
}

DrawVert MiddleOf(const std::vector<DrawVert> &verts) {
    DrawVert middle;
    Vec3d xyz, normal;
    std::array<double, 4> color{};
    const double share = 1 / double(verts.size());
    for (const DrawVert &vert : verts) {
        xyz += Vec3d(vert.xyz) * share, normal += Vec3d(vert.normal);
        for (std::size_t i = 0; i < 4; ++i)
            color[i] += vert.color[i] * share;
    }
    middle.xyz = Vec3f(xyz), middle.normal = Vec3f(Normalize(normal));
    for (std::size_t i = 0; i < 4; ++i)
        middle.color[i] = std::uint8_t(std::lround(color[i]));
    return middle;
}

/// Rows of a rotation that maps z to `up`.
std::array<Vec3d, 3> AxesFor(const Vec3d &up) {
    const Vec3d helper = std::abs(up.z) > 0.9 ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
    const Vec3d right = Normalize(helper - up * Dot(helper, up)), forward = Cross(up, right);
    return {Vec3d{right.x, forward.x, up.x}, Vec3d{right.y, forward.y, up.y}, Vec3d{right.z, forward.z, up.z}};
}

ModelTransform Turned(const std::array<Vec3d, 3> &axes, const ModelTransform &inner) {
    ModelTransform result;
    for (std::size_t i = 0; i < 3; ++i)
        result.rows[i] = inner.rows[0] * axes[i].x + inner.rows[1] * axes[i].y + inner.rows[2] * axes[i].z;
    return result;
}

ModelTransform PlaceOn(const SurfaceTriangle &triangle, const SurfaceModelDirective &directive, ScatterRandom &random) {
    const double scale = random.Between(directive.minScale, directive.maxScale);
    const double yaw = random.Between(directive.minAngle, directive.maxAngle);
    ModelTransform transform = MakeModelTransform({scale, scale, scale}, {0, yaw, 0}, {});
    const Vec3d up = Normalize(Vec3d(triangle[0].normal + triangle[1].normal + triangle[2].normal));
    if (directive.oriented && up != Vec3d{})
        transform = Turned(AxesFor(up), transform);
    transform.origin = (Vec3d(triangle[0].xyz) + Vec3d(triangle[1].xyz) + Vec3d(triangle[2].xyz)) / 3.;
    return transform;
}

void Scatter(std::size_t number, const SurfaceModelDirective &directive, ScatterRandom &random, MapEntity &entity,
             Geometry &geometry, PlaneTable &planes, const BspContext &context) {
    std::vector<SurfaceTriangle> triangles = TrianglesOf(geometry.surfaces[number], context);
    if (!Bisect(triangles, directive.density))
        context.WarnAt("surface models too dense", geometry.surfaces[number].settings.entity,
                       geometry.surfaces[number].primitive,
                       fmt::format("{}: q3map_surfaceModel with a density of {} would need more than {} sample points "
                                   "on one surface",
                                   geometry.surfaces[number].shader->name, directive.density, kMaxTriangles));
    ModelPlacement placement;
    placement.name = directive.model;
    placement.settings = geometry.surfaces[number].settings;
    placement.who = fmt::format("Entity {}", placement.settings.entity);
    placement.clipDepth = context.options.clipDepth;
    placement.fogNum = geometry.defaultFog;
    for (const SurfaceTriangle &triangle : triangles) {
        if (random.Next() >= double(directive.odds) * triangle[0].color[3] / 255)
            continue;
        placement.transform = PlaceOn(triangle, directive, random);
        if (!PlaceModel(placement, entity, geometry, planes, context))
            return;
        if (geometry.surfaces.size() > std::size_t(std::max(0, context.options.maxDrawSurfaces)))
            context.FailAt(geometry.surfaces[number].settings.entity, geometry.surfaces[number].primitive,
                           fmt::format("{}: scattered models make more than {} surfaces: expected a larger density or "
                                       "-maxmapdrawsurfs",
                                       geometry.surfaces[number].shader->name, context.options.maxDrawSurfaces));
    }
}

} // namespace

std::vector<SurfaceTriangle> TrianglesOf(const DrawSurface &surface, const BspContext &context) {
    std::vector<SurfaceTriangle> triangles;
    const std::vector<DrawVert> &verts = surface.verts;
    if (surface.kind == SurfaceKind::Patch) {
        Patch patch;
        patch.shader = surface.shader;
        patch.width = surface.width, patch.height = surface.height;
        patch.verts = verts;
        patch.longestCurve = surface.longestCurve;
        const PatchMesh mesh = TessellatePatch(patch, context.options.subdivisions);
        for (const auto &[a, b, c] : MeshTriangles(mesh))
            triangles.push_back({mesh.verts[std::size_t(a)], mesh.verts[std::size_t(b)], mesh.verts[std::size_t(c)]});
    } else if (!surface.indexes.empty()) {
        for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3)
            triangles.push_back({verts[std::size_t(surface.indexes[i])], verts[std::size_t(surface.indexes[i + 1])],
                                 verts[std::size_t(surface.indexes[i + 2])]});
    } else if (verts.size() >= 3) {
        const DrawVert middle = MiddleOf(verts);
        for (std::size_t i = 0; i < verts.size(); ++i)
            triangles.push_back({middle, verts[i], verts[(i + 1) % verts.size()]});
    }
    return triangles;
}

bool Bisect(std::vector<SurfaceTriangle> &triangles, float density) {
    const float longest = std::max(density, kMinDensity);
    std::vector<SurfaceTriangle> open(triangles.rbegin(), triangles.rend());
    triangles.clear();
    while (!open.empty()) {
        if (triangles.size() + open.size() > kMaxTriangles)
            return false;
        const SurfaceTriangle t = open.back();
        open.pop_back();
        std::array<float, 3> lengths;
        for (std::size_t i = 0; i < 3; ++i)
            lengths[i] = Length(t[(i + 1) % 3].xyz - t[i].xyz);
        const std::size_t edge = std::size_t(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
        if (!(lengths[edge] > longest)) {
            triangles.push_back(t);
            continue;
        }
        const std::size_t end = (edge + 1) % 3, apex = (edge + 2) % 3;
        const DrawVert middle = Mean(t[edge], t[end]);
        open.push_back({middle, t[end], t[apex]});
        open.push_back({t[edge], middle, t[apex]});
    }
    return true;
}

void AddShaderModels(MapEntity &entity, Geometry &geometry, std::size_t first, PlaneTable &planes,
                     const BspContext &context) {
    const std::size_t count = geometry.surfaces.size();
    for (std::size_t i = first; i < count; ++i) {
        const ShaderInfo *shader = geometry.surfaces[i].shader;
        if (shader == nullptr || geometry.surfaces[i].Empty())
            continue;
        ScatterRandom random{std::uint32_t(i - first)};
        for (auto directive = shader->geometry.surfaceModels.rbegin();
             directive != shader->geometry.surfaceModels.rend(); ++directive)
            Scatter(i, *directive, random, entity, geometry, planes, context);
    }
}

} // namespace q3
