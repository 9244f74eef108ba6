// GPL-2.0-or-later. Area lights in the SH grid.
#include "q3map2/light/transfer/light_area.h"

#include "libs/math/sampling.h"
#include "q3map2/light/transfer/area_sampler.h"
#include "q3map2/light/transfer/light_contribution.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>

namespace q3 {

namespace {

/// Lights that give less than this get one probe ray; brighter ones a ray to each corner. Byte scale.
constexpr float kFaint = 1.0f / 4;
/// Receivers that a light is partly hidden from are refined if it gives them at least this; else it is scaled by the
/// fraction of probe rays that arrive. Byte scale.
constexpr float kRefineFrom = 0.5f;
/// Receivers that get at least this are also refined where visibility differs within the batch. Byte scale.
constexpr float kRefineMixedFrom = 2 * kRefineFrom;
/// From kBright on (byte scale), kInnerProbes more probe rays to the inside of the emitter find small blockers that
/// rays to its corners miss.
constexpr float kBright = 2;
constexpr int kInnerProbes = 2;
/// A straight shadow edge across a convex emitter separates its corners, so each gets a probe ray, moved toward the
/// center by this fraction.
constexpr float kCornerInset = 0.01f;
/// Projections are approximated where the error stays below this. Byte scale.
constexpr float kMaxProjectionError = 1.0f / 256;
/// From this (radius / distance)^2 on, a light is too near for any approximation.
constexpr float kNearPointError = 0.25f;
/// Limits of the number of rays to a partly hidden light.
constexpr float kMinRefinedRays = 16, kMaxRefinedRays = 1024;
/// Expected error that determines this number. Byte scale.
constexpr float kRefinedError = 0.25f;

/// Number of rays to a partly hidden light that gives about `estimate`: that of RaysForShare times `samples`, in whole
/// packets.
int RefinedRays(float estimate, float samples) {
    const float n = RaysForShare(estimate, kRefinedError) * samples;
    return int(std::ceil(std::clamp(n, kMinRefinedRays, kMaxRefinedRays * samples) / AreaSampler::kSamplesPerCall)) *
           AreaSampler::kSamplesPerCall;
}

enum class Assign { Set, Add };

/// Coefficient k of lane i: = weight * Y[k](x y z), or += with Assign::Add.
template <Assign kAssign>
inline void BasisLanes(std::size_t i, float x, float y, float z, float weight, ProbeIncidentLight &incident) {
    const auto basis = SHBasis(Vec3f{x, y, z});
    auto &m = incident.shCoeffs;
    const auto put = [&](Lanes &row, float value) {
        row[i] = kAssign == Assign::Add ? row[i] + value * weight : value * weight;
    };
    put(m[0], basis[0]), put(m[1], basis[1]), put(m[2], basis[2]), put(m[3], basis[3]), put(m[4], basis[4]);
    put(m[5], basis[5]), put(m[6], basis[6]), put(m[7], basis[7]), put(m[8], basis[8]);
}

/// Rays from one receiver to sixteen targets, each moved by `lift`.
void AimFrom(const Vec3f &from, const Lanes3 &target, const Vec3f &lift, RayPacket &rays) {
    Vectorize([&]() Q3_INLINE {
        const Vec3f back = lift - from;
        for (const std::size_t i : kEachLane) {
            const auto [x, y, z, d] = DirectionOf(target.x[i] + back.x, target.y[i] + back.y, target.z[i] + back.z);
            rays.direction.x[i] = x, rays.direction.y[i] = y, rays.direction.z[i] = z;
            rays.distance[i] = d;
        }
        rays.origin.Fill(from);
        rays.live.fill(-1);
    });
}

/// Weighted sums of Y[k](direction) over samples, one per lane: over all of them, and over the visible ones.
struct SampleMoments {
    std::array<Lanes, 9> whole{}, visible{};

    void Add(const AreaSamples &samples, const LaneMask &seen);
    static double Total(const Lanes &lanes) { return std::accumulate(lanes.begin(), lanes.end(), 0.0); }
};

void SampleMoments::Add(const AreaSamples &samples, const LaneMask &seen) {
    Vectorize([&]() Q3_INLINE {
        for (const std::size_t i : kEachLane) {
            const auto basis = SHBasis(Vec3f{samples.direction.x[i], samples.direction.y[i], samples.direction.z[i]});
            const float weight = samples.weight[i], seenWeight = seen[i] != 0 ? weight : 0;
            const auto add = [&](std::size_t k) {
                whole[k][i] += basis[k] * weight;
                visible[k][i] += basis[k] * seenWeight;
            };
            add(0), add(1), add(2), add(3), add(4), add(5), add(6), add(7), add(8);
        }
    });
}

/// Adds 1 to each lane whose ray arrived: `live` is -1 there, else 0.
void CountArrived(const RayPacket &rays, Lanes &arrived) {
    Vectorize([&]() Q3_INLINE {
        for (const std::size_t i : kEachLane)
            arrived[i] -= float(rays.live[i]);
    });
}

} // namespace

inline float AreaContribution::EmitterOffset(std::size_t i) const {
    const float off = std::min(kEmitterGap, 0.5f * height_[i]);
    return behind_[i] != 0 ? -off : off;
}

/// Height h over the emitter's plane and, with A the area and r the radius of the emitter and d the distance to its
/// center: unoccluded estimate radiosity A h / (pi d^3), error as a point (r / d)^2. Receivers behind a one-sided light
/// are live no longer.
void AreaContribution::MeasureLanes() {
    Vectorize([&]() Q3_INLINE {
        const AreaShape &shape = light_.shape;
        const bool twoSided = light_.twoSided;
        const float strength = light_.radiosity * shape.area / std::numbers::pi_v<float>,
                    size2 = shape.radius * shape.radius;
        for (const std::size_t i : kEachLane) {
            const float px = receivers_->position.x[i], py = receivers_->position.y[i], pz = receivers_->position.z[i];
            const float signedHeight = float(shape.normal.x * double(px) + shape.normal.y * double(py) +
                                             shape.normal.z * double(pz) - shape.dist);
            const float x = shape.center.x - px, y = shape.center.y - py, z = shape.center.z - pz;
            const float d2 = x * x + y * y + z * z;
            height_[i] = std::abs(signedHeight);
            behind_[i] = signedHeight < 0 ? -1 : 0;
            pointError_[i] = d2 > 0 ? size2 / d2 : 1;
            unoccludedEstimate_[i] = d2 > 0 ? strength * height_[i] / (d2 * std::sqrt(d2)) : 0;
            const bool inFront = (std::abs(signedHeight) >= kPlaneClearance) & (int(signedHeight > 0) | int(twoSided));
            live_[i] = inFront ? live_[i] : 0;
            near_[i] = pointError_[i] < kNearPointError ? 0 : live_[i];
        }
    });
}

/// Closed-form moments of the emitter's polygon, from the side that each receiver sees.
void AreaContribution::MeasureMoments(const LaneMask &lanes) {
    LaneMask front, behind;
    for (const std::size_t i : kEachLane)
        front[i] = lanes[i] & ~behind_[i], behind[i] = lanes[i] & behind_[i];
    if (front.Any())
        moments_.Measure(light_.polygon, receivers_->position, front);
    if (behind.Any())
        moments_.Measure(light_.shape.back, receivers_->position, behind);
}

/// MeasureMoments for the near receivers, and the unoccluded estimate from the moments: radiosity |m1| / pi, m1 the
/// first moment.
void AreaContribution::MeasureNear() {
    MeasureMoments(near_);
    for (const std::size_t i : kEachLane)
        if (near_[i] != 0)
            unoccludedEstimate_[i] = light_.radiosity * float(moments_.FirstLength(i) / std::numbers::pi);
}

/// Receivers outside the light's bounds and those that get at most `least` (>= 0) are live no longer. Returns the
/// greatest estimate of the remaining ones.
float AreaContribution::CullUnlit(float least) {
    return Vectorize([&, least]() Q3_INLINE {
        const Vec3f from = light_.bounds.mins, to = light_.bounds.maxs;
        float brightest = 0;
        for (const std::size_t i : kEachLane) {
            const float x = receivers_->position.x[i], y = receivers_->position.y[i], z = receivers_->position.z[i];
            const float estimate = unoccludedEstimate_[i];
            const bool lit = (estimate > least) & (x >= from.x) & (y >= from.y) & (z >= from.z) & (x <= to.x) &
                             (y <= to.y) & (z <= to.z);
            live_[i] = lit ? live_[i] : 0;
            brightest = std::max(brightest, live_[i] != 0 ? estimate : 0);
        }
        return brightest;
    });
}

/// Sets unoccludedEstimate_ and brightest_. False: no receiver gets any light.
bool AreaContribution::EstimateUnoccluded() {
    MeasureLanes();
    MeasureNear();
    brightest_ = CullUnlit(light_.endsAtTolerance ? light_.tolerance : 0);
    SetPartFractions();
    return live_.Any();
}

/// Sets partFraction_; receivers at which the part is 0 are live no longer.
void AreaContribution::SetPartFractions() {
    Vectorize([&]() Q3_INLINE {
        partFraction_.fill(1);
        if (settings_.part == LightPart::Whole)
            return;
        const float color = MaxAbsComponent(light_.color), weakBelow = settings_.weakBelow;
        for (const std::size_t i : kEachLane) {
            partFraction_[i] = FractionOfPart(settings_.part, color * unoccludedEstimate_[i], weakBelow);
            live_[i] = partFraction_[i] > 0 ? live_[i] : 0;
        }
    });
}

/// The cheapest method whose error is under kMaxProjectionError for all receivers that are not near.
AreaContribution::Method AreaContribution::ChooseMethod() const {
    if (!settings_.skip.moments)
        return Method::ClosedForm;
    // Relative errors: as a point about (radius / distance)^2, by three samples per triangle about its square.
    float asPoint = 0, asSamples = 0;
    for (const std::size_t i : kEachLane) {
        const float error = live_[i] != 0 && near_[i] == 0 ? unoccludedEstimate_[i] * pointError_[i] : 0;
        asPoint = std::max(asPoint, error);
        asSamples = std::max(asSamples, error * pointError_[i]);
    }
    return asPoint < kMaxProjectionError     ? Method::Point
           : asSamples < kMaxProjectionError ? Method::Quadrature
                                             : Method::ClosedForm;
}

int AreaContribution::ProbeCount() const {
    const bool shortcuts = settings_.skip.probes;
    if (brightest_ < kFaint && shortcuts)
        return 1;
    return int(light_.polygon.size()) + (brightest_ < kBright && shortcuts ? 0 : kInnerProbes);
}

/// Point of the emitter for a probe ray: the same for all receivers, so that their rays are coherent.
Vec3f AreaContribution::ProbeTarget(int probe) const {
    const bool onlyOne = brightest_ < kFaint && settings_.skip.probes;
    const int corners = onlyOne ? 0 : int(light_.polygon.size());
    if (probe >= corners)
        return SampleUniformArea(light_, PlasticSample(std::uint32_t(probe - corners), receivers_->index[0]));
    const Vec3f &corner = light_.polygon[std::size_t(probe)];
    return corner + (light_.shape.center - corner) * kCornerInset;
}

/// Rays from all live receivers to a point of the emitter, ending EmitterOffset in front of it.
void AreaContribution::AimAll(const Vec3f &target, RayPacket &rays) const {
    Vectorize([&]() Q3_INLINE {
        const Vec3f normal(light_.shape.normal);
        rays.origin = receivers_->rayOrigin;
        rays.live = live_;
        for (const std::size_t i : kEachLane) {
            const float lift = EmitterOffset(i);
            const auto [x, y, z, d] = DirectionOf(target.x + normal.x * lift - rays.origin.x[i],
                                                  target.y + normal.y * lift - rays.origin.y[i],
                                                  target.z + normal.z * lift - rays.origin.z[i]);
            rays.direction.x[i] = x, rays.direction.y[i] = y, rays.direction.z[i] = z;
            rays.distance[i] = d;
        }
    });
}

/// Adds the transmittances of one probe ray per receiver; called from the first time on that a ray was tinted.
void AreaContribution::AddTint(const RayPacket &rays) {
    if (!tinted_) // all rays so far were untinted
        tintSum_ = {arrived_, arrived_, arrived_};
    tinted_ = true;
    for (std::size_t i = 0; i < receivers_->count; ++i)
        if (rays.live[i] != 0)
            tintSum_.Set(i, tintSum_[i] + (rays.tinted ? rays.tint[i] : Vec3f{1, 1, 1}));
}

void AreaContribution::TraceProbes(int probes) {
    arrived_.fill(settings_.shadows ? 0 : float(probes));
    if (!settings_.shadows)
        return;
    RayPacket rays;
    for (int probe = 0; probe < probes; ++probe) {
        AimAll(ProbeTarget(probe), rays);
        scene_.TraceToLight(rays, ShadowRules::Exact, counts_);
        if (tinted_ || rays.tinted)
            AddTint(rays);
        CountArrived(rays, arrived_);
    }
}

/// Live receivers whose visibility the probe rays leave uncertain. Receivers from which no probe ray arrived are live
/// no longer; Refine makes those to be refined live again.
LaneMask AreaContribution::LanesToRefine(int probes) {
    return Vectorize([&, probes]() Q3_INLINE {
        const float allProbes = float(probes);
        std::int32_t anyWhole = 0, anyNotWhole = 0, anyHidden = 0, anySeen = 0;
        for (const std::size_t i : kEachLane) {
            const std::int32_t whole = -std::int32_t(arrived_[i] == allProbes),
                               hidden = -std::int32_t(arrived_[i] == 0);
            anyWhole |= live_[i] & whole, anyNotWhole |= live_[i] & ~whole;
            anyHidden |= live_[i] & hidden, anySeen |= live_[i] & ~hidden;
        }
        const bool comparesNeighbors = settings_.part != LightPart::Weak; // else receivers may be far apart
        const std::int32_t mixed =
            comparesNeighbors && ((anyWhole & anyNotWhole) | (anyHidden & anySeen)) != 0 ? -1 : 0;
        // Shortcuts: dim receivers are not refined; those that only differ from their neighbors must be twice as
        // bright.
        const bool shortcuts = settings_.skip.probes;
        const float partlyFrom = shortcuts ? kRefineFrom : 0, mixedFrom = shortcuts ? kRefineMixedFrom : 0;
        LaneMask uncertain;
        for (const std::size_t i : kEachLane) {
            const float arrived = arrived_[i], estimate = unoccludedEstimate_[i];
            const std::int32_t partly = -std::int32_t((arrived != allProbes) & (arrived != 0));
            const std::int32_t doubtful =
                (partly & -std::int32_t(estimate >= partlyFrom)) | (mixed & -std::int32_t(estimate >= mixedFrom));
            uncertain[i] = live_[i] & doubtful;
            live_[i] &= -std::int32_t(arrived > 0);
        }
        return uncertain;
    });
}

/// Coefficient k is the unoccluded estimate times Y[k](direction to the center).
void AreaContribution::ProjectAsPoint() {
    Vectorize([&]() Q3_INLINE {
        const Vec3f center = light_.shape.center;
        const Lanes3 &p = receivers_->position;
        for (const std::size_t i : kEachLane) {
            const auto [x, y, z, d] = DirectionOf(center.x - p.x[i], center.y - p.y[i], center.z - p.z[i]);
            BasisLanes<Assign::Set>(i, x, y, z, unoccludedEstimate_[i], *incident_);
        }
    });
}

/// Adds a small piece of the emitter at `at`: strength h / d^3 times Y[k](direction); strength: radiosity area / pi.
void AreaContribution::AddSample(const Vec3f &at, float strength) {
    Vectorize([&, strength]() Q3_INLINE {
        const Lanes3 &p = receivers_->position;
        for (const std::size_t i : kEachLane) {
            const auto [x, y, z, d] = DirectionOf(at.x - p.x[i], at.y - p.y[i], at.z - p.z[i]);
            const float divisor = d > 0 ? d : 1;
            BasisLanes<Assign::Add>(i, x, y, z, strength * height_[i] / (divisor * divisor * divisor), *incident_);
        }
    });
}

/// Quadrature over the emitter with three points a triangle, at barycentric coordinates (2/3, 1/6, 1/6) in turn, and
/// equal weights: exact for polynomials of degree 2 (Strang and Fix 1973).
void AreaContribution::ProjectByQuadrature() {
    const Winding<float> &w = light_.polygon;
    const AreaShape &shape = light_.shape;
    for (Lanes &row : incident_->shCoeffs)
        row.fill(0);
    float before = 0;
    for (std::size_t t = 2; t < w.size(); ++t) {
        const float strength = light_.radiosity * (shape.cumulative[t - 2] - before) / (3 * std::numbers::pi_v<float>);
        before = shape.cumulative[t - 2];
        const Vec3f sum = w[0] + w[t - 1] + w[t];
        for (const Vec3f &corner : {w[0], w[t - 1], w[t]}) {
            const Vec3f at = sum / 6 + corner * 0.5f;
            AddSample(at, strength);
        }
    }
}

/// Sets the projections of the near receivers by closed form, and those of the others if that is their method; also
/// measures the moments of receivers to refine.
void AreaContribution::ProjectByClosedForm(Method others, const LaneMask &refine) {
    LaneMask unmeasured, projected;
    for (const std::size_t i : kEachLane) {
        projected[i] = others == Method::ClosedForm ? live_[i] : near_[i];
        unmeasured[i] = (projected[i] | refine[i]) & ~near_[i];
    }
    if (unmeasured.Any())
        MeasureMoments(unmeasured);
    if (projected.Any())
        moments_.Project(double(light_.radiosity) / std::numbers::pi, projected, incident_->shCoeffs);
}

/// Visible fractions and tints from the probe rays, for receivers that are not refined.
void AreaContribution::SetVisibleFractions(float probes, const LaneMask &refine) {
    Vectorize([&, probes]() Q3_INLINE {
        for (const std::size_t i : kEachLane)
            visibleFraction_[i] = refine[i] != 0 ? 1 : arrived_[i] / probes;
        if (!tinted_) {
            if (refine.Any()) // Refine may find tints
                incident_->tint.Fill({1, 1, 1});
            return;
        }
        for (const std::size_t i : kEachLane) {
            const float seen = arrived_[i] > 0 ? arrived_[i] : 1;
            incident_->tint.x[i] = tintSum_.x[i] / seen;
            incident_->tint.y[i] = tintSum_.y[i] / seen;
            incident_->tint.z[i] = tintSum_.z[i] / seen;
        }
    });
}

/// Coefficients of receiver i from the projection of the visible solid angle: times radiosity / pi.
void AreaContribution::SetProjection(std::size_t i, const SHVector &projection) {
    const double scale = double(light_.radiosity) / std::numbers::pi;
    for (std::size_t k = 0; k < 9; ++k)
        incident_->shCoeffs[k][i] = float(projection[k] * scale);
}

/// Corrects the closed form E by many rays, a control variate: with V and W the sampled projections of the visible part
/// and of the whole light, and f the visible fraction,
///
///     projection = f E + V - f W
///
/// which is exact where nothing or everything is hidden.
void AreaContribution::Refine(std::size_t i) {
    const int n = RefinedRays(unoccludedEstimate_[i], settings_.samples);
    const Vec3f lift = Vec3f(light_.shape.normal) * EmitterOffset(i);
    const AreaSampler sampler(light_, Corners(i), receivers_->position[i], height_[i], receivers_->index[i],
                              near_[i] != 0);
    SampleMoments moments;
    Vec3d tint;
    int arrived = 0;
    ++counts_.refined;
    RayPacket rays;
    AreaSamples samples{};
    for (int first = 0; first < n; first += AreaSampler::kSamplesPerCall) {
        sampler.Sample(std::uint32_t(first), samples);
        AimFrom(receivers_->rayOrigin[i], samples.target, lift, rays);
        scene_.TraceToLight(rays, ShadowRules::Exact, counts_);
        moments.Add(samples, rays.live);
        arrived += rays.live.Count();
        for (const std::size_t ray : kEachLane)
            if (rays.tinted && rays.live[ray] != 0)
                tint += Vec3d(rays.tint[ray]) - Vec3d{1, 1, 1}; // the ones are added below, also for untinted packets
        tinted_ = tinted_ || rays.tinted;
    }
    live_.Set(i, arrived > 0);
    if (arrived == 0)
        return;
    tint += Vec3d{1, 1, 1} * double(arrived);
    const double fraction = double(arrived) / n;
    SHVector projection = moments_.Of(i).Projection();
    for (std::size_t k = 0; k < 9; ++k) {
        const double visible = SampleMoments::Total(moments.visible[k]), whole = SampleMoments::Total(moments.whole[k]);
        projection[k] = fraction * projection[k] + (visible - fraction * whole) / n;
    }
    refinedFraction_[i] = std::clamp(float(projection[0] / (kSHC0 * moments_.Of(i).solidAngle)), 0.0f, 1.0f);
    SetProjection(i, projection);
    incident_->tint.Set(i, Vec3f(tint / double(arrived)));
}

/// Fraction of the light that arrives, with its mean tint: of refined receivers, that of the mean light.
void AreaContribution::SetVisible() {
    for (const std::size_t i : kEachLane) {
        const float tint = tinted_ ? (incident_->tint.x[i] + incident_->tint.y[i] + incident_->tint.z[i]) / 3 : 1;
        incident_->visible[i] = live_[i] != 0 ? visibleFraction_[i] * refinedFraction_[i] * tint : 0;
    }
}

/// Applies fraction, weight and the cosine lobe; sets `strength` to the sum of the light over all directions:
/// coefficient 0 divided by Y[0], which is kSHC0 = 1 / sqrt(4 pi).
void AreaContribution::Convolve() {
    Vectorize([&]() Q3_INLINE {
        const float perBasis = float(4 * std::numbers::pi * kSHC0);
        for (const std::size_t i : kEachLane)
            visibleFraction_[i] *= partFraction_[i];
        for (const std::size_t i : kEachLane)
            incident_->strength[i] = incident_->shCoeffs[0][i] * visibleFraction_[i] * weight_ * perBasis;
        for (std::size_t k = 0; k < 9; ++k) {
            const float scale = weight_ * float(StoredFactor(k, settings_.radiance));
            for (const std::size_t i : kEachLane)
                incident_->shCoeffs[k][i] = live_[i] != 0 ? incident_->shCoeffs[k][i] * visibleFraction_[i] * scale : 0;
        }
    });
}

void AreaContribution::Evaluate(ReceiverBatch &receivers, ProbeIncidentLight &incident) {
    receivers_ = &receivers;
    incident_ = &incident;
    weight_ = givenWeight_;
    tinted_ = false;
    live_ = incident_->live;
    incident_->live = {};
    const int inSight = live_.Count();
    const bool any = light_.polygon.size() >= 3 && EstimateUnoccluded();
    counts_.skippedUnlit += std::uint64_t(any ? inSight - live_.Count() : inSight);
    if (!any)
        return;
    if (!SelectFaintLight(settings_.faint, brightest_, receivers_->faintResidual, weight_)) {
        counts_.skippedFaint += std::uint64_t(live_.Count());
        return;
    }
    incident_->visible.fill(0);
    for (const std::size_t i : kEachLane)
        incident_->unshadowed[i] = live_[i] != 0 ? unoccludedEstimate_[i] : 0;
    const int probes = ProbeCount();
    counts_.skippedProbes += std::uint64_t(probes == 1 ? live_.Count() : 0);
    TraceProbes(probes);
    const LaneMask refine = LanesToRefine(probes);
    if (!live_.Any() && !refine.Any())
        return;
    const Method method = ChooseMethod();
    if (method == Method::Point)
        ProjectAsPoint();
    else if (method == Method::Quadrature)
        ProjectByQuadrature();
    counts_.skippedMoments += std::uint64_t(method == Method::ClosedForm ? 0 : live_.Count());
    ProjectByClosedForm(method, refine);
    SetVisibleFractions(float(probes), refine);
    refinedFraction_.fill(1);
    for (unsigned lanes = refine.Bits(); lanes != 0; lanes &= lanes - 1)
        Refine(std::size_t(std::countr_zero(lanes)));
    incident_->tinted = tinted_;
    incident_->live = live_;
    SetVisible();
    Convolve();
    incident_->direction = {};
}

} // namespace q3
