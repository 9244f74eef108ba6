// GPL-2.0-or-later. Direct light at receivers by brute force: the reference for the light stage's direct light.
#include "tools/measure/bounce_error/area_truth.h"

#include "common/platform/platform.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/transfer/light_kernel.h"
#include "tools/measure/bounce_error/record_cache.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace q3::bounce {

namespace {

/// Change this with the computation or the records, to invalidate cached files.
constexpr std::string_view kDirectVersion = "bounce_error direct truth 1";

/// Lights that give less than this without shadows are left out. Bytes.
constexpr double kLeastLight = 1e-4;
/// Lights that give less than this without shadows are no cause of errors. Bytes.
constexpr double kStrongLight = 1;
/// An area light is partly visible if a share between this and 1 minus this is. Also the least share that lamps hide.
constexpr double kPartShare = 0.02;
/// Rays end this far in front of the polygon, since the emitting surface is in the scene. Game units.
constexpr double kEmitterGap = 0.125;
/// Square roots of numbers of points on an area light. From each to the next while the standard error is above
/// kLightError. The first has so many points that one of them stands for at most kPointLight. Bytes.
constexpr std::array<int, 4> kPointSides{20, 40, 64, 128};
constexpr double kLightError = 0.02, kPointLight = 0.1;
/// Square root of the number of points on an area light that ShadowsChange looks at: one packet.
constexpr int kEdgeSide = 4;

/// The greatest of the absolute channels of a light's color.
double BrightestChannel(const Vec3f &color) {
    return double(MaxAbsComponent(color));
}

/// Upper bound of the form factor of an area light: its area over pi times the square of the least distance.
double FormFactorBound(const Light &light, const Vec3f &position) {
    const double least = double(Length(light.shape.center - position) - light.shape.radius);
    return least > 0 ? std::min(1.0, double(light.shape.area) / (std::numbers::pi * least * least)) : 1;
}

/// The polygon relative to p.
Winding<double> RelativeTo(const Vec3d &p, std::span<const Vec3f> polygon) {
    Winding<double> moved;
    for (const Vec3f &corner : polygon)
        moved.push_back(Vec3d(corner) - p);
    return moved;
}

} // namespace

// ---- Polygons ----

Winding<double> AboveHorizon(std::span<const Vec3f> polygon, const Vec3d &p, const Vec3d &normal) {
    const Winding<double> all = RelativeTo(p, polygon);
    Winding<double> part;
    WindingCutter<double> cutter;
    cutter.Classify(all, normal, 0, 0);
    if (cutter.AnyFront())
        cutter.Front(all, part);
    return part;
}

double FormFactorAbove(const Winding<double> &polygon, const Vec3d &normal) {
    double total = 0;
    for (std::size_t i = 0; i < polygon.size(); ++i)
        total += EdgeTerm(polygon[i], polygon[i + 1 < polygon.size() ? i + 1 : 0], normal);
    return std::min(1.0, std::abs(total) / (2 * std::numbers::pi));
}

std::vector<Vec3d> JitteredPoints(const Winding<double> &polygon, int side, PathRandom &random) {
    // Over the triangles of the fan, the first coordinate runs along the edges opposite to their common corner, by
    // area; the square root of the second is the share of the way from that corner to the edge.
    std::vector<double> areas; // running sum
    for (std::size_t i = 2; i < polygon.size(); ++i)
        areas.push_back((areas.empty() ? 0 : areas.back()) +
                        Length(Cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0])));
    std::vector<Vec3d> points;
    points.reserve(std::size_t(side) * std::size_t(side));
    for (int row = 0; row < side; ++row)
        for (int column = 0; column < side; ++column) {
            const double along = (column + random.Unit()) / side * areas.back();
            const double outward = std::sqrt((row + random.Unit()) / side);
            const auto found = std::size_t(std::upper_bound(areas.begin(), areas.end(), along) - areas.begin());
            const std::size_t triangle = std::min(found, areas.size() - 1);
            const double first = triangle > 0 ? areas[triangle - 1] : 0, area = areas[triangle] - first;
            const double part = area > 0 ? std::min(1.0, (along - first) / area) : 0;
            const Vec3d &from = polygon[triangle + 1], &to = polygon[triangle + 2];
            points.push_back(polygon[0] + (from + (to - from) * part - polygon[0]) * outward);
        }
    return points;
}

// ---- Light at one place ----

DirectTruth::DirectTruth(const SurfaceInputs &in, const DirectLights &lights)
    : in_(in), lights_(lights.Lights()), emits_(in.bsp.drawSurfaces.size()) {
    for (const Light &light : lights_)
        if (light.type == LightType::Area && light.surface >= 0)
            emits_[std::size_t(light.surface)] = true;
}

/// The part of an area light above one of the horizons of a place.
struct DirectTruth::Part {
    Vec3d facing;            ///< unit normal of the horizon
    Winding<double> polygon; ///< relative to the place
    double formFactor = 0;
    Vec3d outward;       ///< unit, off the light's plane to the side of the place
    double height = 0;   ///< of the place over that plane
    double light = 0;    ///< that it gives without shadows, greatest channel, bytes
    bool strong = false; ///< whether the area light gives at least kStrongLight without shadows
};

/// How much of a part is seen. Shares are of the weights of its points.
struct DirectTruth::Seen {
    Vec3d share;       ///< that arrives, by channel: see-through surfaces tint it
    Vec3d variance;    ///< of `share`
    double open = 0;   ///< share of rays that arrive
    double lamped = 0; ///< share of rays that end first at a surface that emits
};

/// Light at a place, summed up over the lights.
struct DirectTruth::Sum {
    Vec3d light, variance;
    bool crossedLamps = false, contact = false, penumbra = false;
    std::vector<std::size_t> strong; ///< lights that give at least kStrongLight unshadowed
    RayCounts counts;
};

/// By side * side points.
DirectTruth::Seen DirectTruth::SeenOf(const Part &part, const SurfacePoint &at, int side, PathRandom &random) const {
    const std::vector<Vec3d> points = JitteredPoints(part.polygon, side, random);
    const Vec3d off = part.outward * std::min(kEmitterGap, part.height / 2);
    std::vector<double> weights(points.size());
    std::vector<Vec3d> arriving(points.size());
    Seen seen;
    RayCounts counts;
    double sum = 0;
    for (std::size_t first = 0; first < points.size(); first += kPacketSize) {
        RayPacket rays;
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const Vec3d &point = points[first + i], target = point + off;
            const double square = Dot(point, point), length = Length(target);
            // The height is the distance times the cosine at the emitter, and the same for all points.
            weights[first + i] = square > 0 ? std::max(0.0, Dot(part.facing, point)) / (square * square) : 0;
            sum += weights[first + i];
            rays.Set(i, at.position, length > 0 ? Vec3f(target / length) : Vec3f(part.facing), float(length));
        }
        RayPacket blocked = rays;
        in_.scene.TraceSurfaceToLight(rays, at.receiveShadows, counts);
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            if (rays.live[i] != 0) {
                arriving[first + i] = rays.tinted ? Vec3d(rays.tint[i]) : Vec3d{1, 1, 1};
                seen.open += weights[first + i];
            }
            blocked.live.Set(i, rays.live[i] == 0);
        }
        if (part.strong && blocked.live.Any()) {
            const LaneMask lamped = HiddenByLamps(blocked, at.receiveShadows, counts);
            for (std::size_t i = 0; i < kPacketSize; ++i)
                seen.lamped += lamped[i] != 0 ? weights[first + i] : 0;
        }
    }
    if (!(sum > 0))
        return {};
    seen.open /= sum, seen.lamped /= sum;
    for (std::size_t i = 0; i < points.size(); ++i)
        seen.share += arriving[i] * (weights[i] / sum);
    // Of the ratio of sums, from differences between neighboring strata.
    for (std::size_t i = 0; i < points.size(); i += 2) {
        const Vec3d difference =
            (arriving[i] - seen.share) * (weights[i] / sum) - (arriving[i + 1] - seen.share) * (weights[i + 1] / sum);
        seen.variance += difference * difference;
    }
    return seen;
}

/// By as many points as it needs.
DirectTruth::Seen DirectTruth::SeenOf(const Part &part, const SurfacePoint &at, PathRandom &random) const {
    Seen seen;
    for (const int side : kPointSides) {
        if (part.light > kPointLight * side * side && side != kPointSides.back())
            continue;
        seen = SeenOf(part, at, side, random);
        if (part.light * std::sqrt(MaxComponent(seen.variance)) <= kLightError)
            break;
    }
    return seen;
}

/// Blocked rays that meet an emitting surface first.
LaneMask DirectTruth::HiddenByLamps(const RayPacket &blocked, int receiveShadows, RayCounts &counts) const {
    Lanes nearest;
    nearest.fill(kSurfaceIgnoreRadius);
    // See-through surfaces are among the first, solids among the others.
    LightScene::Blockers surfaces, casters;
    in_.scene.TraceBlockers(blocked, LightScene::BlockerKind::Surfaces, receiveShadows, nearest, surfaces, counts);
    in_.scene.TraceBlockers(blocked, LightScene::BlockerKind::Casters, receiveShadows, nearest, casters, counts);
    LaneMask lamped{};
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const bool surfaceFirst =
            surfaces.hit[i] != 0 && (casters.hit[i] == 0 || surfaces.distance[i] <= casters.distance[i]);
        const bool hit = surfaceFirst || casters.hit[i] != 0;
        const int surface = hit ? (surfaceFirst ? surfaces : casters).surface[i] : -1;
        lamped.Set(i, surface >= 0 && std::size_t(surface) < emits_.size() && emits_[std::size_t(surface)]);
    }
    return lamped;
}

void DirectTruth::AddArea(std::size_t number, const SurfacePoint &at, PathRandom &random, Sum &sum) const {
    const Light &light = lights_[number];
    const double brightest = BrightestChannel(light.color) * double(light.radiosity);
    if (!(brightest * FormFactorBound(light, at.position) >= kLeastLight))
        return;
    const double over = Dot(light.shape.normal, Vec3d(at.position)) - light.shape.dist, height = std::abs(over);
    if (height == 0 || (over < 0 && !light.twoSided) || IsOnEmitter(light, at) ||
        Length(OriginToward(light, over < 0) - at.position) >= light.envelope)
        return;
    std::array<Part, 2> parts;
    double formFactor = 0;
    for (std::size_t s = 0; s < (at.twoSided ? 2 : 1); ++s) {
        Part &part = parts[s];
        part.facing = Normalize(Vec3d(at.normal)) * (s == 0 ? 1.0 : -1.0);
        part.polygon = AboveHorizon(light.polygon, Vec3d(at.position), part.facing);
        part.outward = light.shape.normal * (over < 0 ? -1.0 : 1.0), part.height = height;
        formFactor += part.formFactor = FormFactorAbove(part.polygon, part.facing);
        part.light = brightest * part.formFactor;
    }
    const double unshadowed = brightest * formFactor, radiosity = double(light.radiosity);
    if (unshadowed < kLeastLight || (light.endsAtTolerance && radiosity * formFactor <= double(light.tolerance)))
        return;
    double open = 0, lamped = 0;
    for (Part &part : parts) {
        if (part.light < kLeastLight)
            continue;
        part.strong = unshadowed >= kStrongLight;
        const Seen seen = SeenOf(part, at, random);
        const Vec3d full = Vec3d(light.color) * (radiosity * part.formFactor * (light.negative ? -1.0 : 1.0));
        sum.light += full * seen.share, sum.variance += full * full * seen.variance;
        open += seen.open * part.formFactor / formFactor, lamped += seen.lamped * part.formFactor / formFactor;
    }
    if (unshadowed < kStrongLight)
        return;
    sum.strong.push_back(number);
    sum.crossedLamps |= lamped >= kPartShare;
    sum.penumbra |= open > kPartShare && open < 1 - kPartShare;
    const double pushedHeight = double(std::abs(Dot(at.position, light.normal) - light.dist));
    sum.contact |= pushedHeight < double(kAreaPush) && unshadowed * open >= kStrongLight;
}

void DirectTruth::AddOther(std::size_t number, const SurfacePoint &at, Sum &sum) const {
    const UnshadowedLight one = LightWithoutShadow(lights_[number], at);
    const double unshadowed = one.light ? BrightestChannel(one.color) : 0;
    if (unshadowed < kLeastLight)
        return;
    sum.light += Vec3d(ArrivingLight(in_.scene, one, at, sum.counts));
    if (unshadowed >= kStrongLight)
        sum.strong.push_back(number);
}

// ---- Shadows around a receiver ----

/// Bits of the points of an area light that are seen from a position; of other lights, whether they are. None from
/// behind a one-sided area light.
unsigned DirectTruth::SeenFrom(const Light &light, std::span<const Vec3d> points, const Vec3f &position,
                               int receiveShadows) const {
    RayCounts counts;
    RayPacket rays;
    if (light.type == LightType::Sun) {
        rays.Set(0, position, -light.normal, kSunDistance);
        in_.scene.TraceSurfaceToSky(rays, light.skyIndex, receiveShadows, counts);
        return rays.live.Bits();
    }
    if (light.type != LightType::Area) {
        rays.Aim(0, position, light.origin);
        in_.scene.TraceSurfaceToLight(rays, receiveShadows, counts);
        return rays.live.Bits();
    }
    const double over = Dot(light.shape.normal, Vec3d(position)) - light.shape.dist;
    if (over < 0 && !light.twoSided)
        return 0;
    const Vec3d off = light.shape.normal * std::clamp(over / 2, -kEmitterGap, kEmitterGap);
    for (std::size_t i = 0; i < points.size(); ++i)
        rays.Aim(i, position, Vec3f(points[i] + off));
    in_.scene.TraceSurfaceToLight(rays, receiveShadows, counts);
    return rays.live.Bits();
}

bool DirectTruth::ShadowsChange(const TruthReceiver &receiver, std::span<const std::size_t> strong) const {
    const SurfacePoint &center = receiver.places.front();
    for (const std::size_t number : strong) {
        const Light &light = lights_[number];
        std::vector<Vec3d> points;
        if (light.type == LightType::Area) {
            PathRandom random(number);
            points = JitteredPoints(RelativeTo({}, light.polygon), kEdgeSide, random);
        }
        const unsigned own = SeenFrom(light, points, center.position, center.receiveShadows);
        for (const Vec3f &position : receiver.around)
            if (SeenFrom(light, points, position, center.receiveShadows) != own)
                return true;
    }
    return false;
}

// ---- Receivers ----

LuxelTruth DirectTruth::At(const TruthReceiver &receiver, std::uint64_t seed) const {
    Vec3d light, variance;
    LuxelTruth truth;
    std::vector<std::size_t> strong;
    PathRandom random(seed);
    for (const SurfacePoint &place : receiver.places) {
        Sum sum;
        for (std::size_t i = 0; i < lights_.size(); ++i)
            if (lights_[i].type == LightType::Area)
                AddArea(i, place, random, sum);
            else
                AddOther(i, place, sum);
        light += sum.light, variance += sum.variance;
        truth.crossedLamps |= sum.crossedLamps, truth.contact |= sum.contact, truth.penumbra |= sum.penumbra;
        strong.insert(strong.end(), sum.strong.begin(), sum.strong.end());
    }
    std::sort(strong.begin(), strong.end());
    strong.erase(std::unique(strong.begin(), strong.end()), strong.end());
    truth.nearEdge = ShadowsChange(receiver, strong);
    const double count = double(receiver.places.size());
    truth.light = Vec3f(light / count) + receiver.ambient;
    for (std::size_t channel = 0; channel < 3; ++channel)
        truth.error[channel] = float(std::sqrt(variance[channel]) / count);
    return truth;
}

namespace {

std::string KeyOf(const SurfaceInputs &in, const DirectLights &lights, const std::vector<TruthReceiver> &receivers) {
    bench::Hash hash;
    hash.Value(kDirectVersion);
    bench::AddGeometry(hash, in.bsp);
    bench::AddSurfaces(hash, in.table);
    hash.Value(in.options.noDrawSurfaceFlags), hash.Value(in.options.patchShadows), hash.Value(in.options.noTrace);
    AddLights(hash, lights.Lights());
    for (const TruthReceiver &one : receivers) {
        hash.Value(one.places.size()), hash.Value(one.around.size()), hash.Value(one.ambient);
        for (const SurfacePoint &place : one.places) {
            hash.Value(place.position), hash.Value(place.normal);
            hash.Value(place.twoSided), hash.Value(place.receiveShadows);
        }
        for (const Vec3f &position : one.around)
            hash.Value(position);
    }
    return hash.Hex();
}

} // namespace

DirectReference MakeDirectReference(const SurfaceInputs &in, const DirectLights &lights,
                                    const std::vector<TruthReceiver> &receivers, const std::filesystem::path &cache) {
    DirectReference reference;
    reference.luxels.resize(receivers.size());
    const RecordCache kept(cache, KeyOf(in, lights, receivers), "direct");
    const std::array parts{RecordBytes(reference.luxels)};
    reference.fromCache = kept.Load(parts, reference.cpuSeconds);
    if (reference.fromCache)
        return reference;
    const CpuTimer timer;
    const DirectTruth truth(in, lights);
    in.jobs.For(std::int64_t(receivers.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        reference.luxels[i] = truth.At(receivers[i], i);
    });
    reference.cpuSeconds = timer.Seconds();
    kept.Store(parts, reference.cpuSeconds);
    return reference;
}

} // namespace q3::bounce
