// GPL-2.0-or-later. Everything that emits light, in the lighting model of NetRadiant's q3map2, and how far it
// reaches.
#include "q3map2/light/sources/light_sources.h"

#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/sources/hidden_lights.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace q3 {

// ---- AreaShape of area lights, from their polygon ----

void Light::SetShape() {
    shape = {};
    shape.back.assign(polygon.rbegin(), polygon.rend());
    shape.normal = -Normalize(WindingAreaVector(polygon));
    if (polygon.size() < 3)
        return;
    shape.dist = Dot(shape.normal, Vec3d(polygon.front()));
    Vec3d center;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const float triangle = float(WindingArea(Winding<float>{polygon[0], polygon[i - 1], polygon[i]}));
        shape.area += triangle;
        shape.cumulative.push_back(shape.area);
        center += Vec3d(polygon[0] + polygon[i - 1] + polygon[i]) * (double(triangle) / 3);
    }
    shape.center = shape.area > 0 ? Vec3f(center / double(shape.area)) : polygon.front();
    for (const Vec3f &p : polygon)
        shape.radius = std::max(shape.radius, Length(p - shape.center));
}

// ---- Which lights each cluster may see ----

LightsByCluster::LightsByCluster(const std::vector<Light> &lights, SunsSeen suns) : lights_(lights) {
    const std::size_t words = (lights.size() + 63) / 64;
    everywhere_.resize(words);
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::vector<bool> &seenFrom = lights[i].seenFrom;
        const std::uint64_t bit = std::uint64_t(1) << (i % 64);
        if (seenFrom.empty() || (suns == SunsSeen::Everywhere && lights[i].type == LightType::Sun)) {
            everywhere_[i / 64] |= bit;
            continue;
        }
        if (rows_.size() < seenFrom.size())
            rows_.resize(seenFrom.size(), std::vector<std::uint64_t>(words));
        for (std::size_t cluster = 0; cluster < seenFrom.size(); ++cluster)
            if (seenFrom[cluster])
                rows_[cluster][i / 64] |= bit;
    }
}

// ---- How far each light of a pass reaches ----

namespace {

/// The reach of area lights is kFirstReach plus a multiple of kReachStep. Game units.
constexpr float kFirstReach = 100, kReachStep = 10;

/// Smallest distance of the sequence 100, 110, ... at which an area light gives at most its tolerance: searched one by
/// one up to 990, where the form factor may still grow with distance, by bisection beyond.
float AreaReach(const Light &light) {
    const auto aboveTolerance = [&](int step) {
        const float r = kFirstReach + kReachStep * float(step);
        const Vec3f p = light.origin + light.normal * r;
        return std::abs(float(FormFactor(Vec3d(p), Vec3d(-light.normal), light.polygon))) * light.radiosity >
               light.tolerance;
    };
    constexpr int kLinearSteps = 90, kLastStep = int((kSunDistance - kFirstReach) / kReachStep);
    for (int step = 0; step < kLinearSteps; ++step)
        if (!aboveTolerance(step))
            return kFirstReach + kReachStep * float(step);
    if (aboveTolerance(kLastStep))
        return kSunDistance;
    int low = kLinearSteps - 1, high = kLastStep;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        (aboveTolerance(middle) ? low : high) = middle;
    }
    return kFirstReach + kReachStep * float(high);
}

float Reach(const Light &light) {
    if (light.type == LightType::Area)
        return light.endsAtTolerance ? AreaReach(light) : kSunDistance;
    return Falloff(light).Reach(light.endsAtTolerance ? light.tolerance : 0);
}

/// Box around what a cone by angles holds up to the envelope.
Boundsf ConeBounds(const Light &light) {
    // Greatest cosine between an axis of space and a direction of the cone, at least 0: cos(max(0, b - a)), b the angle
    // from the axis to the cone's axis, a the half angle. toAxis: cos b.
    const auto extent = [&](float toAxis) {
        const float cosine = light.cone.cosOuter, sine = std::sqrt(1 - cosine * cosine);
        if (toAxis >= cosine)
            return 1.0f;
        return std::max(0.0f, toAxis * cosine + std::sqrt(std::max(0.0f, 1 - toAxis * toAxis)) * sine);
    };
    Boundsf box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float a = light.normal[axis];
        box.mins[axis] = light.origin[axis] - extent(-a) * light.envelope - kConeSlack;
        box.maxs[axis] = light.origin[axis] + extent(a) * light.envelope + kConeSlack;
    }
    return box;
}

/// Sets the clusters of a light, and moves its origin out of solids.
void FindClusters(Light &light, bool ofWholePolygon, const BspSpace &space) {
    light.clusters.clear();
    if (const int cluster = NudgeIntoOpen(light.origin, space); cluster >= 0)
        light.clusters.push_back(cluster);
    if (ofWholePolygon && light.type == LightType::Area) {
        Winding<float> lifted = light.polygon;
        for (Vec3f &p : lifted)
            p += light.normal;
        space.ClustersOf(lifted, light.clusters);
        if (light.twoSided) {
            for (Vec3f &p : lifted)
                p -= light.normal * 2;
            space.ClustersOf(lifted, light.clusters);
        }
    }
}

/// Whether the light ends where it falls below the tolerance.
bool EndsAtTolerance(const Light &light, LightPass pass, const LightOptions &options, bool fastPoint) {
    if (light.noFast || pass == LightPass::GridSH) // the SH grid represents faint light instead of leaving it out
        return false;
    const bool area = light.type == LightType::Area;
    if (pass == LightPass::Surfaces)
        return options.fast || (!area && fastPoint);
    return options.fastGrid || !area;
}

std::vector<bool> SeenFrom(const std::vector<int> &clusters, const BspSpace &space) {
    std::vector<bool> seen(std::size_t(space.ClusterCount()));
    for (int from = 0; from < space.ClusterCount(); ++from)
        seen[std::size_t(from)] =
            std::any_of(clusters.begin(), clusters.end(), [&](int c) { return space.Visible(from, c); });
    return seen;
}

} // namespace

std::vector<bool> SkySeenFrom(const BspSpace &space, const SurfaceTable &table) {
    const Bsp &bsp = space.Map();
    const auto isSky = [&](int surface) { return (table[std::size_t(surface)].shader->compileFlags & C_SKY) != 0; };
    std::vector<bool> inLeaf(table.size());
    std::vector<int> skyClusters;
    for (const bspLeaf_t &leaf : bsp.leafs)
        for (int i = 0; i < leaf.numBSPLeafSurfaces; ++i) {
            const int surface = bsp.leafSurfaces[std::size_t(leaf.firstBSPLeafSurface + i)];
            inLeaf[std::size_t(surface)] = true;
            if (leaf.cluster >= 0 && isSky(surface) && (skyClusters.empty() || skyClusters.back() != leaf.cluster))
                skyClusters.push_back(leaf.cluster);
        }
    for (std::size_t i = 0; i < table.size(); ++i)
        if (!inLeaf[i] && isSky(int(i)))
            return {};
    return SeenFrom(skyClusters, space);
}

std::vector<Light> SetupEnvelopes(std::vector<Light> lights, LightPass pass, const LightOptions &options,
                                  const BspSpace &space, const std::vector<bool> &skySeenFrom, int &culled,
                                  bool fastPoint) {
    std::map<int, Boundsf> visibleBounds;
    const auto boundsOf = [&](int cluster) -> const Boundsf & {
        auto found = visibleBounds.find(cluster);
        if (found == visibleBounds.end())
            found = visibleBounds.emplace(cluster, space.VisibleBounds(cluster)).first;
        return found->second;
    };
    const auto wanted = [&](const Light &light) {
        return pass == LightPass::Surfaces ? light.lightsSurfaces : light.lightsGrid;
    };
    const auto prepare = [&](Light &light) {
        if (light.photons < 0 || light.radiosity < 0) {
            light.photons = -light.photons, light.radiosity = -light.radiosity;
            light.negative = true;
        }
        if (light.type == LightType::Sun) {
            light.envelope = kSunDistance;
            light.bounds = {{-kSunDistance, -kSunDistance, -kSunDistance}, {kSunDistance, kSunDistance, kSunDistance}};
            if (!(pass == LightPass::Surfaces && options.noTrace)) // without rays, suns shine everywhere
                light.seenFrom = skySeenFrom;
            return wanted(light);
        }
        FindClusters(light, pass == LightPass::GridSH || (pass == LightPass::Surfaces && options.areaShadows > 0),
                     space);
        if (light.clusters.empty())
            return false;
        light.endsAtTolerance = EndsAtTolerance(light, pass, options, fastPoint);
        light.seenFrom = SeenFrom(light.clusters, space);
        light.bounds = {};
        for (const int cluster : light.clusters)
            light.bounds.Add(boundsOf(cluster));
        light.bounds.Add(light.origin);
        // The upper corner of a box around the origin, as wide to both sides, that holds the bounds.
        const Vec3f corner = Max(light.bounds.maxs, light.origin * 2 - light.bounds.mins);
        light.envelope = std::min(Reach(light), Length(corner - light.origin));
        if (light.cone.byAngles) {
            const Boundsf cone = ConeBounds(light);
            light.bounds = {Max(light.bounds.mins, cone.mins), Min(light.bounds.maxs, cone.maxs)};
        }
        if (pass == LightPass::GridSH && !options.skip.reach) {
            light.bounds = {{-kSunDistance, -kSunDistance, -kSunDistance}, {kSunDistance, kSunDistance, kSunDistance}};
            light.envelope = Reach(light);
        }
        return wanted(light) && light.envelope > 0;
    };
    const std::size_t before = lights.size();
    std::erase_if(lights, [&](Light &light) { return !prepare(light); });
    culled = int(before - lights.size());
    std::stable_sort(lights.begin(), lights.end(), [](const Light &a, const Light &b) { return a.style < b.style; });
    return lights;
}

} // namespace q3
