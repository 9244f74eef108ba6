// GPL-2.0-or-later. Area lights as the SH grid sees them.
#include "q3map2/light/transfer/light_area.h"

#include "libs/math/low_discrepancy.h"
#include "q3map2/light/transfer/area_sampler.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

namespace q3 {

namespace {

/// Receivers nearer than this to an emitter's plane get nothing from it. Game units.
constexpr float kPlaneClearance = 1.0f / 64;
/// Lights that give less than this are judged by one ray; brighter ones by their corners. Byte scale.
constexpr float kFaint = 1.0f / 4;
/// Under this the share of the first rays that arrive is good enough for a light that is partly hidden. Byte scale.
constexpr float kRefine = 0.5f;
/// From twice this on, neighbours that see another share make it worth a closer look too; from kBright on, samples of
/// the inside look for what is smaller than a straight shadow edge. Byte scale.
constexpr float kBright = 2;
constexpr int kInnerProbes = 2;
/// A straight shadow edge that crosses a convex emitter hides or shows one of its corners, so each gets a ray, moved
/// inward by this share.
constexpr float kCornerInset = 0.01f;
/// Moments are approximated where that errs by less than this. Byte scale.
constexpr float kMomentError = 1.0f / 256;
/// Nearer than this square of size over distance the light is not like a point at all.
constexpr float kNearError = 0.25f;
/// Rays for a partly hidden light: as many as keep the expected error of the estimate under kTolerance, within these
/// limits.
constexpr float kMinRefined = 16, kMaxRefined = 1024;
/// Byte scale.
constexpr float kTolerance = 0.25f;
/// Rays end this far in front of the emitter, which is itself in the scene, or half way to its plane. Game units.
constexpr float kEmitterGap = 0.125f;

int RefinedRays(float facing, float samples) {
    // A stratified pattern's error falls about as n^-0.75, from half of the light at one ray.
    const float n = std::pow(0.5f * facing / kTolerance, 1 / 0.75f) * samples;
    return int(std::ceil(std::clamp(n, kMinRefined, kMaxRefined * samples) / float(kPacketSize))) * int(kPacketSize);
}

/// moments[k] += weight * Y[k](direction), or = instead of +=.
template <bool kAdd>
inline void BasisLanes(std::size_t i, float x, float y, float z, float weight, IncidentLight &incident) {
    const auto basis = ShBasis(Vec3f{x, y, z});
    auto &m = incident.shCoeffs;
    const auto put = [&](Lanes &row, float value) { row[i] = kAdd ? row[i] + value * weight : value * weight; };
    put(m[0], basis[0]), put(m[1], basis[1]), put(m[2], basis[2]), put(m[3], basis[3]), put(m[4], basis[4]);
    put(m[5], basis[5]), put(m[6], basis[6]), put(m[7], basis[7]), put(m[8], basis[8]);
}

/// Rays from one place to all targets.
Q3_VECTOR void AimFrom(const Vec3f &from, const Lanes3 &target, const Vec3f &lift, RayPacket &rays) {
    const Vec3f back = lift - from;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = target.x[i] + back.x, y = target.y[i] + back.y, z = target.z[i] + back.z;
        const float d = std::sqrt(x * x + y * y + z * z), divisor = d > 0 ? d : 1;
        rays.direction.x[i] = x / divisor, rays.direction.y[i] = y / divisor, rays.direction.z[i] = z / divisor;
        rays.distance[i] = d;
    }
    rays.origin.Fill(from);
    rays.live.fill(-1);
}

/// Moments of samples, a sum for each lane: of all of them and of those that are seen.
struct SampleMoments {
    std::array<Lanes, 9> whole{}, visible{};

    void Add(const AreaSamples &samples, const LaneMask &seen);
    static double Total(const Lanes &lanes) { return std::accumulate(lanes.begin(), lanes.end(), 0.0); }
};

Q3_VECTOR void SampleMoments::Add(const AreaSamples &samples, const LaneMask &seen) {
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const auto basis = ShBasis(Vec3f{samples.direction.x[i], samples.direction.y[i], samples.direction.z[i]});
        const float weight = samples.weight[i], seenWeight = seen[i] != 0 ? weight : 0;
        const auto add = [&](std::size_t k) {
            whole[k][i] += basis[k] * weight;
            visible[k][i] += basis[k] * seenWeight;
        };
        add(0), add(1), add(2), add(3), add(4), add(5), add(6), add(7), add(8);
    }
}

/// Counts the rays that arrived.
Q3_VECTOR void AddSeen(const RayPacket &rays, Lanes &clear) {
    for (std::size_t i = 0; i < kPacketSize; ++i)
        clear[i] -= float(rays.live[i]);
}

} // namespace

inline float AreaContribution::Lift(std::size_t i) const {
    const float off = std::min(kEmitterGap, 0.5f * height_[i]);
    return below_[i] != 0 ? -off : off;
}

/// How each place is to the light.
Q3_VECTOR void AreaContribution::MeasureLanes() {
    const AreaShape &shape = light_.shape;
    const bool twoSided = light_.twoSided;
    const float strength = light_.add * shape.area / std::numbers::pi_v<float>, size2 = shape.radius * shape.radius;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float px = receivers_->position.x[i], py = receivers_->position.y[i], pz = receivers_->position.z[i];
        const float s =
            float(shape.normal.x * double(px) + shape.normal.y * double(py) + shape.normal.z * double(pz) - shape.dist);
        const float x = shape.center.x - px, y = shape.center.y - py, z = shape.center.z - pz;
        const float d2 = x * x + y * y + z * z;
        height_[i] = std::abs(s);
        below_[i] = s < 0 ? -1 : 0;
        distance2_[i] = d2;
        error_[i] = d2 > 0 ? size2 / d2 : 1;
        unoccludedEstimate_[i] = d2 > 0 ? strength * height_[i] / (d2 * std::sqrt(d2)) : 0;
        const bool inFront = (height_[i] >= kPlaneClearance) & ((s > 0) | twoSided);
        live_[i] = inFront ? live_[i] : 0;
        near_[i] = error_[i] < kNearError ? 0 : live_[i];
    }
}

/// Moments of the light by their closed form.
void AreaContribution::MeasureMoments(const LaneMask &those) {
    LaneMask front, behind;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        front[i] = those[i] & ~below_[i], behind[i] = those[i] & below_[i];
    if (front.Any())
        moments_.Measure(light_.w, receivers_->position, front);
    if (behind.Any())
        moments_.Measure(light_.shape.back, receivers_->position, behind);
}

/// Moments of the light where it is near, and what it gives there.
void AreaContribution::MeasureNear() {
    MeasureMoments(near_);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        if (near_[i] != 0)
            unoccludedEstimate_[i] = light_.add * float(moments_.FirstLength(i) / std::numbers::pi);
}

/// Ends receivers out of the light's bounds and those that get at most `least`, which is not negative. What the others
/// get at most.
Q3_VECTOR float AreaContribution::CullUnlit(float least) {
    const Vec3f from = light_.bounds.mins, to = light_.bounds.maxs;
    std::int32_t brightest = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = receivers_->position.x[i], y = receivers_->position.y[i], z = receivers_->position.z[i];
        const bool lit = (unoccludedEstimate_[i] > least) & (x >= from.x) & (y >= from.y) & (z >= from.z) &
                         (x <= to.x) & (y <= to.y) & (z <= to.z);
        live_[i] = lit ? live_[i] : 0;
        brightest = std::max(brightest, OrderedBits(unoccludedEstimate_[i]) & live_[i]);
    }
    return std::bit_cast<float>(brightest);
}

/// What the light gives about to each place, without shadows. False: nothing to any.
bool AreaContribution::EstimateUnoccluded() {
    MeasureLanes();
    MeasureNear();
    brightest_ = CullUnlit(light_.fast ? light_.tolerance : 0);
    return live_.Any();
}

/// The cheapest method that is good enough for all receivers that are not near.
AreaContribution::Method AreaContribution::ChooseMethod() const {
    if (!settings_.skip.moments)
        return Method::ClosedForm;
    // As a point with a cosine the light errs by about the square of its size over its distance, by three samples a
    // triangle by the fourth power.
    float asPoint = 0, asSamples = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float light = live_[i] != 0 && near_[i] == 0 ? unoccludedEstimate_[i] * error_[i] : 0;
        asPoint = std::max(asPoint, light);
        asSamples = std::max(asSamples, light * error_[i]);
    }
    return asPoint < kMomentError ? Method::Point : asSamples < kMomentError ? Method::Quadrature : Method::ClosedForm;
}

int AreaContribution::Probes() const {
    const bool shortcuts = settings_.skip.probes;
    if (brightest_ < kFaint && shortcuts)
        return 1;
    return int(light_.w.size()) + (brightest_ < kBright && shortcuts ? 0 : kInnerProbes);
}

/// Where a probe goes, but for the lift off the emitter; the same for all receivers, so that their rays stay together.
Vec3f AreaContribution::ProbeTarget(int probe) const {
    const bool one = brightest_ < kFaint && settings_.skip.probes;
    const int corners = one ? 0 : int(light_.w.size());
    if (probe >= corners)
        return PointByArea(light_, PlasticSample(std::uint32_t(probe - corners), receivers_->index[0]));
    const Vec3f &corner = light_.w[std::size_t(probe)];
    return corner + (light_.shape.center - corner) * kCornerInset;
}

/// Rays from all live receivers to just before the target.
Q3_VECTOR void AreaContribution::AimAll(const Vec3f &target, RayPacket &rays) const {
    const Vec3f normal(light_.shape.normal);
    rays.origin = receivers_->rayOrigin;
    rays.live = live_;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float lift = Lift(i);
        const float x = target.x + normal.x * lift - rays.origin.x[i];
        const float y = target.y + normal.y * lift - rays.origin.y[i];
        const float z = target.z + normal.z * lift - rays.origin.z[i];
        const float d = std::sqrt(x * x + y * y + z * z), divisor = d > 0 ? d : 1;
        rays.direction.x[i] = x / divisor, rays.direction.y[i] = y / divisor, rays.direction.z[i] = z / divisor;
        rays.distance[i] = d;
    }
}

/// What arrived of a probe of which some was tinted, or of one after it.
void AreaContribution::AddTint(const RayPacket &rays) {
    if (!tinted_) // all before came through clear air
        firstTint_ = {clear_, clear_, clear_};
    tinted_ = true;
    for (std::size_t i = 0; i < receivers_->count; ++i)
        if (rays.live[i] != 0)
            firstTint_.Set(i, firstTint_[i] + (rays.tinted ? rays.tint[i] : Vec3f{1, 1, 1}));
}

void AreaContribution::TraceProbes(int probes) {
    clear_.fill(0);
    RayPacket rays;
    for (int probe = 0; probe < probes; ++probe) {
        AimAll(ProbeTarget(probe), rays);
        scene_.TraceToLight(rays, ShadowRules::Exact, counts_);
        if (tinted_ || rays.tinted)
            AddTint(rays);
        AddSeen(rays, clear_);
    }
}

/// Live receivers for which the first rays are not enough; the others end that none of them reached.
Q3_VECTOR LaneMask AreaContribution::LanesToRefine(int probes) {
    const float all = float(probes);
    std::int32_t anyWhole = 0, anyNotWhole = 0, anyHidden = 0, anySeen = 0;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const std::int32_t whole = -std::int32_t(clear_[i] == all), hidden = -std::int32_t(clear_[i] == 0);
        anyWhole |= live_[i] & whole, anyNotWhole |= live_[i] & ~whole;
        anyHidden |= live_[i] & hidden, anySeen |= live_[i] & ~hidden;
    }
    const std::int32_t mixed = ((anyWhole & anyNotWhole) | (anyHidden & anySeen)) != 0 ? -1 : 0;
    // Shortcuts: dim lights are sure, and receivers all alike.
    const bool shortcuts = settings_.skip.probes;
    const float partlyFrom = shortcuts ? kRefine : 0, mixedFrom = shortcuts ? 2 * kRefine : 0;
    LaneMask unsure;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const std::int32_t partly = -std::int32_t((clear_[i] != all) & (clear_[i] != 0));
        const std::int32_t asked = (partly & -std::int32_t(unoccludedEstimate_[i] >= partlyFrom)) |
                                   (mixed & -std::int32_t(unoccludedEstimate_[i] >= mixedFrom));
        unsure[i] = live_[i] & asked;
        live_[i] &= -std::int32_t(clear_[i] > 0);
    }
    return unsure;
}

/// Projections of the far light as a point, for all receivers.
Q3_VECTOR void AreaContribution::PointMoments() {
    const Vec3f center = light_.shape.center;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float d = std::sqrt(distance2_[i]), divisor = d > 0 ? d : 1;
        BasisLanes<false>(i, (center.x - receivers_->position.x[i]) / divisor,
                          (center.y - receivers_->position.y[i]) / divisor,
                          (center.z - receivers_->position.z[i]) / divisor, unoccludedEstimate_[i], *incident_);
    }
}

/// Adds a small piece of the emitter.
Q3_VECTOR void AreaContribution::AddSample(const Vec3f &at, float strength) {
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = at.x - receivers_->position.x[i], y = at.y - receivers_->position.y[i],
                    z = at.z - receivers_->position.z[i];
        const float d = std::sqrt(x * x + y * y + z * z), divisor = d > 0 ? d : 1;
        BasisLanes<true>(i, x / divisor, y / divisor, z / divisor,
                         strength * height_[i] / (divisor * divisor * divisor), *incident_);
    }
}

/// Three interior points a triangle, exact for quadratic integrands.
void AreaContribution::QuadratureMoments() {
    const Winding<float> &w = light_.w;
    const AreaShape &shape = light_.shape;
    for (Lanes &row : incident_->shCoeffs)
        row.fill(0);
    float before = 0;
    for (std::size_t t = 2; t < w.size(); ++t) {
        const float strength = light_.add * (shape.cumulative[t - 2] - before) / (3 * std::numbers::pi_v<float>);
        before = shape.cumulative[t - 2];
        const Vec3f sum = w[0] + w[t - 1] + w[t];
        for (const Vec3f &corner : {w[0], w[t - 1], w[t]}) {
            const Vec3f at = sum / 6 + corner * 0.5f;
            AddSample(at, strength);
        }
    }
}

/// Closed forms for the receivers that are near, or for all, and for those that need them for more.
void AreaContribution::TakeClosedForms(bool all, const LaneMask &refine) {
    LaneMask more, taken;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        taken[i] = all ? live_[i] : near_[i];
        more[i] = (taken[i] | refine[i]) & ~near_[i];
    }
    if (more.Any())
        MeasureMoments(more);
    if (taken.Any())
        moments_.Project(double(light_.add) / std::numbers::pi, taken, incident_->shCoeffs);
}

/// What the first rays say of the receivers that are not refined.
Q3_VECTOR void AreaContribution::SetShares(float probes, const LaneMask &refine) {
    for (std::size_t i = 0; i < kPacketSize; ++i)
        share_[i] = refine[i] != 0 ? 1 : clear_[i] / probes;
    if (!tinted_) {
        if (refine.Any()) // may find tints
            incident_->tint.Fill({1, 1, 1});
        return;
    }
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float seen = clear_[i] > 0 ? clear_[i] : 1;
        incident_->tint.x[i] = firstTint_.x[i] / seen;
        incident_->tint.y[i] = firstTint_.y[i] / seen;
        incident_->tint.z[i] = firstTint_.z[i] / seen;
    }
}

/// Projection of solid angle to light.
void AreaContribution::SetMoments(std::size_t i, const ShVector &projection) {
    const double scale = double(light_.add) / std::numbers::pi;
    for (std::size_t k = 0; k < 9; ++k)
        incident_->shCoeffs[k][i] = float(projection[k] * scale);
}

/// Corrects the closed form by what many rays see: with V and W the traced moments of the visible part and of the whole
/// and f the visible share, f * exact + V - f * W is exact where nothing or everything is hidden.
void AreaContribution::Refine(std::size_t i) {
    const int n = RefinedRays(unoccludedEstimate_[i], settings_.samples);
    const Vec3f lift = Vec3f(light_.shape.normal) * Lift(i);
    const AreaSampler sampler(light_, Corners(i), receivers_->position[i], height_[i], receivers_->index[i],
                              near_[i] != 0);
    SampleMoments moments;
    Vec3d tint;
    int clear = 0;
    ++counts_.refined;
    RayPacket rays;
    AreaSamples samples{};
    for (int first = 0; first < n; first += int(kPacketSize)) {
        sampler.Take(std::uint32_t(first), samples);
        AimFrom(receivers_->rayOrigin[i], samples.target, lift, rays);
        scene_.TraceToLight(rays, ShadowRules::Exact, counts_);
        moments.Add(samples, rays.live);
        clear += rays.live.Count();
        for (std::size_t ray = 0; rays.tinted && ray < kPacketSize; ++ray)
            if (rays.live[ray] != 0)
                tint += Vec3d(rays.tint[ray]) - Vec3d{1, 1, 1};
        tinted_ = tinted_ || rays.tinted;
    }
    live_.Set(i, clear > 0);
    if (clear == 0)
        return;
    tint += Vec3d{1, 1, 1} * double(clear);
    const double share = double(clear) / n;
    ShVector projection = moments_.Of(i).Projection();
    for (std::size_t k = 0; k < 9; ++k) {
        const double visible = SampleMoments::Total(moments.visible[k]), whole = SampleMoments::Total(moments.whole[k]);
        projection[k] = share * projection[k] + (visible - share * whole) / n;
    }
    SetMoments(i, projection);
    incident_->tint.Set(i, Vec3f(tint / double(clear)));
}

/// From light to what is stored.
Q3_VECTOR void AreaContribution::Convolve() {
    const float fromAll = float(4 * std::numbers::pi * kShC0);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        incident_->add[i] = incident_->shCoeffs[0][i] * share_[i] * weight_ * fromAll;
    for (std::size_t k = 0; k < 9; ++k) {
        const float scale = weight_ * (settings_.radiance ? 1 : float(kCosineLobe[k]));
        for (std::size_t i = 0; i < kPacketSize; ++i)
            incident_->shCoeffs[k][i] = live_[i] != 0 ? incident_->shCoeffs[k][i] * share_[i] * scale : 0;
    }
}

void AreaContribution::Add(ReceiverBatch &receivers, IncidentLight &incident) {
    receivers_ = &receivers;
    incident_ = &incident;
    weight_ = givenWeight_;
    tinted_ = false;
    live_ = incident_->live;
    incident_->live = {};
    const int inSight = live_.Count();
    const bool any = light_.w.size() >= 3 && EstimateUnoccluded();
    counts_.skippedFacing += std::uint64_t(any ? inSight - live_.Count() : inSight);
    if (!any)
        return;
    if (!SelectFaintLight(settings_.faint, brightest_, *receivers_, weight_)) {
        counts_.skippedFaint += std::uint64_t(live_.Count());
        return;
    }
    const int probes = Probes();
    counts_.skippedProbes += std::uint64_t(probes == 1 ? live_.Count() : 0);
    TraceProbes(probes);
    const LaneMask refine = LanesToRefine(probes);
    if (!live_.Any() && !refine.Any())
        return;
    const Method method = ChooseMethod();
    if (method == Method::Point)
        PointMoments();
    else if (method == Method::Quadrature)
        QuadratureMoments();
    counts_.skippedMoments += std::uint64_t(method == Method::ClosedForm ? 0 : live_.Count());
    TakeClosedForms(method == Method::ClosedForm, refine);
    SetShares(float(probes), refine);
    for (unsigned lanes = refine.Bits(); lanes != 0; lanes &= lanes - 1)
        Refine(std::size_t(std::countr_zero(lanes)));
    Convolve();
    incident_->direction = {};
    incident_->tinted = tinted_;
    incident_->live = live_;
}

} // namespace q3
