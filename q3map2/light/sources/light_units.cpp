// GPL-2.0-or-later. Keys of units of light.
#include "q3map2/light/sources/light_units.h"

#include <algorithm>

namespace q3 {

namespace {

void AddVector(const Vec3f &v, KeyBuilder &key) {
    key.Add(v.x, v.y, v.z);
}

void AddPolygon(const Winding<float> &polygon, KeyBuilder &key) {
    key.Add(std::uint64_t(polygon.size()));
    for (const Vec3f &corner : polygon)
        AddVector(corner, key);
}

Hash128 HashOfLight(const Light &light) {
    KeyBuilder key;
    key.Add(light.sample, light.type, light.curve);
    const Attenuation &a = light.attenuation;
    key.Add(a.constant, a.linear, a.quadratic, a.flatFrom, a.fadeFrom, a.end);
    key.Add(light.cone.byAngles, light.cone.cosInner, light.cone.cosOuter, light.cone.exponent);
    key.Add(light.lightsGrid, light.lightsSurfaces, light.noFast, light.twoSided, light.negative,
            light.angleAttenuation);
    key.Add(light.angleScale, light.filterRadius, light.photons, light.radiosity, light.dist, light.fade,
            light.radiusByDist, light.extraDist, light.tolerance);
    AddVector(light.color, key);
    AddVector(light.origin, key);
    AddVector(light.normal, key);
    key.Add(light.style, light.skyIndex);
    AddPolygon(light.polygon, key);
    AddPolygon(light.shape.back, key);
    key.Add(light.shape.normal.x, light.shape.normal.y, light.shape.normal.z, light.shape.dist, light.shape.radius,
            light.shape.area);
    AddVector(light.shape.center, key);
    key.AddAll(light.shape.cumulative);
    key.Add(light.envelope, light.endsAtTolerance);
    AddVector(light.bounds.mins, key);
    AddVector(light.bounds.maxs, key);
    return key.Key();
}

} // namespace

LightHashes::LightHashes(const std::vector<Light> &lights, const UnitStore *units) : lights_(lights) {
    if (!units || !units->IsCache())
        return;
    hashes_.reserve(lights.size());
    for (const Light &light : lights)
        hashes_.push_back(HashOfLight(light));
}

Hash128 HashOfLights(const std::vector<Light> &lights) {
    KeyBuilder key("lights");
    for (const Light &light : lights) {
        const Hash128 hash = HashOfLight(light);
        key.Add(hash.low, hash.high);
    }
    return key.Key();
}

// ---- Keys of units ----

namespace {

/// Surfaces up to this far outside of the box of a changed triangle may matter: solids overlap a little, and rays
/// ignore what is near their start. Game units.
constexpr float kAround = 4;

/// Where the rays from receivers in `from` to the light end.
Boundsf EndsOfRays(const Light &light, const Boundsf &from) {
    Boundsf box;
    if (light.type == LightType::Sun) {
        box.Add(from.mins - light.normal * kSunDistance);
        box.Add(from.maxs - light.normal * kSunDistance);
        return box;
    }
    box.Add(light.origin);
    for (const Vec3f &corner : light.polygon)
        box.Add(corner);
    return box;
}

} // namespace

// The hull is the union of the boxes between the two: (1 - t) a + t b for t from 0 to 1, corner by corner. On each axis
// such a box meets the third for an interval of t.
bool HullMeets(const Boundsf &a, const Boundsf &b, const Boundsf &box) {
    float first = 0, last = 1;
    // Where f(t) = from + t (to - from) is at most `limit`.
    const auto restrict = [&](float from, float to, float limit) {
        const float slope = to - from;
        if (slope == 0)
            last = from <= limit ? last : -1;
        else if (const float t = (limit - from) / slope; slope > 0)
            last = std::min(last, t);
        else
            first = std::max(first, t);
    };
    for (std::size_t axis = 0; axis < 3; ++axis) {
        restrict(a.mins[axis], b.mins[axis], box.maxs[axis]);
        restrict(-a.maxs[axis], -b.maxs[axis], -box.mins[axis]);
    }
    return first <= last;
}

void LightUnitKey::AddLight(const Light &light, float weight) {
    const Hash128 &hash = hashes_.Of(light);
    // The samples of one light are a group: they follow each other.
    key_.Add(hash.low, hash.high, weight, light.group >= 0 && light.group == group_);
    group_ = light.group;
    for (const LaneClusters &clusters : clusters_) {
        unsigned seen = 0; // bits of receivers
        for (std::size_t i = 0; i < clusters.count; ++i)
            if (light.seenFrom.empty() || light.SeenFrom(clusters.number[i]))
                seen |= clusters.lanes[i];
        key_.Add(seen);
    }
    if (isTouched_ || units_.changedBoxes.empty())
        return;
    const Boundsf ends = EndsOfRays(light, box_);
    const Vec3f around{kAround, kAround, kAround};
    isTouched_ = std::ranges::any_of(units_.changedBoxes, [&](const Boundsf &box) {
        Boundsf wide = box;
        wide.mins = wide.mins - around, wide.maxs = wide.maxs + around;
        return HullMeets(box_, ends, wide);
    });
}

} // namespace q3
