// GPL-2.0-or-later. Soft shadows on surfaces (-areashadows): area lights, and the samples of suns, skies and points.
#include "libs/math/sampling.h"
#include "q3map2/light/batch/form_factor.h"
#include "q3map2/light/sources/falloff.h"
#include "q3map2/light/transfer/area_sampler.h"
#include "q3map2/light/transfer/light_kernel.h"
#include "q3map2/light/transfer/soft_light.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

namespace q3 {

namespace {

/// Where the receivers of a batch start in the sequence of points: an ordered dither, so that neighbors in a tile of
/// 4 x 4 luxels look at parts far from each other. For area lights these are cells of a grid of 4 x 4 over the unit
/// square, for sampled lights sixteenths of the list of samples.
constexpr std::array<std::uint8_t, kPacketSize> kDither{0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
/// Area lights: from these strengths on, receivers cast two and four rays before they are compared. Byte scale.
constexpr float kTwoRaysFrom = 2, kFourRaysFrom = 16;
/// Area lights: rays for receivers whose first ones all went to points below their horizon.
constexpr int kUntriedRays = 8;
/// Area lights: expected error of the light of a receiver that sees the light partly. Byte scale.
constexpr float kShareError = 0.25f;
/// Area lights: luxels beside a lamp often lie in its plane, with half of their area in front of it. The light of
/// luxels within kInPlane of the plane is taken at kLiftedHeight, about the middle of that half; their rays start at
/// kInPlane. Game units.
constexpr float kInPlane = 1, kLiftedHeight = 4;
/// Area lights: receivers that still agree with themselves after this part of their rays, and at least kLeastSecondRays
/// more than the first ones, cast no more.
constexpr int kSecondPart = 4, kLeastSecondRays = 4;
/// Sampled lights: the first rays are one for so many samples.
constexpr int kSamplesPerFirstRay = 8;

} // namespace

// ---- Area lights ----

/// Where the light of the receivers is taken and where their rays start, with the height over the plane of the light.
/// Those behind a one-sided light, on its own surface or beyond its envelope are live no longer.
void SoftAreaLight::MeasureSides(SoftBatch &batch) const {
    Vectorize([&]() Q3_INLINE {
        const AreaShape &shape = light_.shape;
        const Lanes3 &p = batch.receivers->position, &n = batch.receivers->normal;
        SurfaceIncidentLight &incident = batch.incident;
        const Vec3f facing(shape.normal);
        const bool twoSided = light_.twoSided;
        const float envelope = light_.envelope;
        const bool areLuxels = batch.kind == SoftReceivers::Luxels;
        const float least = areLuxels ? kInPlane : kPlaneClearance,
                    lifted = areLuxels ? kLiftedHeight : kPlaneClearance;
        for (const std::size_t i : kEachLane) {
            const float height = float(shape.normal.x * double(p.x[i]) + shape.normal.y * double(p.y[i]) +
                                       shape.normal.z * double(p.z[i]) - shape.dist);
            const float along = n.x[i] * facing.x + n.y[i] * facing.y + n.z[i] * facing.z;
            const bool behind = height < (twoSided ? 0 : -kPlaneClearance);
            const float side = behind ? -1.0f : 1.0f;
            const bool inPlane = side * height < least;
            const float push = inPlane ? side * least - height : 0, lift = inPlane ? side * lifted - height : 0;
            batch.rayOrigin.x[i] = p.x[i] + facing.x * push;
            batch.rayOrigin.y[i] = p.y[i] + facing.y * push;
            batch.rayOrigin.z[i] = p.z[i] + facing.z * push;
            batch.position.x[i] = p.x[i] + facing.x * lift;
            batch.position.y[i] = p.y[i] + facing.y * lift;
            batch.position.z[i] = p.z[i] + facing.z * lift;
            batch.height[i] = std::abs(height + push);
            batch.behind[i] = behind ? -1 : 0;
            const bool onEmitter = (side * height < kAreaOwnSide) & (side * along > kAreaOwnCosine);
            const bool lit = (int(!behind) | int(twoSided)) & !onEmitter & (incident.distance[i] < envelope);
            incident.live[i] = lit ? incident.live[i] : 0;
        }
    });
}

/// Sets the normals of the sides that face the light's center, and `undirected` of receivers that are lit from behind.
/// Receivers with the whole light below their horizon are live no longer. Returns whether one has a part of it there.
bool SoftAreaLight::MeasureHorizons(SoftBatch &batch) const {
    return Vectorize([&]() Q3_INLINE {
        const Lanes3 &p = batch.position;
        Lanes3 &n = batch.normal;
        SurfaceIncidentLight &incident = batch.incident;
        const Vec3f center = light_.shape.center;
        const bool twoSided = batch.receivers->twoSided;
        n = batch.receivers->normal;
        Lanes lowest, highest;
        for (const std::size_t i : kEachLane) {
            const float facing =
                (center.x - p.x[i]) * n.x[i] + (center.y - p.y[i]) * n.y[i] + (center.z - p.z[i]) * n.z[i];
            const bool flips = twoSided & (facing < 0);
            const float side = flips ? -1.0f : 1.0f;
            incident.undirected[i] = flips ? -1 : 0;
            n.x[i] *= side, n.y[i] *= side, n.z[i] *= side;
            lowest[i] = highest[i] = facing * side;
        }
        for (const Vec3f corner : light_.polygon)
            for (const std::size_t i : kEachLane) {
                const float height =
                    (corner.x - p.x[i]) * n.x[i] + (corner.y - p.y[i]) * n.y[i] + (corner.z - p.z[i]) * n.z[i];
                lowest[i] = std::min(lowest[i], height), highest[i] = std::max(highest[i], height);
            }
        std::int32_t crossing = 0;
        for (const std::size_t i : kEachLane) {
            incident.live[i] = highest[i] > 0 ? incident.live[i] : 0;
            crossing |= lowest[i] < 0 ? incident.live[i] : 0;
        }
        return crossing != 0;
    });
}

/// strength = radiosity F, and the vectors and fluences. isCrossing: a receiver has a part of the light below its
/// horizon. The fluence is that of a cone with the same irradiance vector.
void SoftAreaLight::MeasureVectors(bool isCrossing, SoftBatch &batch) const {
    Vectorize([&, isCrossing]() Q3_INLINE {
        Lanes3 &v = batch.vector;
        SurfaceIncidentLight &incident = batch.incident;
        const Lanes3 &n = batch.normal;
        if (isCrossing)
            FormFactorVectorsAbove(batch.position, n, light_.polygon, v);
        else
            FormFactorVectors(batch.position, light_.polygon, v);
        const float radiosity = light_.radiosity;
        for (const std::size_t i : kEachLane) {
            const float side = batch.behind[i] != 0 ? -1.0f : 1.0f; // from behind, the polygon runs the other way round
            const float x = v.x[i] * side, y = v.y[i] * side, z = v.z[i] * side;
            const float formFactor = x * n.x[i] + y * n.y[i] + z * n.z[i];
            const bool directed = (formFactor > 0) & (incident.undirected[i] == 0);
            const float scale = directed ? 1 / formFactor : 0;
            const float sine2 = std::min(1.0f, std::sqrt(x * x + y * y + z * z));
            incident.strength[i] = radiosity * formFactor;
            v.x[i] = x * scale, v.y[i] = y * scale, v.z[i] = z * scale;
            batch.fluence[i] = scale * sine2 * 2 / (1 + std::sqrt(1 - sine2));
        }
    });
}

void SoftAreaLight::SetUnshadowed(SoftBatch &batch) const {
    if (light_.polygon.size() < 3) {
        batch.incident.live = {};
        return;
    }
    AimAt(light_.origin, batch.receivers->position, batch.incident);
    MeasureSides(batch);
    if (!batch.incident.live.Any())
        return;
    const bool isCrossing = MeasureHorizons(batch);
    if (!batch.incident.live.Any())
        return;
    MeasureVectors(isCrossing, batch);
    CullBelowTolerance(light_, batch.incident);
}

void SoftAreaLight::Aim(const SoftBatch &batch, std::uint32_t number, PointRays &to) const {
    AimLanes(batch, number, to);
}

/// A point gives cos cos' / d^2, with the cosines at the receiver and at the light.
void SoftAreaLight::AimLanes(const SoftBatch &batch, std::uint32_t number, PointRays &to) const {
    Vectorize([&, number]() Q3_INLINE {
        const Sample2 start = PlasticSample(number, batch.seed);
        Lanes u, v;
        for (const std::size_t i : kEachLane) {
            const float x = float(start.u) + 0.25f * float(kDither[i] & 3);
            const float y = float(start.v) + 0.25f * float(kDither[i] >> 2);
            u[i] = x - std::floor(x), v[i] = y - std::floor(y);
        }
        Lanes3 target;
        PointsByArea(light_, u, v, target);
        const Vec3f n(light_.shape.normal);
        const Lanes3 &normal = batch.normal;
        RayPacket &rays = to.rays;
        rays.origin = batch.rayOrigin;
        for (const std::size_t i : kEachLane) {
            const float gap = std::min(kEmitterGap, 0.5f * batch.height[i]), lift = batch.behind[i] != 0 ? -gap : gap;
            const auto [x, y, z, d] =
                DirectionOf(target.x[i] + n.x * lift - rays.origin.x[i], target.y[i] + n.y * lift - rays.origin.y[i],
                            target.z[i] + n.z * lift - rays.origin.z[i]);
            rays.direction.x[i] = x, rays.direction.y[i] = y, rays.direction.z[i] = z;
            rays.distance[i] = d;
            const float cosine = x * normal.x[i] + y * normal.y[i] + z * normal.z[i];
            const float vector = std::abs(x * n.x + y * n.y + z * n.z) / (d * d);
            to.strength[i] = cosine > 0 ? cosine * vector : 0;
            to.vector[i] = batch.incident.undirected[i] != 0 ? 0 : vector;
            rays.live[i] = cosine > 0 ? -1 : 0;
        }
        rays.ignoredProp = settings_.ignoredProp;
    });
}

int SoftAreaLight::FirstRays(float strongest, int factor) const {
    const int rays = strongest < kTwoRaysFrom ? 1 : strongest < kFourRaysFrom ? 2 : 4;
    return std::min(rays * factor, settings_.areaShadows);
}

void SoftAreaLight::CastMoreRays(SoftBatch &batch, const LaneMask &doubtful) const {
    const float color = MaxAbsComponent(light_.color);
    std::array<int, kPacketSize> wanted{};
    int most = 0;
    for (unsigned lanes = doubtful.Bits(); lanes != 0; lanes &= lanes - 1) {
        const auto i = std::size_t(std::countr_zero(lanes));
        const float rays = RaysForShare(color * batch.incident.strength[i], kShareError);
        const float least = batch.whole[i] > 0 ? 0 : float(batch.rays + kUntriedRays);
        wanted[i] = int(std::ceil(std::min(std::max(rays, least), float(settings_.areaShadows))));
        most = std::max(most, wanted[i]);
    }
    // Rays of several rounds share packets, since few receivers of a batch may cast any.
    struct Owner {
        std::size_t receiver;
        float strength, vector;
    };
    auto queue = MakeRayBatcher<Owner>([&](RayPacket &packet, std::span<const Owner> owners) {
        packet.ignoredProp = settings_.ignoredProp;
        Cast(packet);
        for (std::size_t ray = 0; ray < owners.size(); ++ray)
            AddRay(packet, ray, owners[ray].receiver, owners[ray].strength, owners[ray].vector, batch);
    });
    LaneMask asking = doubtful;
    PointRays to;
    for (int number = batch.rays; number < most; ++number) {
        Aim(batch, std::uint32_t(number), to);
        for (unsigned lanes = asking.Bits(); lanes != 0; lanes &= lanes - 1) {
            const auto i = std::size_t(std::countr_zero(lanes));
            if (number >= wanted[i])
                continue;
            if (number == std::max(batch.rays + kLeastSecondRays, wanted[i] / kSecondPart)) {
                queue.Flush();
                if (batch.seen[i] == 0 || batch.seen[i] == batch.whole[i]) {
                    asking[i] = 0;
                    continue;
                }
            }
            batch.whole[i] += to.strength[i];
            if (to.rays.live[i] != 0)
                queue.Add({i, to.strength[i], to.vector[i]}, to.rays.origin[i], to.rays.direction[i],
                          to.rays.distance[i]);
        }
    }
    queue.Flush();
}

// ---- The samples of one sun, sky or point light ----

bool SoftSampledLight::CanGroup(const Light &light, const SurfaceLightSettings &settings) {
    return light.type != LightType::Area && settings.HasSoftShadows() && !settings.halfLambert && light.IsTimesCosine();
}

SoftSampledLight::SoftSampledLight(const LightGroup &group, const SurfaceLightSettings &settings,
                                   const LightScene &scene, ContributionCounts &counts)
    : SoftLight(group.First(), settings, scene, counts), samples_(group.Samples()), color_(group.Color()),
      isColored_(group.ColorsDiffer()) {
    constexpr double kGolden = 0.6180339887498949;
    step_ = std::max<std::size_t>(1, std::size_t(std::lround(kGolden * double(samples_.size()))));
    while (std::gcd(step_, samples_.size()) != 1)
        ++step_;
    for (const Light *sample : samples_) {
        Vec3f &color = colors_.emplace_back();
        for (std::size_t channel = 0; channel < 3; ++channel)
            color[channel] = color_[channel] != 0 ? sample->color[channel] / color_[channel] : 0;
    }
}

int SoftSampledLight::FirstRays(float, int factor) const {
    const int count = int(samples_.size());
    return std::min(count, factor * std::max(1, count / kSamplesPerFirstRay));
}

LaneMask SoftSampledLight::FindInSight(const SurfaceReceiverBatch &receivers) const {
    LaneMask live = SoftLight::FindInSight(receivers);
    for (const Light *sample : samples_) // all suns are seen from the same places
        if (light_.type != LightType::Sun) {
            const LaneMask sees = InSight(*sample, true, receivers, counts_);
            for (const std::size_t i : kEachLane)
                live[i] |= sees[i];
        }
    return live;
}

void SoftSampledLight::Cast(RayPacket &rays) const {
    if (light_.type == LightType::Sun)
        scene_.TraceSurfaceToSky(rays, light_.skyIndex, settings_.receiveShadows, counts_);
    else
        SoftLight::Cast(rays);
}

namespace {

/// One sample at the receivers of a batch: unit direction, distance, cosine to the normal, and the light with and
/// without that cosine.
struct SampleHere {
    Vec3f direction;
    float distance, cosine, strength, facing;
};

SampleHere At(const Light &light, const Vec3f &position, const Vec3f &normal, bool twoSided) {
    SampleHere here;
    if (light.type == LightType::Sun) {
        here.direction = -light.normal, here.distance = kSunDistance;
        here.facing = light.photons;
    } else {
        const auto [x, y, z, d] =
            DirectionOf(light.origin.x - position.x, light.origin.y - position.y, light.origin.z - position.z);
        here.direction = {x, y, z}, here.distance = d;
        here.facing = d < light.envelope ? Falloff(light).At(d) : 0;
        if (light.type == LightType::Spot)
            here.facing *= ConeFraction(light, here.direction * d);
    }
    here.cosine = Dot(here.direction, normal);
    here.strength = here.facing * (twoSided ? std::abs(here.cosine) : std::max(0.0f, here.cosine));
    if (light.type != LightType::Sun && here.strength <= (light.endsAtTolerance ? light.tolerance : 0))
        here.strength = here.facing = 0;
    return here;
}

} // namespace

/// Adds what a sample gives without shadows to the sums of a batch.
void SoftSampledLight::AddSample(const PointRays &to, const Vec3f &color, SoftBatch &batch) {
    Vectorize([&]() Q3_INLINE {
        const Vec3f c = color;
        const Lanes3 &u = to.rays.direction;
        for (const std::size_t i : kEachLane) {
            const float strength = to.strength[i], vector = to.vector[i];
            batch.incident.strength[i] += strength;
            batch.fluence[i] += vector;
            batch.vector.x[i] += u.x[i] * vector, batch.vector.y[i] += u.y[i] * vector,
                batch.vector.z[i] += u.z[i] * vector;
            batch.color.x[i] += c.x * strength, batch.color.y[i] += c.y * strength, batch.color.z[i] += c.z * strength;
        }
    });
}

void SoftSampledLight::SetUnshadowed(SoftBatch &batch) const {
    batch.normal = batch.receivers->normal;
    batch.incident.strength = batch.fluence = {};
    batch.vector = batch.color = {};
    PointRays to;
    for (std::size_t sample = 0; sample < samples_.size(); ++sample) {
        AimFromAll(batch, sample, to);
        AddSample(to, colors_[sample], batch);
    }
    for (const std::size_t i : kEachLane) {
        const float strength = batch.incident.strength[i], scale = strength > 0 ? 1 / strength : 0;
        batch.incident.live[i] = strength > 0 ? batch.incident.live[i] : 0;
        batch.vector.Set(i, batch.vector[i] * scale);
        batch.fluence[i] *= scale;
    }
}

void SoftSampledLight::Aim(const SoftBatch &batch, std::uint32_t number, PointRays &to) const {
    const SurfaceReceiverBatch &receivers = *batch.receivers;
    const std::size_t count = samples_.size();
    const std::size_t start = std::size_t(batch.seed % count) + number * step_;
    ClearRays(receivers, to);
    for (std::size_t i = 0; i < receivers.count; ++i)
        if (batch.incident.live[i] != 0)
            AimFrom(batch, i, (start + kDither[i] * count / kPacketSize) % count, to);
}

void SoftSampledLight::ClearRays(const SurfaceReceiverBatch &receivers, PointRays &to) const {
    to.rays.origin = receivers.rayOrigin;
    to.rays.direction = {}, to.rays.distance = {};
    to.rays.live = {};
    to.rays.ignoredProp = settings_.ignoredProp;
    to.strength = to.vector = {};
    to.color = {};
}

/// The ray of one receiver to a sample.
void SoftSampledLight::AimFrom(const SoftBatch &batch, std::size_t receiver, std::size_t sample, PointRays &to) const {
    const SurfaceReceiverBatch &receivers = *batch.receivers;
    const SampleHere here =
        At(*samples_[sample], receivers.position[receiver], receivers.normal[receiver], receivers.twoSided);
    if (!(here.strength > 0))
        return;
    to.rays.Set(receiver, receivers.rayOrigin[receiver], here.direction, here.distance);
    to.strength[receiver] = here.strength;
    to.vector[receiver] = here.cosine > 0 ? here.facing : 0;
    to.color.Set(receiver, colors_[sample]);
}

/// The rays of all receivers to a sun.
void SoftSampledLight::AimAtSun(const SoftBatch &batch, std::size_t sample, PointRays &to) const {
    Vectorize([&, sample]() Q3_INLINE {
        const Light &sun = *samples_[sample];
        const Lanes3 &n = batch.receivers->normal;
        const Vec3f u = -sun.normal;
        const float photons = sun.photons;
        const bool twoSided = batch.receivers->twoSided;
        to.rays.origin = batch.receivers->rayOrigin;
        to.rays.direction.Fill(u);
        to.rays.distance.fill(kSunDistance);
        to.rays.ignoredProp = settings_.ignoredProp;
        for (const std::size_t i : kEachLane) {
            const float cosine = u.x * n.x[i] + u.y * n.y[i] + u.z * n.z[i];
            const float strength = photons * (twoSided ? std::abs(cosine) : std::max(0.0f, cosine));
            to.strength[i] = strength;
            to.vector[i] = cosine > 0 ? photons : 0;
            to.rays.live[i] = strength > 0 ? -1 : 0;
        }
        to.color.Fill(colors_[sample]);
    });
}

/// The rays of all live receivers to a sample.
void SoftSampledLight::AimFromAll(const SoftBatch &batch, std::size_t sample, PointRays &to) const {
    if (light_.type == LightType::Sun)
        return AimAtSun(batch, sample, to);
    ClearRays(*batch.receivers, to);
    for (std::size_t i = 0; i < batch.receivers->count; ++i)
        if (batch.incident.live[i] != 0)
            AimFrom(batch, i, sample, to);
}

void SoftSampledLight::CastMoreRays(SoftBatch &batch, const LaneMask &doubtful) const {
    if (!doubtful.Any())
        return;
    for (Lanes *sum : {&batch.whole, &batch.seen, &batch.seenFluence, &batch.seenVector.x, &batch.seenVector.y,
                       &batch.seenVector.z, &batch.wholeColor.x, &batch.wholeColor.y, &batch.wholeColor.z,
                       &batch.seenColor.x, &batch.seenColor.y, &batch.seenColor.z})
        for (const std::size_t i : kEachLane)
            (*sum)[i] = doubtful[i] != 0 ? 0 : (*sum)[i];
    PointRays to;
    for (std::size_t sample = 0; sample < samples_.size(); ++sample) {
        AimFromAll(batch, sample, to);
        CastAndCount(doubtful, to, batch);
    }
}

} // namespace q3
