// GPL-2.0-or-later. Lights whose origin, or part of whose polygon, is inside a solid or crossed by a surface.
#include "q3map2/light/sources/hidden_lights.h"
#include "libs/math/elementary.h"

#include "q3map2/light/scene/open_parts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace q3 {

namespace {

/// Lights this near to a solid count as in it. Game units.
constexpr float kLightMargin = 0.125f;
/// A solid covers the part of a polygon over which it is at this height. Game units.
constexpr float kCoverHeight = 0.25f;
/// Covered parts narrower than this do not count: sloped walls beside an area light lean over its edge. Game units.
constexpr double kNarrow = 0.5;
/// Parts with a smaller area emit no light. Square game units.
constexpr double kLeastArea = 1;

/// Twice the area over the perimeter: about the width of a narrow polygon, half that of a square.
double WidthOf(const Winding<float> &w) {
    double around = 0;
    for (std::size_t i = 0; i < w.size(); ++i)
        around += double(Length(w[(i + 1) % w.size()] - w[i]));
    return around > 0 ? 2 * WindingArea(w) / around : 0;
}

Winding<float> Moved(Winding<float> w, const Vec3f &by) {
    for (Vec3f &p : w)
        p += by;
    return w;
}

/// A place in front of the polygon of the light that is clear of solids: 1 unit in front of its center if possible.
std::optional<Vec3f> OpenOrigin(const Light &light, const BspSpace &space) {
    constexpr float kHeights[] = {1, 0.5f, kCoverHeight};     // in front of the polygon; game units
    constexpr float kTowardsCorners[] = {0.25f, 0.5f, 0.75f}; // fractions of the segment from the center
    const Vec3f center = light.shape.center;
    const auto clear = [&](const Vec3f &p) { return space.ClusterAt(p, kLightMargin) >= 0; };
    for (const float height : kHeights)
        if (const Vec3f p = center + light.normal * height; clear(p))
            return p;
    for (const float fraction : kTowardsCorners)
        for (const Vec3f &corner : light.polygon)
            for (const float height : kHeights)
                if (const Vec3f p = center + (corner - center) * fraction + light.normal * height; clear(p))
                    return p;
    return {};
}

/// The sides of a part of an area light that emit.
enum class EmittingSides { Front, Both };

/// Adds a light for the part `w` of the light's polygon, photons and tolerance in proportion to its area; none if the
/// part is tiny or no place in front of it is clear.
void AddPart(const Light &light, Winding<float> w, EmittingSides sides, const BspSpace &space,
             std::vector<Light> &parts) {
    const double area = WindingArea(w);
    if (area < kLeastArea)
        return;
    Light part = light;
    part.polygon = std::move(w);
    part.twoSided = sides == EmittingSides::Both;
    part.SetShape();
    const std::optional<Vec3f> origin = OpenOrigin(part, space);
    if (!origin)
        return;
    const double fraction = area / double(light.shape.area);
    part.photons = float(double(light.photons) * fraction);
    part.tolerance = float(double(light.tolerance) * fraction); // so it reaches about as far as the whole light
    part.origin = *origin;
    part.dist = Dot(part.origin, part.normal);
    parts.push_back(std::move(part));
}

Light Reversed(Light light) {
    std::reverse(light.polygon.begin(), light.polygon.end());
    light.normal = -light.normal;
    light.SetShape();
    return light;
}

/// Whether the origin is in the open and sees the center of the polygon.
bool OriginInSight(const Light &light, const BspSpace &space) {
    Vec3f origin = light.origin;
    if (NudgeIntoOpen(origin, space) < 0)
        return false;
    return FreeFraction(light.shape.center + light.normal * kCoverHeight, origin, space) >= 1;
}

/// Whether p is inside a model or behind curves: rays in all directions hit the back of a one-sided surface first.
bool SeesBacksOnly(const Vec3f &p, const LightScene &scene) {
    constexpr int kDirections = 64; // a spherical Fibonacci lattice: equal steps in z and turns by the golden angle
    const float goldenAngle = std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
    Lanes nearest{};
    RayCounts counts;
    for (int first = 0; first < kDirections; first += int(kPacketSize)) {
        RayPacket rays;
        for (const std::size_t i : kEachLane) {
            const float turn = goldenAngle * float(first + int(i));
            const float z = 1 - (2 * float(first + int(i)) + 1) / float(kDirections), radius = std::sqrt(1 - z * z);
            rays.Set(i, p, {radius * Cos(turn), radius * Sin(turn), z}, kSunDistance);
        }
        LightScene::Blockers blockers;
        scene.TraceBlockers(rays, LightScene::BlockerKind::Casters, 1, nearest, blockers, counts);
        if (blockers.behind.Bits() != kAllLanes)
            return false;
    }
    return true;
}

/// The open and covered parts of `w`, which is the light's polygon or a part of it; without narrow covered ones.
PolygonParts PartsOfLight(const Light &light, const Winding<float> &w, const BspSpace &space) {
    const Vec3f lift = light.normal * kCoverHeight;
    const double narrow = std::min(kNarrow, WidthOf(light.polygon) / 4);
    PolygonParts parts = PartsOf(Moved(w, lift), space);
    std::erase_if(parts.covered, [&](const Winding<float> &piece) { return WidthOf(piece) < narrow; });
    for (auto *pieces : {&parts.open, &parts.covered})
        for (Winding<float> &piece : *pieces)
            piece = Moved(std::move(piece), -lift);
    return parts;
}

/// A part of an area light whose front is open.
struct OpenFrontPart {
    Winding<float> w;
    EmittingSides sides = EmittingSides::Front;
};

/// Cuts the parts of a two-sided light whose front is open where a solid covers their back: those are one-sided. back:
/// the light reversed.
std::vector<OpenFrontPart> CutByBack(const Light &back, const BspSpace &space,
                                     const std::vector<Winding<float>> &open) {
    std::vector<OpenFrontPart> result;
    for (const Winding<float> &front : open) {
        const PolygonParts parts = PartsOfLight(back, {front.rbegin(), front.rend()}, space);
        if (parts.open.empty() || parts.covered.empty()) {
            result.push_back({front, EmittingSides::Both});
            continue;
        }
        for (const Winding<float> &piece : parts.open)
            result.push_back({{piece.rbegin(), piece.rend()}, EmittingSides::Both});
        for (const Winding<float> &piece : parts.covered)
            result.push_back({{piece.rbegin(), piece.rend()}, EmittingSides::Front});
    }
    return result;
}

/// Surfaces that cross area lights.
class CrossingSurfaces {
  public:
    explicit CrossingSurfaces(const LightScene &scene) : scene_(scene) {}

    /// The plane of a surface that crosses the light within kCrossing of its origin.
    std::optional<Plane> Across(const Light &light) {
        // Rays from around the origin through it, parallel to the light.
        const Vec3f across = Normalize(light.polygon[1] - light.polygon[0]), along = Cross(light.normal, across);
        RayPacket rays;
        for (const std::size_t i : kEachLane) {
            const float turn = 2 * std::numbers::pi_v<float> * float(i) / float(kPacketSize);
            const Vec3f direction = across * Cos(turn) + along * Sin(turn);
            rays.Set(i, light.origin - direction * kCrossing, direction, 2 * kCrossing);
        }
        LightScene::Blockers hits;
        RayCounts counts;
        scene_.TraceBlockers(rays, LightScene::BlockerKind::Surfaces, 1, Lanes{}, hits, counts);
        for (const std::size_t i : kEachLane)
            if (hits.hit[i] != 0)
                if (const auto plane = PlaneOf(hits.surface[i], rays.origin[i] + rays.direction[i] * hits.distance[i]))
                    return plane;
        return {};
    }

  private:
    static constexpr float kCrossing = 1; ///< game units

    /// The plane of the triangle of a surface that has the point.
    std::optional<Plane> PlaneOf(int surface, const Vec3f &point) {
        constexpr double kOnPlane = 0.05, kSliver = 1e-6; // game units, square units
        using Triangle = LightScene::BlockerTriangle;
        if (triangles_.empty()) {
            triangles_ = scene_.BlockerTriangles();
            std::ranges::stable_sort(triangles_, {}, &Triangle::surface);
        }
        auto at = std::ranges::lower_bound(triangles_, surface, {}, &Triangle::surface);
        for (; at != triangles_.end() && at->surface == surface; ++at) {
            const Triangle &triangle = *at;
            const Vec3d a(triangle.corners[0]), b(triangle.corners[1]), c(triangle.corners[2]), p(point);
            const Vec3d cross = Cross(b - a, c - a), normal = Normalize(cross);
            const auto inside = [&](const Vec3d &u, const Vec3d &v) {
                return Dot(Cross(v - u, p - u), cross) >= -kSliver;
            };
            if (Length(cross) > kSliver && std::abs(Dot(p - a, normal)) < kOnPlane && inside(a, b) && inside(b, c) &&
                inside(c, a))
                return Plane{normal, Dot(normal, a)};
        }
        return {};
    }

    const LightScene &scene_;
    std::vector<LightScene::BlockerTriangle> triangles_; ///< by surface; empty until one is needed
};

/// Adds the parts into which surfaces cut a light, or the light.
void AddUncrossed(const Light &light, int cuts, CrossingSurfaces &surfaces, const BspSpace &space,
                  std::vector<Light> &parts) {
    constexpr double kOnCut = 0.1; // game units
    const std::optional<Plane> plane = cuts > 0 ? surfaces.Across(light) : std::nullopt;
    std::vector<Light> halves;
    if (plane) {
        Polygon front, back;
        ClipPolygon(light.polygon, *plane, kOnCut, front, back);
        const EmittingSides sides = light.twoSided ? EmittingSides::Both : EmittingSides::Front;
        for (Polygon *half : {&front, &back})
            if (half->size() >= 3)
                AddPart(light, std::move(*half), sides, space, halves);
    }
    if (halves.size() < 2)
        return parts.push_back(light);
    for (const Light &half : halves)
        AddUncrossed(half, cuts - 1, surfaces, space, parts);
}

} // namespace

int NudgeIntoOpen(Vec3f &origin, const BspSpace &space) {
    static constexpr float kSteps[4] = {0, 0, 2, -2}; // as NetRadiant's q3map2; the order decides where it ends
    int cluster = space.ClusterAt(origin, kLightMargin);
    if (cluster >= 0)
        return cluster;
    for (const float x : kSteps)
        for (const float y : kSteps)
            for (const float z : kSteps) {
                const Vec3f p = origin + Vec3f{x, y, z};
                cluster = space.ClusterAt(p, kLightMargin);
                if (cluster >= 0)
                    origin = p;
            }
    return cluster;
}

std::vector<Light> OpenAreaLights(Light light, const BspSpace &space) {
    std::vector<Light> lights;
    PolygonParts parts = PartsOfLight(light, light.polygon, space);
    if (parts.covered.empty())
        parts.open = {light.polygon}; // nothing, or only what is too narrow to count, is covered
    std::vector<OpenFrontPart> fronts;
    const Light back = light.twoSided ? Reversed(light) : Light{};
    if (light.twoSided)
        fronts = CutByBack(back, space, parts.open);
    else
        for (Winding<float> &open : parts.open)
            fronts.push_back({std::move(open), EmittingSides::Front});
    if (parts.covered.empty() && fronts.size() == 1 && OriginInSight(light, space)) {
        lights.push_back(std::move(light));
        return lights;
    }
    for (OpenFrontPart &front : fronts)
        AddPart(light, std::move(front.w), front.sides, space, lights);
    if (light.twoSided)
        for (const Winding<float> &covered : parts.covered)
            for (Winding<float> &open : PartsOfLight(back, {covered.rbegin(), covered.rend()}, space).open)
                AddPart(back, std::move(open), EmittingSides::Front, space, lights);
    if (Vec3f origin = light.origin; lights.empty() && NudgeIntoOpen(origin, space) >= 0)
        lights.push_back(std::move(light));
    return lights;
}

std::vector<Light> CutCrossedLights(std::vector<Light> lights, const BspSpace &space, const LightScene &scene) {
    constexpr int kMostCuts = 3; // one behind the other: 8 parts
    CrossingSurfaces surfaces(scene);
    std::vector<Light> result;
    for (Light &light : lights)
        if (light.type == LightType::Area && light.polygon.size() >= 3)
            AddUncrossed(light, kMostCuts, surfaces, space, result);
        else
            result.push_back(std::move(light));
    return result;
}

float BacksplashDistance(const Light &light, float distance, const BspSpace &space) {
    if (!(distance > 0))
        return distance;
    Vec3f from = light.origin;
    NudgeIntoOpen(from, space);
    const float fraction = FreeFraction(from, light.origin + light.normal * distance, space);
    return fraction < 1 ? distance * fraction / 2 : distance;
}

void WarnOfHiddenLights(std::span<const Light> lights, const BspSpace &space, const LightScene *scene, Log &log) {
    std::map<int, const Light *> hidden; // by entity; null if one of its lights shines
    for (const Light &light : lights) {
        if (light.entity < 0 || light.type == LightType::Sun)
            continue;
        Vec3f origin = light.origin;
        const bool shines = NudgeIntoOpen(origin, space) >= 0 && !(scene && SeesBacksOnly(origin, *scene));
        const auto known = hidden.emplace(light.entity, &light).first;
        if (shines)
            known->second = nullptr;
    }
    for (const auto &[entity, light] : hidden) {
        if (!light)
            continue;
        const char *where = space.InSolidLeaf(light->origin)                   ? "inside a solid or outside the map"
                            : space.ClusterAt(light->origin, kLightMargin) < 0 ? "inside a detail brush"
                                                                               : "inside a model or behind curves";
        log.Warn("light in solid", "entity {}: the {} is {} and lights nothing; move it into the open", entity,
                 light->label, where);
    }
}

} // namespace q3
