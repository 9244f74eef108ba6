// GPL-2.0-or-later. What is solid at a point, and what is in the way of light.
#include "q3map2/lightmap/explain/obstacles.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr std::uint32_t kSolidContents = 1; ///< CONTENTS_SOLID of all games of the family
/// Distances behind a hit at which the brush is looked for. Game units.
constexpr float kBehindHit[] = {0.25f, 1, 4};
/// Points this near to a brush count as in it. Game units.
constexpr float kBrushSlack = 0.125f;
constexpr float kSideSlack = 0.5f; ///< a side whose plane is this near to a hit was hit. Game units

bool Same(const Obstacle &a, const Obstacle &b) {
    return a.kind == b.kind && a.number == b.number && a.shader == b.shader;
}

} // namespace

/// Number of the solid brush that holds p; -1: none.
int ObstacleFinder::BrushAt(const Vec3f &p) const {
    const Bsp &bsp = setup_.bsp;
    const bspLeaf_t &leaf = bsp.leafs[std::size_t(LeafAt(bsp, p))];
    for (int k = 0; k < leaf.numBSPLeafBrushes; ++k) {
        const int number = bsp.leafBrushes[std::size_t(leaf.firstBSPLeafBrush + k)];
        const bspBrush_t &brush = bsp.brushes[std::size_t(number)];
        if ((bsp.shaders[std::size_t(brush.shaderNum)].contentFlags & kSolidContents) == 0)
            continue;
        bool inside = brush.numSides > 0;
        for (int s = 0; s < brush.numSides && inside; ++s) {
            const bspPlane_t &plane =
                bsp.planes[std::size_t(bsp.brushSides[std::size_t(brush.firstSide + s)].planeNum)];
            inside = Dot(Vec3f(plane.normal), p) - plane.dist <= kBrushSlack;
        }
        if (inside)
            return number;
    }
    return -1;
}

/// The brush, and its side at `at` that a ray enters; the nearest side for a zero direction.
Obstacle ObstacleFinder::OfBrush(int number, const Vec3f &at, const Vec3f &direction) const {
    const Bsp &bsp = setup_.bsp;
    const bspBrush_t &brush = bsp.brushes[std::size_t(number)];
    Obstacle result;
    result.kind = ObstacleKind::Brush, result.number = number;
    constexpr float kEnters = 1000;
    float best = -1e9f;
    for (int s = 0; s < brush.numSides; ++s) {
        const bspBrushSide_t &side = bsp.brushSides[std::size_t(brush.firstSide + s)];
        const bspPlane_t &plane = bsp.planes[std::size_t(side.planeNum)];
        const float height = Dot(Vec3f(plane.normal), at) - plane.dist, entering = -Dot(Vec3f(plane.normal), direction);
        // Of the sides that the ray enters at `at`, the one that it enters most steeply; kEnters lifts them over all
        // others.
        const float fit = height + (height > -kSideSlack && entering > 0 ? kEnters * entering : 0);
        if (fit > best) {
            best = fit;
            result.shader = FieldName(bsp.shaders[std::size_t(side.shaderNum)].shader);
        }
    }
    result.at = at;
    result.source = source_.OfBrush(at + direction, result.shader);
    return result;
}

std::optional<Obstacle> ObstacleFinder::SolidAt(const Vec3f &p) const {
    if (setup_.space.ClusterAt(p, 0) >= 0)
        return {};
    if (const int brush = BrushAt(p); brush >= 0)
        return OfBrush(brush, p, {});
    Obstacle outside;
    outside.at = p;
    return outside;
}

std::string ObstacleFinder::ShaderOf(int surface) const {
    return surface >= 0 && std::size_t(surface) < setup_.table.size() ? setup_.table[std::size_t(surface)].shader->name
                                                                      : std::string();
}

SourcePlace ObstacleFinder::OfSurface(int surface, const Vec3f &p, const Vec3f &normal) const {
    const SurfaceEntry &entry = setup_.table[std::size_t(surface)];
    if (setup_.bsp.drawSurfaces[std::size_t(surface)].surfaceType == MST_PATCH)
        return source_.OfCurve(p, entry.shader->name, entry.entity);
    const SourcePlace brush = source_.OfBrush(p - normal, entry.shader->name);
    return brush.entity >= 0 ? brush : source_.OfSurfaceEntity(entry.entity);
}

Obstacle ObstacleFinder::OfHit(const LightScene::Blockers &hits, std::size_t lane, const Vec3f &from,
                               const ShadowRay &ray) const {
    const Vec3f at = from + ray.direction * hits.distance[lane];
    const int surface = hits.surface[lane];
    Obstacle result;
    if (surface >= int(setup_.table.size())) {
        result.kind = ObstacleKind::Prop;
        result.number = surface - int(setup_.table.size());
        return result;
    }
    for (const float behind : kBehindHit)
        if (const int brush = BrushAt(at + ray.direction * behind); brush >= 0) {
            result = OfBrush(brush, at, ray.direction * behind);
            if (surface >= 0)
                result.shader = ShaderOf(surface);
            return result;
        }
    if (surface >= 0) {
        result.kind = ObstacleKind::Surface;
        result.number = surface;
        result.shader = ShaderOf(surface);
        result.source = OfSurface(surface, at, ray.direction * -1);
    }
    return result;
}

std::vector<Obstacle> ObstacleFinder::Blocking(const Vec3f &from, std::span<const ShadowRay> shadowRays,
                                               const RayRules &rules) const {
    std::vector<Obstacle> obstacles;
    RayPacket rays;
    for (std::size_t i = 0; i < shadowRays.size(); ++i)
        rays.Set(i, from, shadowRays[i].direction, shadowRays[i].distance);
    RayPacket arriving = rays;
    RayCounts counts;
    if (rules.toSky && rules.ofSurface)
        setup_.scene.TraceSurfaceToSky(arriving, rules.skyIndex, rules.receiveShadows, counts);
    else if (rules.toSky)
        setup_.scene.TraceToSky(arriving, rules.skyIndex, ShadowRules::Exact, counts);
    else if (rules.ofSurface)
        setup_.scene.TraceSurfaceToLight(arriving, rules.receiveShadows, counts);
    else
        setup_.scene.TraceToLight(arriving, ShadowRules::Exact, counts);
    Lanes nearest;
    nearest.fill(rules.ofSurface ? kSurfaceIgnoreRadius : 0);
    LightScene::Blockers hits;
    // 1: Casters are those of shadow group 1, whatever the group of the receiver.
    setup_.scene.TraceBlockers(rays, LightScene::BlockerKind::Casters, 1, nearest, hits, counts);
    float lost = 0;
    for (std::size_t i = 0; i < shadowRays.size(); ++i) {
        if (arriving.live[i] != 0)
            continue;
        ++lost;
        Obstacle one;
        if (hits.hit[i] != 0) {
            one = OfHit(hits, i, from, shadowRays[i]);
            one.length = hits.distance[i];
            one.at = from + shadowRays[i].direction * one.length;
        } else
            one.kind = rules.toSky ? ObstacleKind::NoSky : ObstacleKind::SeeThrough;
        if (rules.toSky && one.kind == ObstacleKind::Outside)
            one.kind = ObstacleKind::NoSky;
        const auto known = std::ranges::find_if(obstacles, [&](const Obstacle &other) { return Same(one, other); });
        (known == obstacles.end() ? obstacles.emplace_back(one) : *known).fraction += 1;
    }
    for (Obstacle &one : obstacles)
        one.fraction /= lost;
    std::ranges::stable_sort(obstacles, [](const Obstacle &a, const Obstacle &b) { return a.fraction > b.fraction; });
    return obstacles;
}

} // namespace q3
