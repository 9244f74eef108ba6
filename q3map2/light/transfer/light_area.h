// GPL-2.0-or-later. Area lights as the SH grid sees them: exact moments, sampled visibility.
#pragma once

#include "q3map2/light/transfer/light_contribution.h"
#include "q3map2/light/transfer/moment_lanes.h"

#include <array>
#include <span>

namespace q3 {

/// Light of one area light at receivers, block by block.
///
/// A few well-spread rays first: one for a faint light, else the corners and, for a bright one, samples of the inside.
/// All clear: the closed form is the answer; all blocked: zero. Where they disagree, among themselves or, for a bright
/// light, with the other receivers of the block, many rays correct the closed form; for a faint light the share of the
/// first rays that arrive does.
class AreaContribution {
  public:
    AreaContribution(const Light &light, float weight, const LightSettings &settings, const LightScene &scene,
                     ContributionCounts &counts)
        : light_(light), givenWeight_(weight), settings_(settings), scene_(scene), counts_(counts) {}

    /// Sets the incident of live receivers, and which stay alive.
    void Add(ReceiverBatch &receivers, IncidentLight &incident);

  private:
    /// How moments are found, by what each errs.
    enum class Method { Point, Quadrature, ClosedForm };
    bool FromBehind(std::size_t i) const { return below_[i] != 0; }
    /// Rays end so far from the emitter's plane, towards the place: see kEmitterGap.
    float Lift(std::size_t i) const;
    std::span<const Vec3f> Corners(std::size_t i) const { return FromBehind(i) ? light_.shape.back : light_.w; }
    void MeasureLanes();
    void MeasureMoments(const LaneMask &those);
    void MeasureNear();
    float CullUnlit(float least);
    bool EstimateUnoccluded();
    Method ChooseMethod() const;
    int Probes() const;
    Vec3f ProbeTarget(int probe) const;
    void AimAll(const Vec3f &target, RayPacket &rays) const;
    void TraceProbes(int probes);
    void AddTint(const RayPacket &rays);
    LaneMask LanesToRefine(int probes);
    void PointMoments();
    void AddSample(const Vec3f &at, float strength);
    void QuadratureMoments();
    void TakeClosedForms(bool all, const LaneMask &refine);
    void SetShares(float probes, const LaneMask &refine);
    void SetMoments(std::size_t i, const ShVector &projection);
    void Refine(std::size_t i);
    void Convolve();

    const Light &light_;
    float givenWeight_;
    const LightSettings &settings_;
    const LightScene &scene_;
    ContributionCounts &counts_;

    // Of the block.
    ReceiverBatch *receivers_ = nullptr;
    IncidentLight *incident_ = nullptr;
    float weight_ = 1; ///< with what the light stands for in the block
    LaneMask live_{}, below_{}, near_{};
    Lanes height_;             ///< distance to the plane of the light
    Lanes distance2_;          ///< squared, to its centre
    Lanes unoccludedEstimate_; ///< about the light on a surface that faces the light, byte scale
    Lanes error_;              ///< square of size over distance
    float brightest_ = 0;
    MomentLanes moments_; ///< where near_, and elsewhere where they are asked for
    Lanes clear_;         ///< first rays that arrived
    Lanes share_;         ///< of the whole light that arrives, where it is not refined
    Lanes3 firstTint_;    ///< sum of what arrived of them, if tinted_
    bool tinted_ = false;
};

} // namespace q3
