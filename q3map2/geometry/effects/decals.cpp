// GPL-2.0-or-later. Decals: patches of _decal entities projected onto surfaces.
#include "q3map2/geometry/effects/decals.h"

#include "q3map2/bspfile/map_keys.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "q3map2/map/map_parse.h"
#include "q3map2/map/map_patch.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Projectors: the prisms of _decal entities ----

namespace {

constexpr std::size_t kMaxProjectors = 1024; ///< of a map; limit of this program, chosen
constexpr std::string_view kLostDecal = "decal without surface";
constexpr double kMinDistance = 0.125;    ///< from a decal to its target, game units
constexpr double kClipEpsilon = 0.0625;   ///< game units
constexpr double kFacingEpsilon = 0.0001; ///< cosine

const MapEntity *FindTarget(const Map &map, std::string_view name) {
    const auto at = std::find_if(map.entities.begin(), map.entities.end(), [&](const MapEntity &entity) {
        return EqualNoCase(keys::kTargetName.Text(entity.pairs), name);
    });
    return at == map.entities.end() ? nullptr : &*at;
}

/// The place from which an entity's decals are projected: its origin, else the middle of its patches.
Vec3d StartOf(const MapEntity &entity) {
    if (entity.origin != Vec3f{})
        return Vec3d(entity.origin);
    Boundsf bounds;
    for (const Patch &patch : entity.patches)
        for (const DrawVert &vert : patch.verts)
            bounds.Add(vert.xyz);
    return Vec3d(bounds.Center());
}

/// Sets projector.texture to the affine map that is verts[i].st at corners[i] and constant along `direction`. False if
/// the triangle is parallel to `direction`.
bool ProjectTexture(const std::array<Vec3d, 3> &corners, const std::array<DrawVert, 3> &verts, const Vec3d &direction,
                    DecalProjector &projector) {
    const auto across = [&](const Vec3d &v) { return v - direction * Dot(v, direction); };
    const Vec3d e1 = across(corners[1] - corners[0]), e2 = across(corners[2] - corners[0]);
    // gradient . e1 = s1 and gradient . e2 = s2, solved in the span of e1 and e2 by their Gram matrix ((a, b), (b, c)).
    const double a = Dot(e1, e1), b = Dot(e1, e2), c = Dot(e2, e2), det = a * c - b * b;
    constexpr double kMinDeterminant = 1e-9; // relative to a c: the squared sine of the angle between e1 and e2
    if (!(det > kMinDeterminant * std::max(1., a * c)))
        return false;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double s1 = double(verts[1].st[axis]) - double(verts[0].st[axis]);
        const double s2 = double(verts[2].st[axis]) - double(verts[0].st[axis]);
        const Vec3d gradient = (e1 * (s1 * c - s2 * b) + e2 * (s2 * a - s1 * b)) / det;
        projector.texture[axis] = {gradient.x, gradient.y, gradient.z,
                                   double(verts[0].st[axis]) - Dot(gradient, corners[0])};
    }
    return true;
}

Plane PlaneAt(const Vec3d &normal, const Vec3d &point) {
    const Vec3d unit = Normalize(normal);
    return {unit, Dot(unit, point)};
}

/// Sets the prism of a triangle extruded by the vector `projection`; its planes face outward. False: the vector is
/// parallel to the triangle.
bool MakeProjector(std::array<DrawVert, 3> verts, const Vec3f &origin, const Vec3d &projection,
                   DecalProjector &projector) {
    std::array<Vec3d, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
        corners[i] = Vec3d(verts[i].xyz + origin);
    const Vec3d direction = Normalize(projection);
    if (!ProjectTexture(corners, verts, direction, projector))
        return false;
    Vec3d normal = Cross(corners[1] - corners[0], corners[2] - corners[0]);
    if (Dot(normal, direction) > 0) {
        normal = -normal;
        std::swap(corners[1], corners[2]);
    }
    projector.planes = {PlaneAt(normal, corners[0]), PlaneAt(-normal, corners[0] + projection)};
    Vec3d middle;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d &from = corners[i], &to = corners[(i + 1) % 3];
        projector.planes.push_back(PlaneAt(Cross(to - from, -direction), from));
        middle += (from + from + projection) / 6.;
    }
    projector.center = Vec3f(middle);
    double radius = 0;
    for (const Vec3d &corner : corners)
        radius = std::max({radius, Length(corner - middle), Length(corner + projection - middle)});
    projector.radius = float(radius);
    return true;
}

void AddProjectors(const MapEntity &entity, const Vec3d &projection, const Map &map, const BspContext &context,
                   std::vector<DecalProjector> &projectors) {
    const SurfaceSettings settings = SettingsOf(entity, map, context);
    for (const Patch &patch : entity.patches) {
        const PatchMesh mesh = TessellatePatch(patch, context.options.subdivisions);
        const std::size_t before = projectors.size();
        for (const auto &[a, b, c] : MeshTriangles(mesh)) {
            DecalProjector projector;
            projector.shader = patch.shader;
            projector.settings = settings;
            projector.entity = entity.number;
            projector.primitive = patch.primitive;
            if (!MakeProjector({mesh.verts[std::size_t(a)], mesh.verts[std::size_t(b)], mesh.verts[std::size_t(c)]},
                               entity.origin, projection, projector))
                continue;
            if (projectors.size() == kMaxProjectors) {
                context.log.Warn("too many decals", "{}: more than {} decal triangles; the rest is left out",
                                 entity.MessagePrefix(), kMaxProjectors);
                return;
            }
            projectors.push_back(std::move(projector));
        }
        if (projectors.size() == before)
            context.WarnAt(
                kLostDecal, entity.number, patch.primitive,
                "the patch of the _decal makes no decal: it is edge-on to the direction of the target; turn it so "
                "that the target is in front of it or behind it");
    }
}

/// Vector from the entity to its target; empty, after a warning, if the entity has no patches, no target, or its target
/// in the same place.
std::optional<Vec3d> ProjectionOf(const MapEntity &entity, const Map &map, const BspContext &context) {
    if (entity.patches.empty()) {
        context.log.Warn("decal without patches", "{}: a _decal without patches is left out", entity.MessagePrefix());
        return {};
    }
    const std::string_view name = keys::kDecalTarget.Text(entity.pairs);
    const MapEntity *target = name.empty() ? nullptr : FindTarget(map, name);
    if (target == nullptr) {
        context.log.Warn("decal without target",
                         "{}: a _decal is left out: expected a \"target\" that names an entity, got '{}'",
                         entity.MessagePrefix(), name);
        return {};
    }
    const Vec3d projection = Vec3d(target->origin) - StartOf(entity);
    if (Length(projection) > kMinDistance)
        return projection;
    context.log.Warn(
        "decal without direction",
        "{}: a _decal is left out: its target '{}' is where the decal itself is; put it behind the surface "
        "that is to get the decal",
        entity.MessagePrefix(), name);
    return {};
}

// ---- Decals on surfaces: the parts of their polygons in a projector ----

/// A face or a triangle of a surface, or what is left of it in a prism.
struct DecalFragment {
    Polygon polygon;
    Plane plane;
    int planeNum = -1; ///< in the plane table; -1: unknown
};

DecalFragment TriangleFragment(const Vec3f &a, const Vec3f &b, const Vec3f &c) {
    DecalFragment piece;
    piece.polygon = {a, b, c};
    piece.plane = PlaneOf(piece.polygon);
    return piece;
}

std::vector<DecalFragment> FragmentsOf(const DrawSurface &surface, const BspContext &context) {
    std::vector<DecalFragment> pieces;
    if (surface.kind == SurfaceKind::Face) {
        DecalFragment piece;
        for (const DrawVert &vert : surface.verts)
            piece.polygon.push_back(vert.xyz);
        piece.plane = PlaneOf(piece.polygon);
        piece.planeNum = surface.planeNum;
        pieces.push_back(std::move(piece));
    } else if (surface.kind == SurfaceKind::Patch) {
        const PatchMesh mesh = TessellatedSurface(surface, context.options.subdivisions);
        for (const auto &[a, b, c] : MeshTriangles(mesh))
            pieces.push_back(TriangleFragment(mesh.verts[std::size_t(a)].xyz, mesh.verts[std::size_t(b)].xyz,
                                              mesh.verts[std::size_t(c)].xyz));
    } else {
        for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3)
            pieces.push_back(TriangleFragment(surface.verts[std::size_t(surface.indexes[i])].xyz,
                                              surface.verts[std::size_t(surface.indexes[i + 1])].xyz,
                                              surface.verts[std::size_t(surface.indexes[i + 2])].xyz));
    }
    return pieces;
}

bool TakesDecals(const DrawSurface &surface) {
    if (surface.shader == nullptr || surface.Empty() || surface.isCopy || surface.shader->autosprite ||
        (surface.shader->compileFlags & C_NOMARKS))
        return false;
    switch (surface.kind) {
    case SurfaceKind::Face:
    case SurfaceKind::Patch:
        return true;
    case SurfaceKind::Triangles:
    case SurfaceKind::ForcedMeta: // models: only with a shader that a script defines
        return !surface.shader->scriptText.empty();
    default:
        return false;
    }
}

struct Sphere {
    Vec3f center;
    float radius = 0;
};

Sphere SphereOf(const DrawSurface &surface) {
    Boundsf bounds;
    for (const DrawVert &vert : surface.verts)
        bounds.Add(vert.xyz);
    return {bounds.Center(), Length(bounds.maxs - bounds.mins) * 0.5f};
}

/// Clips the fragment to the prism. A fragment in the plane of the decal's patch is inside. False: the fragment faces
/// away from the projector, or nothing is left.
bool ClipToProjector(DecalFragment &piece, const DecalProjector &projector, const Vec3d &origin) {
    if (piece.plane.normal == Vec3d{} || Dot(piece.plane.normal, projector.planes[0].normal) < -kFacingEpsilon)
        return false;
    Polygon front, back;
    for (std::size_t i = 0; i < projector.planes.size(); ++i) {
        Plane plane = projector.planes[i];
        plane.dist -= Dot(plane.normal, origin);
        const auto clip = i == 0 ? ClipPolygonKeepOn : ClipPolygon;
        clip(piece.polygon, plane, kClipEpsilon, front, back);
        if (back.size() < 3)
            return false;
        piece.polygon = back;
    }
    return true;
}

DrawSurface DecalSurface(const DecalFragment &piece, const DecalProjector &projector, const DrawSurface &surface,
                         const Vec3f &origin) {
    DrawSurface decal;
    decal.kind = SurfaceKind::Decal;
    decal.shader = projector.shader;
    decal.settings = surface.settings;
    decal.settings.celShader = projector.settings.celShader;
    decal.fogNum = surface.fogNum;
    decal.planar = true;
    decal.planeNum = piece.planeNum;
    decal.primitive = surface.primitive;
    for (const Vec3f &point : piece.polygon) {
        DrawVert vert;
        const Vec3d world = Vec3d(point + origin);
        vert.xyz = point;
        vert.normal = Vec3f(piece.plane.normal);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const auto &row = projector.texture[axis];
            vert.st[axis] = float(row[0] * world.x + row[1] * world.y + row[2] * world.z + row[3]);
        }
        // The decal fades from the front of the prism to its back.
        const double fromFront = -projector.planes[0].Distance(world), fromBack = -projector.planes[1].Distance(world);
        const double depth = fromFront + fromBack, alpha = depth > 0 ? 255 * fromBack / depth : 255;
        vert.color = {255, 255, 255, std::uint8_t(std::clamp(alpha, 0., 255.))};
        decal.bounds.Add(vert.xyz);
        decal.verts.push_back(vert);
    }
    return decal;
}

} // namespace

std::vector<DecalProjector> CollectDecals(Map &map, const BspContext &context) {
    std::vector<DecalProjector> projectors;
    for (MapEntity &entity : map.entities) {
        if (!EqualNoCase(entity.pairs.ClassName(), "_decal"))
            continue;
        const auto projection = ProjectionOf(entity, map, context);
        if (projection)
            AddProjectors(entity, *projection, map, context, projectors);
        entity.brushes.clear();
        entity.patches.clear();
    }
    context.log.VerboseCount(projectors.size(), "decal projectors");
    return projectors;
}

void ApplyDecals(std::vector<DecalProjector> &projectors, Geometry &geometry, std::size_t first,
                 const BspContext &context, const Vec3f &origin) {
    const std::size_t count = geometry.surfaces.size();
    if (projectors.empty())
        return;
    std::vector<Sphere> spheres(count);
    for (std::size_t i = first; i < count; ++i)
        spheres[i] = SphereOf(geometry.surfaces[i]);
    for (DecalProjector &projector : projectors)
        for (std::size_t i = first; i < count; ++i) {
            const Vec3f apart = spheres[i].center + origin - projector.center;
            if (!TakesDecals(geometry.surfaces[i]) || Length(apart) > spheres[i].radius + projector.radius)
                continue;
            for (DecalFragment &piece : FragmentsOf(geometry.surfaces[i], context))
                if (ClipToProjector(piece, projector, Vec3d(origin))) {
                    geometry.surfaces.push_back(DecalSurface(piece, projector, geometry.surfaces[i], origin));
                    projector.hit = true;
                }
        }
}

void WarnOfLostDecals(const std::vector<DecalProjector> &projectors, const BspContext &context) {
    const auto isOfPatch = [](const DecalProjector &a, const DecalProjector &b) {
        return a.entity == b.entity && a.primitive == b.primitive;
    };
    for (auto first = projectors.begin(); first != projectors.end();) {
        const auto end = std::find_if_not(first, projectors.end(),
                                          [&](const DecalProjector &other) { return isOfPatch(*first, other); });
        const double depth = first->planes[0].dist + first->planes[1].dist; // front and back face away from each other
        if (std::none_of(first, end, [](const DecalProjector &projector) { return projector.hit; }))
            context.WarnAt(
                kLostDecal, first->entity, first->primitive,
                fmt::format("the patch of the _decal hits no surface and makes no decal: no surface that takes "
                            "marks faces it within the distance of its target, {:.4g} units; put the target "
                            "behind the surface",
                            depth));
        first = end;
    }
}

} // namespace q3
