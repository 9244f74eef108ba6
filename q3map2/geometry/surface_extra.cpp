// GPL-2.0-or-later. Copies by other shaders, the fog hull, portals to look at, flares.
#include "q3map2/geometry/surface_extra.h"

#include "common/debug_color.h"
#include "q3map2/bspfile/surface_keys.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace q3 {
namespace {

constexpr int kMaxCopyChain = 16;
constexpr float kFogHullDistance = 128, kFlareDistance = 2;
constexpr std::string_view kFlareShader = "flareshader";

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

/// Surfaces that `surface` brings about, and how many copies stand between them and an original.
void AppendCopies(std::size_t number, std::vector<int> &chain, Geometry &geometry, const BspContext &context) {
    const DrawSurface surface = geometry.surfaces[number]; // appending moves the list
    const auto add = [&](DrawSurface copy, int links) {
        geometry.surfaces.push_back(std::move(copy));
        chain.push_back(links);
    };
    if (const ShaderInfo *cel = CelShaderFor(surface)) {
        DrawSurface copy = CopyOf(surface, *cel);
        copy.planar = false;
        copy.planeNum = -1;
        add(std::move(copy), kMaxCopyChain);
    }
    const int links = chain[number];
    if (links >= kMaxCopyChain)
        return;
    const GeometryDirectives &geo = surface.shader->geometry;
    if (!geo.cloneShader.empty())
        add(CopyOf(surface, context.shaders.Get(geo.cloneShader)), links + 1);
    if (!geo.backShader.empty()) {
        DrawSurface copy = CopyOf(surface, context.shaders.Get(geo.backShader));
        copy.backSide = !surface.backSide;
        add(std::move(copy), kMaxCopyChain);
    }
}

DrawSurface FlareAt(const Vec3f &position, const Vec3f &normal, const Vec3f &color, const ShaderInfo &shader) {
    DrawSurface flare;
    flare.kind = SurfaceKind::Flare;
    flare.shader = &shader;
    flare.lightmapOrigin = position;
    flare.lightmapVecs = {color, Vec3f{}, normal};
    flare.bounds.Add(position);
    return flare;
}

Vec3f DirectionOf(const MapEntity &light, const Map &map) {
    const std::string_view name = light.pairs.Value({"target", "_target"});
    if (!name.empty())
        for (const MapEntity &entity : map.entities)
            if (EqualNoCase(entity.pairs.Value({"targetname", "_targetname"}), name)) {
                const Vec3f way = Normalize(entity.origin - light.origin);
                return way == Vec3f{} ? Vec3f{0, 0, -1} : way;
            }
    return {0, 0, -1};
}

/// Triangles of a polygon: all from its first point.
std::vector<int> FanIndexes(std::size_t points) {
    std::vector<int> indexes;
    for (int i = 2; i < int(points); ++i)
        indexes.insert(indexes.end(), {0, i - 1, i});
    return indexes;
}

constexpr std::uint8_t kPortalAlpha = 32;

} // namespace

void MakeDerivedSurfaces(Geometry &geometry, std::size_t first, const BspContext &context) {
    std::vector<int> chain(geometry.surfaces.size(), 0);
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i)
        if (geometry.surfaces[i].shader != nullptr && !geometry.surfaces[i].Empty())
            AppendCopies(i, chain, geometry, context);
}

void MakeFogHull(const Map &map, Geometry &geometry, const BspContext &context) {
    const std::string_view name = keys::kFogHull.Text(map.entities.front().pairs);
    if (name.empty())
        return;
    Boundsf bounds;
    for (const Brush &brush : map.entities.front().brushes)
        bounds.Add(brush.bounds);
    if (bounds.Empty())
        return;
    DrawSurface hull;
    hull.kind = SurfaceKind::FogHull;
    hull.shader = &context.shaders.Get("textures/" + std::string(name));
    hull.fogNum = geometry.defaultFog;
    const Vec3f border{kFogHullDistance, kFogHullDistance, kFogHullDistance};
    const std::array<Vec3f, 2> corners{bounds.mins - border, bounds.maxs + border};
    const Vec3f center = bounds.Center();
    for (std::size_t i = 0; i < 8; ++i) {
        DrawVert vert;
        vert.xyz = {corners[i & 1].x, corners[i >> 1 & 1].y, corners[i >> 2 & 1].z};
        vert.normal = Normalize(center - vert.xyz);
        hull.bounds.Add(vert.xyz);
        hull.verts.push_back(vert);
    }
    hull.indexes = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    geometry.surfaces.push_back(std::move(hull));
}

void MakePortalSurfaces(const Tree &tree, Geometry &geometry, const BspContext &context) {
    const ShaderInfo &shader = context.shaders.Get("debugportals");
    std::size_t number = 0;
    for (const TreePortal &portal : tree.portals) {
        if (portal.polygon.size() < 3 || !IsPassable(tree, portal))
            continue;
        const auto color = DebugColorBytes(number++);
        DrawSurface surface;
        surface.kind = SurfaceKind::Triangles;
        surface.shader = &shader;
        for (const Vec3f &point : portal.polygon) {
            DrawVert vert;
            vert.xyz = point;
            vert.normal = Vec3f(portal.plane.normal);
            vert.color = {color[0], color[1], color[2], kPortalAlpha};
            surface.bounds.Add(point);
            surface.verts.push_back(vert);
        }
        surface.indexes = FanIndexes(surface.verts.size());
        geometry.surfaces.push_back(std::move(surface));
    }
}

void MakeFlares(const Map &map, Geometry &geometry, const BspContext &context) {
    if (!context.options.flares)
        return;
    for (const MapEntity &light : map.entities) {
        if (!StartsWithNoCase(light.pairs.ClassName(), "light"))
            continue;
        std::string_view name = light.pairs.Value("_flareshader");
        if (name.empty() && !light.pairs.Flag("_flare"))
            continue;
        if (name.empty())
            name = kFlareShader;
        const Vec3f color = light.pairs.Vector({"_color"}).value_or(Vec3f{1, 1, 1});
        geometry.surfaces.push_back(FlareAt(light.origin, DirectionOf(light, map), color, context.shaders.Get(name)));
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
    geometry.surfaces.push_back(std::move(flare));
}

} // namespace q3
