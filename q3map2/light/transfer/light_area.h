// GPL-2.0-or-later. Area lights in the SH grid: exact projection, sampled visibility.
#pragma once

#include "q3map2/light/transfer/area_sampler.h"
#include "q3map2/light/transfer/light_contribution.h"

#include <array>
#include <span>

namespace q3 {

/// SH projection of one area light at receivers, batch by batch.
///
/// Each receiver first casts a few probe rays to the emitter: one for a faint light, else one to each corner and, for a
/// bright light, some to its inside. If all arrive, the projection is the closed form of the whole polygon; if none
/// does, it is zero. If some do, or if the receivers of the batch disagree about a bright light, the receiver is
/// refined: many rays correct the closed form. A partly visible light too dim for that is scaled by the fraction of
/// probe rays that arrive.
class AreaContribution {
  public:
    AreaContribution(const Light &light, float weight, const LightSettings &settings, const LightScene &scene,
                     ContributionCounts &counts)
        : light_(light), givenWeight_(weight), settings_(settings), scene_(scene), counts_(counts) {}

    /// Sets `incident` of the live receivers; those that get nothing are live no longer.
    void Evaluate(ReceiverBatch &receivers, ProbeIncidentLight &incident);

  private:
    /// How the unoccluded projection is computed, from the cheapest to the exact one.
    enum class Method { Point, Quadrature, ClosedForm };
    bool FromBehind(std::size_t i) const { return behind_[i] != 0; }
    /// Signed distance along the emitter's normal at which rays of receiver i end in front of it, see kEmitterGap.
    float EmitterOffset(std::size_t i) const;
    std::span<const Vec3f> Corners(std::size_t i) const { return FromBehind(i) ? light_.shape.back : light_.polygon; }
    void MeasureLanes();
    void MeasureMoments(const LaneMask &lanes);
    void MeasureNear();
    float CullUnlit(float least);
    bool EstimateUnoccluded();
    void SetPartFractions();
    Method ChooseMethod() const;
    int ProbeCount() const;
    Vec3f ProbeTarget(int probe) const;
    void AimAll(const Vec3f &target, RayPacket &rays) const;
    void TraceProbes(int probes);
    void AddTint(const RayPacket &rays);
    LaneMask LanesToRefine(int probes);
    void ProjectAsPoint();
    void AddSample(const Vec3f &at, float strength);
    void ProjectByQuadrature();
    void ProjectByClosedForm(Method others, const LaneMask &refine);
    void SetVisibleFractions(float probes, const LaneMask &refine);
    void SetProjection(std::size_t i, const SHVector &projection);
    void Refine(std::size_t i);
    void SetVisible();
    void Convolve();

    const Light &light_;
    float givenWeight_;
    const LightSettings &settings_;
    const LightScene &scene_;
    ContributionCounts &counts_;

    // State of the batch in Evaluate, a lane per receiver.
    ReceiverBatch *receivers_ = nullptr;
    ProbeIncidentLight *incident_ = nullptr;
    float weight_ = 1;         ///< givenWeight_, changed by SelectFaintLight for this batch
    LaneMask live_{};          ///< receivers that may still get light
    LaneMask behind_{};        ///< behind the plane of the emitter
    LaneMask near_{};          ///< so near that only the closed form is accurate enough
    Lanes height_;             ///< distance to the plane of the light
    Lanes partFraction_;       ///< see FractionOfPart; 1 for LightPart::Whole
    Lanes unoccludedEstimate_; ///< approximate light without shadows on a surface facing the emitter; byte scale
    Lanes pointError_;         ///< (radius of the emitter / distance)^2, about the relative error of a point light
    float brightest_ = 0;      ///< greatest unoccludedEstimate_
    MomentLanes moments_;      ///< of near receivers and, after ProjectByClosedForm, of all that need closed forms
    Lanes arrived_;            ///< number of probe rays that arrived
    Lanes visibleFraction_;    ///< visible fraction of the light; 1 for refined receivers, whose projection includes it
    Lanes refinedFraction_;    ///< visible fraction of refined receivers; 1 for others
    Lanes3 tintSum_;           ///< sum of the transmittances of the probe rays that arrived; valid if tinted_
    bool tinted_ = false;      ///< some ray of the batch went through a see-through surface
};

} // namespace q3
