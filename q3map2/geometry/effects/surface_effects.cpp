// GPL-2.0-or-later. What shaders and entities make of surfaces: flares, foliage, fur, copies, terrain, sky boxes,
// portals.
#include "q3map2/geometry/effects/surface_effects.h"

#include "common/error.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/map_keys.h"
#include "q3map2/geometry/faces/draw_surface.h"
#include "q3map2/geometry/models/models.h"
#include "q3map2/map/index_map.h"
#include "q3map2/model/model_load.h"
#include "q3map2/tree/portals.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace q3 {

// ---- Copies by cel, clone and back shaders ----

namespace {

constexpr int kMaxCopyDepth = 16; ///< of copies of copies; limit of this program, chosen

DrawSurface CopyOf(const DrawSurface &surface, const ShaderInfo &shader) {
    DrawSurface copy = surface;
    copy.shader = &shader;
    copy.isCopy = true;
    if (surface.brush < 0)
        copy.side = -1;
    return copy;
}

const ShaderInfo *CelShaderFor(const DrawSurface &surface) {
    const ShaderInfo *cel = surface.settings.celShader;
    if (cel == nullptr || surface.isCopy || cel == surface.shader ||
        (surface.shader->compileFlags & (C_TRANSLUCENT | C_SKY)))
        return nullptr;
    return cel;
}

/// Appends the copies of surface `number`. copyDepths[i]: number of copying steps from an original to surface i.
void AppendCopies(std::size_t number, std::vector<int> &copyDepths, Geometry &geometry, const BspContext &context) {
    const DrawSurface surface = geometry.surfaces[number]; // a copy: appending invalidates references
    const auto add = [&](DrawSurface copy, int depth) {
        geometry.surfaces.push_back(std::move(copy));
        copyDepths.push_back(depth);
    };
    if (const ShaderInfo *cel = CelShaderFor(surface)) {
        DrawSurface copy = CopyOf(surface, *cel);
        copy.planar = false;
        copy.planeNum = -1;
        add(std::move(copy), kMaxCopyDepth); // is not copied again
    }
    const int depth = copyDepths[number];
    if (depth >= kMaxCopyDepth)
        return;
    const GeometryDirectives &directives = surface.shader->geometry;
    if (!directives.cloneShader.empty())
        add(CopyOf(surface, context.shaders.Get(directives.cloneShader)), depth + 1);
    if (!directives.backShader.empty()) {
        DrawSurface copy = CopyOf(surface, context.shaders.Get(directives.backShader));
        copy.backSide = !surface.backSide;
        add(std::move(copy), kMaxCopyDepth); // is not copied again
    }
}

} // namespace

void MakeDerivedSurfaces(Geometry &geometry, std::size_t first, const BspContext &context) {
    std::vector<int> copyDepths(geometry.surfaces.size(), 0);
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i)
        if (geometry.surfaces[i].shader != nullptr && !geometry.surfaces[i].Empty())
            AppendCopies(i, copyDepths, geometry, context);
}

// ---- Flares of lights and shaders ----

namespace {

constexpr float kFlareDistance = 2; ///< game units in front of the surface

DrawSurface FlareAt(const Vec3f &position, const Vec3f &normal, const Vec3f &color, const ShaderInfo &shader) {
    DrawSurface flare;
    flare.kind = SurfaceKind::Flare;
    flare.shader = &shader;
    flare.lightmapOrigin = position;
    flare.lightmapVecs = {color, Vec3f{}, normal};
    flare.bounds.Add(position);
    return flare;
}

/// Unit vector from the light to the entity that it targets; down without one.
Vec3f DirectionOf(const MapEntity &light, const Map &map) {
    const std::string_view name = light.pairs.Value({"target", "_target"});
    if (!name.empty())
        for (const MapEntity &entity : map.entities)
            if (EqualNoCase(keys::kTargetName.Text(entity.pairs), name)) {
                const Vec3f direction = Normalize(entity.origin - light.origin);
                return direction == Vec3f{} ? Vec3f{0, 0, -1} : direction;
            }
    return {0, 0, -1};
}

} // namespace

void MakeFlares(const Map &map, Geometry &geometry, const BspContext &context) {
    if (!context.options.flares)
        return;
    for (const MapEntity &light : map.entities) {
        if (!IsLight(light.pairs))
            continue;
        std::string_view name = keys::kFlareShader.Text(light.pairs);
        if (name.empty() && !keys::kFlare.Flag(light.pairs))
            continue;
        if (name.empty())
            name = context.game.flareShader;
        const Vec3f color = keys::kColor.Vector(light.pairs).value_or(Vec3f{1, 1, 1});
        geometry.surfaces.push_back(FlareAt(light.origin, DirectionOf(light, map), color, context.shaders.Get(name)));
        geometry.surfaces.back().lightStyle = std::uint8_t(keys::kStyle.Integer(light.pairs));
    }
}

void MakeShaderFlare(std::size_t surface, const Vec3f &origin, Geometry &geometry, const BspContext &context) {
    const DrawSurface &source = geometry.surfaces[surface];
    if (!context.options.flares || source.shader == nullptr || source.Empty() || source.kind == SurfaceKind::Flare ||
        (source.furred && source.isCopy) || source.shader->geometry.flareShader.empty())
        return;
    Vec3d middle, normal;
    for (const DrawVert &vert : source.verts)
        middle += Vec3d(vert.xyz), normal += Vec3d(vert.normal);
    middle = middle / double(source.verts.size());
    const Vec3f direction = Vec3f(Normalize(normal));
    const Vec3f position = Vec3f(middle) + origin + direction * kFlareDistance;
    DrawSurface flare =
        FlareAt(position, direction, source.shader->color, context.shaders.Get(source.shader->geometry.flareShader));
    flare.fogNum = source.fogNum;
    flare.settings = source.settings;
    const int style = source.shader->lightStyle == kNoStyle ? 0 : source.shader->lightStyle; // 255: constant light
    if (context.game.styleSlots && style > kLastStyle)
        throw Error("shader {}: q3map_lightStyle {}, expected 0 to {}: engines of {} have no others",
                    source.shader->name, style, kLastStyle, context.game.name);
    flare.lightStyle = std::uint8_t(style);
    geometry.surfaces.push_back(std::move(flare));
}

// ---- Foliage surfaces: one model and its instances ----

namespace {

constexpr std::size_t kMaxInstances = 8192; ///< on one surface; limit of this program, chosen
constexpr double kMinUp = 0.5;              ///< z of the normal: on steeper triangles nothing grows
constexpr double kMinAlpha = 0.75;          ///< mean vertex alpha of a triangle on which something grows

bool IsSteep(const SurfaceTriangle &t) {
    const Vec3d a(t[0].xyz), b(t[1].xyz), c(t[2].xyz);
    return Normalize(Cross(c - a, b - a)).z < kMinUp;
}

/// Probability that the triangle gets an instance.
double InstanceProbability(const SurfaceTriangle &t, const FoliageDirective &directive) {
    double alpha = (int(t[0].color[3]) + t[1].color[3] + t[2].color[3]) / (3 * 255.);
    if (directive.invertAlpha == 1) // FoliageDirective tells what the numbers mean
        alpha = 1 - alpha;
    else if (directive.invertAlpha == 2)
        alpha = 1;
    return alpha < kMinAlpha ? 0 : alpha * directive.odds;
}

std::vector<DrawVert> Instances(const DrawSurface &surface, const FoliageDirective &directive, ScatterRandom &random,
                                const BspContext &context) {
    std::vector<SurfaceTriangle> triangles = TrianglesOf(surface, context);
    std::erase_if(triangles, IsSteep);
    Bisect(triangles, directive.density);
    std::vector<DrawVert> instances;
    for (const SurfaceTriangle &t : triangles) {
        if (random.Next() >= InstanceProbability(t, directive) || instances.size() >= kMaxInstances)
            continue;
        DrawVert vert = t[0];
        vert.xyz = (t[0].xyz + t[1].xyz + t[2].xyz) / 3.f;
        vert.normal = Normalize(t[0].normal + t[1].normal + t[2].normal);
        instances.push_back(vert);
    }
    return instances;
}

DrawSurface FoliageSurface(const ModelMesh &mesh, float scale, const std::vector<DrawVert> &instances,
                           const DrawSurface &ground, const BspContext &context) {
    DrawSurface surface;
    surface.kind = SurfaceKind::Foliage;
    surface.shader = &context.shaders.Get(mesh.shader);
    surface.settings = ground.settings;
    surface.fogNum = ground.fogNum;
    surface.verts = mesh.verts;
    for (DrawVert &vert : surface.verts)
        vert.xyz *= scale;
    for (const auto &[a, b, c] : mesh.triangles)
        surface.indexes.insert(surface.indexes.end(), {a, b, c});
    surface.width = int(instances.size()), surface.height = int(mesh.verts.size());
    surface.verts.insert(surface.verts.end(), instances.begin(), instances.end());
    for (const DrawVert &vert : instances)
        surface.bounds.Add(vert.xyz);
    return surface;
}

} // namespace

void MakeFoliage(std::size_t surface, Geometry &geometry, const BspContext &context) {
    const DrawSurface ground = geometry.surfaces[surface]; // a copy: appending invalidates references
    if (ground.shader == nullptr || ground.Empty() || (ground.furred && ground.isCopy) ||
        ground.shader->geometry.foliage.empty() || (ground.kind != SurfaceKind::Patch && ground.indexes.empty()) ||
        ground.kind == SurfaceKind::Foliage)
        return;
    if (!geometry.models)
        geometry.models = std::make_shared<ModelLibrary>(context.vfs);
    if (context.game.refusesFoliage) {
        context.log.Warn("foliage", "{}: q3map_foliage is left out, since {} loads no map with such surfaces",
                         ground.shader->name, context.game.title);
        return;
    }
    ScatterRandom random{std::uint32_t(surface)};
    for (const FoliageDirective &directive : ground.shader->geometry.foliage) {
        context.log.Warn("foliage", "{}: q3map_foliage makes surfaces that Quake III engines do not draw",
                         ground.shader->name);
        std::string problem;
        const Model *model = geometry.models->Get(directive.model, 0, problem);
        if (model == nullptr) {
            context.log.Warn("model cannot be read", "{}: the foliage model {} cannot be read: {}", ground.shader->name,
                             directive.model, problem);
            continue;
        }
        const std::vector<DrawVert> instances = Instances(ground, directive, random, context);
        if (instances.empty())
            continue;
        for (const ModelMesh &mesh : model->meshes)
            geometry.surfaces.push_back(FoliageSurface(mesh, directive.scale, instances, ground, context));
    }
}

// ---- Fur: copies of a surface stacked along its normals ----

namespace {

constexpr int kMaxFurLayers = 256; ///< limit of this program, chosen

/// Moves each vertex along its normal by `distance` times its alpha.
void MoveAlongNormals(DrawSurface &surface, float distance) {
    for (DrawVert &vert : surface.verts)
        vert.xyz += vert.normal * (distance * float(vert.color[3]) / 255);
}

} // namespace

void MakeFur(std::size_t surface, Geometry &geometry) {
    DrawSurface &base = geometry.surfaces[surface];
    if (base.furred || base.shader == nullptr || base.Empty() || base.shader->geometry.fur.layers <= 0)
        return;
    const FurDirective fur = base.shader->geometry.fur;
    base.furred = true;
    MoveAlongNormals(base, fur.offset);
    const DrawSurface lowest = base; // a copy: appending invalidates references
    for (int layer = 1; layer < std::min(fur.layers, kMaxFurLayers); ++layer) {
        DrawSurface copy = lowest;
        copy.isCopy = true;
        MoveAlongNormals(copy, fur.offset * float(layer));
        for (DrawVert &vert : copy.verts)
            vert.color[3] = std::uint8_t(std::clamp(float(vert.color[3]) - fur.fade * 255, 0.f, 255.f));
        geometry.surfaces.push_back(std::move(copy));
    }
}

// ---- Sky boxes: a small room whose enlarged copy surrounds the map ----

namespace {

constexpr double kDefaultSkyBoxScale = 64;

Vec3d SkyBoxScale(const Entity &pairs) {
    if (const auto scale = keys::kSkyBoxScale.Vector(pairs))
        return Vec3d(*scale);
    const double scale = NumberFromText(keys::kSkyBoxScale.Text(pairs));
    return scale == 0 ? Vec3d{kDefaultSkyBoxScale, kDefaultSkyBoxScale, kDefaultSkyBoxScale}
                      : Vec3d{scale, scale, scale};
}

} // namespace

std::optional<SkyBoxTransform> ReadSkyBox(const Map &map) {
    std::optional<SkyBoxTransform> result;
    for (const MapEntity &entity : map.entities) {
        if (!EqualNoCase(entity.pairs.ClassName(), "_skybox"))
            continue;
        const Vec3d angles = AnglesOf(entity.pairs);
        const ModelTransform turned = MakeModelTransform({1, 1, 1}, angles, {});
        const ModelTransform scaled = MakeModelTransform(SkyBoxScale(entity.pairs), angles, {});
        const Vec3d shift = scaled.Point(Vec3d(entity.origin));
        result.emplace();
        for (std::size_t i = 0; i < 3; ++i) {
            result->rows[i] = {scaled.rows[i].x, scaled.rows[i].y, scaled.rows[i].z, -shift[i]};
            result->rotation[i] = turned.rows[i];
        }
    }
    return result;
}

DrawSurface SkyBoxCopy(const DrawSurface &surface, int number, const SkyBoxTransform &transform) {
    DrawSurface copy = surface;
    copy.parent = number;
    copy.bounds = {};
    for (DrawVert &vert : copy.verts) {
        const Vec3d p(vert.xyz), n(vert.normal);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto &row = transform.rows[i];
            vert.xyz[i] = float(row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3]);
            vert.normal[i] = float(Dot(transform.rotation[i], n));
        }
        copy.bounds.Add(vert.xyz);
    }
    if (copy.kind == SurfaceKind::Patch && !copy.bounds.Empty()) // bounds by which engines choose its level of detail
        copy.lightmapVecs = {copy.bounds.mins, copy.bounds.maxs, Vec3f{}};
    copy.lightmapVecs[2] = {};
    return copy;
}

// ---- Makes portals visible as surfaces (-debugportals) ----

void MakePortalSurfaces(const Tree &tree, Geometry &geometry, const BspContext &context) {
    const ShaderInfo &shader = context.shaders.Get("debugportals");
    std::size_t number = 0;
    for (const TreePortal &portal : tree.portals)
        if (portal.polygon.size() >= 3 && IsPassable(tree, portal))
            geometry.surfaces.push_back(DebugSurface(portal.polygon, Vec3f(portal.plane.normal), shader, number++));
}

// ---- Terrain from index maps: layers at the vertices set shader, alpha and height ----

namespace {

/// Copy of `layer` in which unset properties come from the indexed shader.
ShaderInfo Inherited(const ShaderInfo &layer, const ShaderInfo &indexed) {
    ShaderInfo shader = layer;
    GeometryDirectives &own = shader.geometry;
    const GeometryDirectives &base = indexed.geometry;
    own.globalTexture |= base.globalTexture;
    own.forceMeta |= base.forceMeta;
    own.nonPlanar |= base.nonPlanar;
    if (shader.lightmap.shadeAngle == 0)
        shader.lightmap.shadeAngle = indexed.lightmap.shadeAngle;
    if (shader.lightmap.axis == Vec3f{})
        shader.lightmap.axis = indexed.lightmap.axis;
    if (!own.hasTexGen && base.hasTexGen) {
        own.hasTexGen = true;
        own.texGen = base.texGen;
    }
    return shader;
}

bool SameInheritance(const ShaderInfo &a, const ShaderInfo &b) {
    return a.name == b.name && a.geometry.globalTexture == b.geometry.globalTexture &&
           a.geometry.forceMeta == b.geometry.forceMeta && a.geometry.nonPlanar == b.geometry.nonPlanar &&
           a.lightmap.shadeAngle == b.lightmap.shadeAngle && a.lightmap.axis == b.lightmap.axis &&
           a.geometry.hasTexGen == b.geometry.hasTexGen && a.geometry.texGen == b.geometry.texGen;
}

const ShaderInfo *LayerShader(const IndexMap &map, int low, int high, const ShaderInfo &indexed, Geometry &geometry,
                              const BspContext &context) {
    const std::string name = low == high ? fmt::format("textures/{}_{}", map.shader, high)
                                         : fmt::format("textures/{}_{}to{}", map.shader, low, high);
    const ShaderInfo &layer = context.shaders.Get(name);
    ShaderInfo wanted = Inherited(layer, indexed);
    if (SameInheritance(layer, wanted))
        return &layer;
    for (const ShaderInfo &shader : geometry.ownShaders)
        if (SameInheritance(shader, wanted))
            return &shader;
    geometry.ownShaders.push_back(std::move(wanted));
    return &geometry.ownShaders.back();
}

void ApplyIndexMap(DrawSurface &surface, const IndexMap &map, Geometry &geometry, const BspContext &context) {
    std::vector<int> layers;
    for (const DrawVert &vert : surface.verts)
        layers.push_back(map.LayerAt(vert.xyz));
    const auto [low, high] = std::minmax_element(layers.begin(), layers.end());
    surface.shader = LayerShader(map, *low, *high, *surface.shader, geometry, context);
    surface.bounds = {};
    for (std::size_t i = 0; i < surface.verts.size(); ++i) {
        DrawVert &vert = surface.verts[i];
        const float z = vert.xyz.z + map.OffsetOf(layers[i]);
        const bool isSnapped = context.options.snapVertices && surface.kind == SurfaceKind::Face;
        vert.xyz.z = isSnapped ? std::floor(z * 8 + 0.5f) / 8 : z; // to 1/8 game unit
        vert.color = {255, 255, 255, std::uint8_t(layers[i] == *high ? 255 : 0)};
        if (surface.shader->geometry.hasTexGen)
            for (std::size_t axis = 0; axis < 2; ++axis)
                vert.st[axis] = Dot(surface.shader->geometry.texGen[axis], vert.xyz);
        surface.bounds.Add(vert.xyz);
    }
}

} // namespace

void ApplyIndexedTerrain(Geometry &geometry, std::size_t first, const BspContext &context) {
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i) {
        DrawSurface &surface = geometry.surfaces[i];
        const bool takesLayers = surface.kind == SurfaceKind::Face || surface.kind == SurfaceKind::Patch;
        if (takesLayers && surface.shader != nullptr && surface.shader->geometry.indexed && surface.settings.indexMap &&
            !surface.Empty())
            ApplyIndexMap(surface, *surface.settings.indexMap, geometry, context);
    }
}

} // namespace q3
