// GPL-2.0-or-later. Models in the map: placed by entities, and scattered by shaders over their surfaces.
#include "q3map2/geometry/models/models.h"

#include "q3map2/bspfile/map_keys.h"
#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/geometry/faces/face_surfaces.h"
#include "q3map2/geometry/models/model_clip.h"
#include "q3map2/map/map_parse.h"
#include "q3map2/map/map_patch.h"
#include "q3map2/model/model_load.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace q3 {

// ---- Models that shaders scatter over their surfaces ----

namespace {

constexpr std::size_t kMaxTriangles = std::size_t(1) << 18; ///< of one surface
constexpr float kMinEdgeLimit = 1; ///< triangles with no longer edge are never split, game units

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
    const double weight = 1 / double(verts.size());
    for (const DrawVert &vert : verts) {
        xyz += Vec3d(vert.xyz) * weight, normal += Vec3d(vert.normal);
        for (std::size_t i = 0; i < 4; ++i)
            color[i] += vert.color[i] * weight;
    }
    middle.xyz = Vec3f(xyz), middle.normal = Vec3f(Normalize(normal));
    for (std::size_t i = 0; i < 4; ++i)
        middle.color[i] = std::uint8_t(std::lround(color[i]));
    return middle;
}

/// Rows of a rotation that maps z to `up`.
std::array<Vec3d, 3> AxesFor(const Vec3d &up) {
    constexpr double kSteep = 0.9; // any axis will do that is not nearly along `up`
    const Vec3d axis = std::abs(up.z) > kSteep ? Vec3d{1, 0, 0} : Vec3d{0, 0, 1};
    const Vec3d right = Normalize(axis - up * Dot(axis, up)), forward = Cross(up, right);
    return {Vec3d{right.x, forward.x, up.x}, Vec3d{right.y, forward.y, up.y}, Vec3d{right.z, forward.z, up.z}};
}

/// The rotation with these rows after the transform `inner`.
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
    placement.messagePrefix = fmt::format("Entity {}", placement.settings.entity);
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
        const PatchMesh mesh = TessellatedSurface(surface, context.options.subdivisions);
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

bool Bisect(std::vector<SurfaceTriangle> &triangles, float maxEdge) {
    const float limit = std::max(maxEdge, kMinEdgeLimit);
    std::vector<SurfaceTriangle> pending(triangles.rbegin(), triangles.rend());
    triangles.clear();
    while (!pending.empty()) {
        if (triangles.size() + pending.size() > kMaxTriangles)
            return false;
        const SurfaceTriangle t = pending.back();
        pending.pop_back();
        std::array<float, 3> lengths;
        for (std::size_t i = 0; i < 3; ++i)
            lengths[i] = Length(t[(i + 1) % 3].xyz - t[i].xyz);
        const std::size_t edge = std::size_t(std::max_element(lengths.begin(), lengths.end()) - lengths.begin());
        if (!(lengths[edge] > limit)) {
            triangles.push_back(t);
            continue;
        }
        const std::size_t end = (edge + 1) % 3, apex = (edge + 2) % 3;
        const DrawVert middle = Mean(t[edge], t[end]);
        pending.push_back({middle, t[end], t[apex]});
        pending.push_back({t[edge], middle, t[apex]});
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

// ---- misc_model: model files placed in the map ----

namespace {

/// -debugclip: appends the sides of a clip brush as translucent polygons. Sides on triangles of the model, which have a
/// shader, are drawn with debugclip, the others with debugclip2.
void ShowClipBrush(const Brush &brush, std::size_t number, const PlaneTable &planes, Geometry &geometry,
                   const BspContext &context) {
    for (const BrushSide &side : brush.sides)
        if (!side.bevel && side.winding.size() >= 3)
            geometry.surfaces.push_back(DebugSurface(side.winding, Vec3f(planes[side.planeNum].normal),
                                                     context.shaders.Get(side.shader ? "debugclip" : "debugclip2"),
                                                     number));
}

/// Settings as for brushes, except that _castShadows defaults to 1 for models of the world and 0 for those of entities.
SurfaceSettings ModelSettings(const MapEntity &entity, const MapEntity &target, const Map &map,
                              const BspContext &context) {
    SurfaceSettings settings = SettingsOf(entity, map, context);
    const bool isOfWorld = &target == &map.entities.front();
    settings.entity = target.number;
    settings.castShadows = keys::kCastShadows.Integer(entity.pairs, isOfWorld ? 1 : 0);
    settings.receiveShadows = keys::kReceiveShadows.Integer(entity.pairs);
    return settings;
}

DrawVert PlacedVert(DrawVert vert, const ModelPlacement &placement, const ShaderInfo &shader) {
    const Vec3d point = placement.transform.Point(Vec3d(vert.xyz));
    vert.xyz = Vec3f(point);
    vert.normal = Vec3f(placement.transform.Normal(Vec3d(vert.normal)));
    if (shader.geometry.hasTexGen)
        for (std::size_t axis = 0; axis < 2; ++axis)
            vert.st[axis] = float(Dot(Vec3d(shader.geometry.texGen[axis]), point));
    if (placement.flags & kModelColorToAlpha) {
        const int gray = (int(vert.color[0]) + vert.color[1] + vert.color[2] + 1) / 3; // the mean, rounded
        vert.color = {255, 255, 255, std::uint8_t(gray)};
    }
    return vert;
}

DrawSurface SurfaceOf(const ModelMesh &mesh, const ModelPlacement &placement, const ShaderInfo &shader) {
    DrawSurface surface;
    const bool isMeta = shader.geometry.forceMeta || (placement.flags & kModelForceMeta);
    surface.kind = isMeta ? SurfaceKind::ForcedMeta : SurfaceKind::Triangles;
    surface.shader = &shader;
    surface.settings = placement.settings;
    surface.fogNum = placement.fogNum;
    for (const DrawVert &vert : mesh.verts) {
        surface.verts.push_back(PlacedVert(vert, placement, shader));
        surface.bounds.Add(surface.verts.back().xyz);
    }
    const bool isMirrored = placement.transform.Determinant() < 0;
    for (const auto &[a, b, c] : mesh.triangles)
        surface.indexes.insert(surface.indexes.end(), {isMirrored ? b : a, isMirrored ? a : b, c});
    return surface;
}

std::string RenamedShader(std::string name, const ModelPlacement &placement, const BspContext &context) {
    if (context.options.rename)
        name += placement.flags & kModelRenameRmg ? "_RMG_BSP" : "_BSP";
    return name;
}

void WarnOfRemaps(const Model &model, const ModelPlacement &placement, const BspContext &context) {
    std::vector<std::string> shaders;
    for (const ModelMesh &mesh : model.meshes)
        shaders.push_back(mesh.shader);
    placement.shaders.WarnOfUnmatched(shaders, placement.messagePrefix, context.log);
}

bool WantsClip(const ShaderInfo &shader, unsigned flags) {
    return shader.geometry.clipModel || ((flags & (kModelClip | kModelClipShapes)) && (shader.compileFlags & C_SOLID));
}

ClipMesh ClipMeshOf(const DrawSurface &surface) {
    ClipMesh mesh;
    mesh.shader = surface.shader;
    for (const DrawVert &vert : surface.verts) {
        mesh.points.push_back(vert.xyz);
        mesh.normals.push_back(vert.normal);
    }
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3)
        mesh.triangles.push_back({surface.indexes[i], surface.indexes[i + 1], surface.indexes[i + 2]});
    return mesh;
}

bool IsInsideWorld(const DrawSurface &surface) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (!(surface.bounds.mins[axis] >= -kMaxWorldCoord && surface.bounds.maxs[axis] <= kMaxWorldCoord))
            return false;
    return true;
}

/// Whether the bsp stage makes surfaces of the model.
bool IsCompiledIn(const MapEntity &entity) {
    return EqualNoCase(entity.pairs.ClassName(), "misc_model") && !keys::kStaticProp.Flag(entity.pairs);
}

bool BelongsToWorld(const MapEntity &model) {
    return keys::kModelTarget.Text(model.pairs).empty();
}

bool Targets(const MapEntity &model, const MapEntity &target) {
    const std::string_view name = keys::kModelTarget.Text(model.pairs);
    return !name.empty() && EqualNoCase(name, keys::kTargetName.Text(target.pairs));
}

void WarnOfLostModels(const Map &map, const BspContext &context) {
    for (const MapEntity &entity : map.entities) {
        if (!IsCompiledIn(entity) || BelongsToWorld(entity))
            continue;
        const bool found = std::any_of(map.entities.begin() + 1, map.entities.end(), [&](const MapEntity &target) {
            return (!target.brushes.empty() || !target.patches.empty()) && Targets(entity, target);
        });
        if (!found)
            context.log.Warn("model without its target",
                             "{}: no entity with brushes has the targetname '{}' that this misc_model targets",
                             entity.MessagePrefix(), keys::kModelTarget.Text(entity.pairs));
    }
}

std::optional<ModelPlacement> PlacementOf(const MapEntity &entity, const MapEntity &target, const Map &map,
                                          const Geometry &geometry, const BspContext &context) {
    ModelPlacement placement;
    placement.name = keys::kModel.Text(entity.pairs);
    if (placement.name.empty()) {
        context.log.Warn("misc_model without model", "{}: misc_model without a \"model\" key", entity.MessagePrefix());
        return {};
    }
    placement.messagePrefix = entity.MessagePrefix();
    WarnOfBadKeys(entity.pairs, std::size_t(entity.number), keys::kModelKeys, context.log);
    placement.frame = keys::kFrame.Integer(entity.pairs);
    const bool isOfWorld = &target == &map.entities.front();
    const Vec3d origin = Vec3d(entity.origin) - (isOfWorld ? Vec3d{} : Vec3d(target.origin));
    placement.transform = MakeModelTransform(ModelScaleOf(entity.pairs), AnglesOf(entity.pairs), origin);
    placement.settings = ModelSettings(entity, target, map, context);
    placement.flags = unsigned(keys::kModelFlags.Integer(entity.pairs));
    placement.clipDepth = keys::kClipDepth.Number(entity.pairs, context.options.clipDepth);
    placement.shaders = ShaderRemapOf(entity.pairs, placement.messagePrefix, placement.name, context.vfs, context.log);
    placement.fogNum = geometry.defaultFog;
    return placement;
}

} // namespace

bool PlaceModel(const ModelPlacement &placement, MapEntity &target, Geometry &geometry, PlaneTable &planes,
                const BspContext &context) {
    if (!geometry.models)
        geometry.models = std::make_shared<ModelLibrary>(context.vfs);
    std::string problem;
    const Model *model = geometry.models->Get(placement.name, placement.frame, problem);
    if (model == nullptr) {
        context.log.Warn("model cannot be read", "{}: the model {} cannot be read: {}", placement.messagePrefix,
                         placement.name, problem);
        return false;
    }
    WarnOfRemaps(*model, placement, context);
    std::vector<ClipMesh> clip;
    for (const ModelMesh &mesh : model->meshes) {
        const std::string name = placement.shaders(mesh.shader);
        if (name.empty() || mesh.triangles.empty())
            continue;
        const ShaderInfo &shader = context.shaders.Get(RenamedShader(name, placement, context));
        DrawSurface surface = SurfaceOf(mesh, placement, shader);
        if (!IsInsideWorld(surface)) {
            context.log.Warn("model outside the world", "{}: the model {} leaves the world and is left out",
                             placement.messagePrefix, placement.name);
            continue;
        }
        if (WantsClip(shader, placement.flags))
            clip.push_back(ClipMeshOf(surface));
        geometry.surfaces.push_back(std::move(surface));
    }
    const std::size_t firstClip = target.brushes.size();
    if (!clip.empty())
        MakeClipBrushes(clip, placement, target, planes, context);
    if (context.options.debugClip)
        for (std::size_t i = firstClip; i < target.brushes.size(); ++i)
            ShowClipBrush(target.brushes[i], i, planes, geometry, context);
    return true;
}

void AddEntityModels(Map &map, MapEntity &target, Geometry &geometry, const BspContext &context) {
    const bool isWorld = &target == &map.entities.front();
    if (isWorld)
        WarnOfLostModels(map, context);
    for (const MapEntity &entity : map.entities) {
        const bool isHere = isWorld ? BelongsToWorld(entity) : Targets(entity, target);
        if (!IsCompiledIn(entity) || !isHere)
            continue;
        if (const auto placement = PlacementOf(entity, target, map, geometry, context))
            PlaceModel(*placement, target, geometry, map.planes, context);
    }
}

} // namespace q3
