// GPL-2.0-or-later. What one light gives to points of a light grid.
#include "q3map2/light/light_contribution.h"

#include "q3map2/light/light_area_visibility.h"
#include "q3map2/light/light_formfactor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

/// No light is stronger than at this distance. Game units.
constexpr float kNearest = 16;
constexpr float kLinearScale = 1.0f / 8000;
/// A spotlight fades over this much at the rim of its cone. Game units.
constexpr float kConeFade = 32;
/// Area lights are evaluated from at least this far in front in the legacy grid. Game units.
constexpr float kAreaPush = 8;
/// Points nearer than this to an emitter's plane get nothing from it. Game units.
constexpr double kPlaneClearance = 1.0f / 64;

/// Falloff and cone of point lights and spotlights: light at distance d along `toLight` (not normalised).
float PointAdd(const Light &light, const Vec3f &toLight, float d) {
    const float dAttenuated = std::max(kNearest, std::sqrt(d * d + light.extraDist * light.extraDist));
    float add = light.linear ? light.photons * kLinearScale - dAttenuated * light.fade
                             : light.photons / (dAttenuated * dAttenuated);
    if (light.type == LightType::Spot && add > 0) {
        const float along = -Dot(toLight, light.normal);
        if (along < 0)
            return 0;
        const float coneRadius = light.radiusByDist * along;
        const float off = Length(-toLight - light.normal * along);
        if (off >= coneRadius)
            return 0;
        if (off > coneRadius - kConeFade)
            add *= (coneRadius - off) / kConeFade;
    }
    return std::max(add, 0.0f);
}

/// Area light by the established program's formula; may flip the direction for two-sided lights.
float LegacyAreaAdd(const Light &light, const Vec3f &p, const Vec3f &u, float d, bool pointAreas) {
    if (pointAreas) {
        const float dAttenuated = std::max(kNearest, std::sqrt(d * d + light.extraDist * light.extraDist));
        return light.photons / (dAttenuated * dAttenuated);
    }
    const float s = Dot(p, light.normal) - light.dist;
    if (!light.twoSided && s < -1)
        return 0;
    Vec3f pushed = p;
    if (s > -kAreaPush && s < kAreaPush)
        pushed += light.normal * (kAreaPush - s);
    const float f = FormFactor(pushed, u, light.w);
    return (f < 0 && !light.twoSided ? 0 : std::abs(f)) * light.add;
}

/// Direct light without shadows at one point. False: none.
bool Unshadowed(const Light &light, const ContributionSettings &settings, const Vec3f &p, float &add, Vec3f &direction,
                float &distance) {
    if (light.type == LightType::Sun) {
        add = light.photons;
        direction = -light.normal;
        distance = kFar;
        return add > 0;
    }
    const Vec3f toLight = light.origin - p;
    distance = Length(toLight);
    if (distance > light.envelope || !light.bounds.Contains(p))
        return false;
    direction = distance > 0 ? toLight / distance : Vec3f{};
    add = light.type == LightType::Area ? LegacyAreaAdd(light, p, direction, distance, settings.pointAreas)
                                        : PointAdd(light, toLight, distance);
    return add > 0 && !(light.fast && add <= light.tolerance);
}

ShVector DirectionMoments(const Vec3f &direction, float add, bool radiance) {
    ShVector moments{};
    if (direction == Vec3f{}) // the light is at the point: from everywhere alike
        moments[0] = kShC0;
    else
        moments = ShBasis(Vec3d(direction));
    for (std::size_t k = 0; k < moments.size(); ++k)
        moments[k] *= double(add) * (radiance ? 1 : kCosineLobe[k]);
    return moments;
}

/// Exact area light: closed-form moments, in the light's colour 1 1 1 and byte scale. False: nothing arrives even unshadowed.
bool AreaMoments(const Light &light, const ContributionSettings &settings, const Vec3f &p, AreaView &view) {
    const double s = Dot(light.faceNormal, Vec3d(p)) - light.faceDist;
    if (std::abs(s) < kPlaneClearance || (s < 0 && !light.twoSided))
        return false;
    view.reversed = s < 0;
    Winding<float> &corners = view.corners;
    corners.assign(light.w.begin(), light.w.end());
    if (view.reversed)
        std::reverse(corners.begin(), corners.end());
    view.moments = MomentsOfPolygon(corners, Vec3d(p));
    if (!(view.moments.solidAngle > 0))
        return false;
    view.scale = light.add / std::numbers::pi;
    const double facing = Length(view.moments.first) * view.scale; // light on a surface that faces it
    return !(light.fast && facing <= light.tolerance) && light.bounds.Contains(p) && settings.pass == LightPass::GridSH;
}

void TraceDelta(const Light &light, const ContributionSettings &settings, const LightScene &scene, RayPacket &rays,
                ContributionCounts &counts) {
    const ShadowRules rules = settings.pass == LightPass::GridSH ? ShadowRules::Exact : ShadowRules::LegacyGrid;
    if (light.type == LightType::Sun)
        scene.TraceToSky(rays, light.skyIndex, rules, counts);
    else
        scene.TraceToLight(rays, rules, counts);
}

void DeltaContribution(const Light &light, const ContributionSettings &settings, const LightScene &scene,
                       PointPacket &points, ContributionCounts &counts) {
    RayPacket rays;
    std::array<std::size_t, kPacketSize> lane{};
    for (std::size_t i = 0; i < std::size_t(points.count); ++i) {
        if (points.skip[i])
            continue;
        float distance = 0;
        if (!Unshadowed(light, settings, points.position[i], points.add[i], points.direction[i], distance)) {
            points.add[i] = 0;
            ++counts.skippedFacing;
            continue;
        }
        const auto ray = std::size_t(rays.count++);
        lane[ray] = i;
        rays.origin[ray] = points.rayOrigin[i];
        rays.direction[ray] = points.direction[i];
        rays.distance[ray] = distance;
        rays.blocked[ray] = false;
    }
    if (rays.count == 0)
        return;
    TraceDelta(light, settings, scene, rays, counts);
    for (std::size_t ray = 0; ray < std::size_t(rays.count); ++ray) {
        const std::size_t i = lane[ray];
        points.visible[i] = rays.blocked[ray] ? Vec3f{} : rays.tint[ray];
        if (settings.pass == LightPass::GridSH && !rays.blocked[ray])
            points.moments[i] = DirectionMoments(points.direction[i], points.add[i], settings.radiance);
    }
}

void AreaContribution(const Light &light, const ContributionSettings &settings, const LightScene &scene,
                      PointPacket &points, ContributionCounts &counts) {
    AreaViews views;
    for (std::size_t i = 0; i < std::size_t(points.count); ++i) {
        if (points.skip[i])
            continue;
        AreaView view;
        if (!AreaMoments(light, settings, points.position[i], view)) {
            ++counts.skippedFacing;
            continue;
        }
        view.point = points.position[i];
        view.seed = points.index[i];
        view.lane = i;
        views.push_back(std::move(view));
    }
    if (views.empty())
        return;
    FindAreaVisibility(views, scene, counts);
    for (AreaView &view : views) {
        const std::size_t i = view.lane;
        points.visible[i] = view.tint;
        points.add[i] = view.tint == Vec3f{} ? 0 : float(view.scale * view.moments.solidAngle);
        points.direction[i] = Vec3f(Normalize(view.moments.first));
        for (std::size_t k = 0; k < 9; ++k)
            points.moments[i][k] = view.arriving[k] * view.scale * (settings.radiance ? 1 : kCosineLobe[k]);
    }
}

} // namespace

void LightContributionToPoint(const Light &light, const ContributionSettings &settings, const LightScene &scene,
                              PointPacket &points, ContributionCounts &counts) {
    const std::array<bool, kPacketSize> asked = points.skip;
    for (std::size_t i = 0; i < std::size_t(points.count); ++i) {
        points.add[i] = 0;
        points.visible[i] = {};
        if (asked[i])
            continue;
        ++counts.pairs;
        points.skip[i] = (settings.sunOnly && light.type != LightType::Sun) || !(settings.ignorePvs || light.SeenFrom(points.cluster[i]));
        counts.skippedPvs += points.skip[i];
    }
    if (light.type == LightType::Area && settings.pass == LightPass::GridSH)
        AreaContribution(light, settings, scene, points, counts);
    else
        DeltaContribution(light, settings, scene, points, counts);
    points.skip = asked;
}

float LightBound(const Light &light, const Boundsf &box) {
    const float strongest = MaxComponent(Max(light.color, -light.color));
    if (light.type == LightType::Sun)
        return strongest * light.photons;
    if (light.type == LightType::Area) {
        // A hemisphere around the nearest point holds the polygon: its cosine-weighted share is at most area / (pi d^2).
        const Boundsf around = WindingBounds(light.w);
        const Vec3f gap = Max(Max(box.mins - around.maxs, around.mins - box.maxs), Vec3f{});
        const float distance = Length(gap);
        const double share = distance > 0 ? WindingArea(light.w) / (std::numbers::pi * distance * distance) : 1;
        return strongest * light.add * float(std::min(1.0, share));
    }
    const float d = std::max(kNearest, box.Distance(light.origin));
    if (light.linear)
        return strongest * std::max(0.0f, light.photons * kLinearScale - (light.fade > 0 ? d * light.fade : 0));
    return strongest * light.photons / (d * d);
}

} // namespace q3
