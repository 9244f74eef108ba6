// GPL-2.0-or-later. Soft shadows on surfaces (-areashadows): lights of which a receiver may see a part.
#pragma once

#include "q3map2/light/transfer/light_sample.h"

#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// What the receivers of a batch are.
enum class SoftReceivers {
    Luxels, ///< have an area, and are compared with their neighbors
    Places  ///< vertices and the like: cast twice the first rays, since no neighbors are compared
};

/// Light of one SoftLight at a batch of receivers while its rays are cast, a lane per receiver.
struct SoftBatch {
    SurfaceReceiverBatch *receivers = nullptr;
    SoftReceivers kind = SoftReceivers::Places;
    SurfaceIncidentLight incident; ///< without shadows until SoftLight::Finish
    Lanes3 normal;                 ///< of the receiver; of area lights, of the side that is lit
    /// Irradiance vector, and fluence, of the light without shadows, divided by its strength. Light from behind a
    /// receiver adds nothing. Finish sets them to those of the light that arrives.
    Lanes3 vector;
    Lanes fluence;
    Lanes3 color;                 ///< sum over the samples of strength times color, divided by SoftLight::Color
    Lanes whole, seen;            ///< sums of the strengths of all points tried, and of those whose rays arrived
    Lanes3 seenVector;            ///< sum of the irradiance vectors of the points whose rays arrived
    Lanes seenFluence;            ///< sum of their lengths
    Lanes3 wholeColor, seenColor; ///< the sums `whole` and `seen` with color and transmittance; valid if tinted
    LaneMask behind{};            ///< behind the plane of an area light
    Lanes3 position, rayOrigin;   ///< of the receiver, moved off the plane of an area light
    Lanes height;                 ///< distance of rayOrigin to that plane. Game units
    std::uint64_t seed = 0;       ///< of the sequence of points
    int rays = 0;                 ///< cast so far by each live receiver

    /// Receivers that see something of the light, and receivers from which some of it is hidden.
    LaneMask Seeing() const;
    LaneMask Hidden() const;
    /// All live receivers if some see something of the light and some do not see all of it, else none.
    LaneMask Disagreeing() const;
};

/// A light of which receivers on surfaces may see a part.
///
/// Its light without shadows is known. Of that the share V / W arrives: W sums up the light that points of the source
/// would give, and V that of the points whose rays arrive. So the light is exact where nothing or everything is hidden.
///
/// Start casts the first rays of the receivers of a batch to different points, so that together they look over the
/// whole source. Where they and their neighbors agree, that is the result. Finish casts more rays from the others.
class SoftLight {
  public:
    SoftLight(const Light &light, const SurfaceLightSettings &settings, const LightScene &scene,
              ContributionCounts &counts)
        : light_(light), settings_(settings), scene_(scene), counts_(counts) {}
    virtual ~SoftLight() = default;

    /// False: no receiver gets light.
    bool Start(SurfaceReceiverBatch &receivers, SoftReceivers kind, SoftBatch &batch) const;
    /// Sets batch.incident; receivers that get nothing are live no longer. doubtful: receivers that cast more rays.
    void Finish(SoftBatch &batch, const LaneMask &doubtful) const;
    /// Start and Finish for SoftReceivers::Places.
    void Evaluate(SurfaceReceiverBatch &receivers, SurfaceIncidentLight &incident) const;
    /// The color by which incident light is multiplied.
    virtual Vec3f Color() const { return light_.color; }

  protected:
    /// Rays from all receivers, one to a point each, and what these points give.
    struct PointRays {
        RayPacket rays;
        Lanes strength; ///< 0 and not live: none
        Lanes vector;   ///< length of the irradiance vector; its direction is that of the ray
        Lanes3 color;   ///< divided by Color(), if IsColored
    };

    /// Receivers that visibility data does not hide from the light.
    virtual LaneMask FindInSight(const SurfaceReceiverBatch &receivers) const;
    /// Sets incident (live, strength, undirected) and normal, vector, fluence of a batch.
    virtual void SetUnshadowed(SoftBatch &batch) const = 0;
    /// Rays to point `number` of the sequence of each receiver.
    virtual void Aim(const SoftBatch &batch, std::uint32_t number, PointRays &to) const = 0;
    virtual void Cast(RayPacket &rays) const;
    virtual bool IsColored() const { return false; }
    /// Rays of each receiver in Start, `factor` times the usual number. strongest: of all receivers without shadows,
    /// byte scale.
    virtual int FirstRays(float strongest, int factor) const = 0;
    /// The rays of Finish.
    virtual void CastMoreRays(SoftBatch &batch, const LaneMask &doubtful) const = 0;
    /// Adds a traced ray to the sums of its receiver; not if the light IsColored.
    static void AddRay(const RayPacket &traced, std::size_t ray, std::size_t receiver, float strength, float vector,
                       SoftBatch &batch);
    /// Casts the rays of the receivers in `lanes`, and adds the results to the sums of the batch.
    void CastAndCount(const LaneMask &lanes, PointRays &to, SoftBatch &batch) const;

    const Light &light_;
    const SurfaceLightSettings &settings_;
    const LightScene &scene_;
    ContributionCounts &counts_;

  private:
    static void SetTinted(SoftBatch &batch);
    void Count(const PointRays &to, const LaneMask &lanes, SoftBatch &batch) const;
    static void FillUntried(SoftBatch &batch);
    void SetShares(SoftBatch &batch) const;
    void SetDirections(SoftBatch &batch) const;
};

/// An area light: the form factor of the part of its polygon above the receiver's horizon, in closed form, and points
/// of the polygon, uniform in area, by the R2 sequence.
class SoftAreaLight : public SoftLight {
  public:
    using SoftLight::SoftLight;

  protected:
    void SetUnshadowed(SoftBatch &batch) const override;
    void Aim(const SoftBatch &batch, std::uint32_t number, PointRays &to) const override;
    int FirstRays(float strongest, int factor) const override;
    /// Rays until the expected error is kShareError or the limit of -areashadows is reached. Receivers that see all or
    /// nothing after a quarter of them stop there.
    void CastMoreRays(SoftBatch &batch, const LaneMask &doubtful) const override;

  private:
    void AimLanes(const SoftBatch &batch, std::uint32_t number, PointRays &to) const; // vector code cannot be virtual
    void MeasureSides(SoftBatch &batch) const;
    bool MeasureHorizons(SoftBatch &batch) const;
    void MeasureVectors(bool isCrossing, SoftBatch &batch) const;
};

/// The samples of one light (Light::group): directions to a sun or to the sky, or places within the deviance of a
/// point light. The points are the samples. Where receivers disagree, the result is the sum of these lights.
class SoftSampledLight : public SoftLight {
  public:
    SoftSampledLight(const LightGroup &group, const SurfaceLightSettings &settings, const LightScene &scene,
                     ContributionCounts &counts);
    Vec3f Color() const override { return color_; }
    /// Whether the samples that the light is one of can be a group: its light is a multiple of the cosine.
    static bool CanGroup(const Light &light, const SurfaceLightSettings &settings);

  protected:
    LaneMask FindInSight(const SurfaceReceiverBatch &receivers) const override;
    void SetUnshadowed(SoftBatch &batch) const override;
    void Aim(const SoftBatch &batch, std::uint32_t number, PointRays &to) const override;
    void Cast(RayPacket &rays) const override;
    /// Rays to all samples.
    void CastMoreRays(SoftBatch &batch, const LaneMask &doubtful) const override;
    bool IsColored() const override { return isColored_; }
    int FirstRays(float strongest, int factor) const override;

  private:
    void AimFrom(const SoftBatch &batch, std::size_t receiver, std::size_t sample, PointRays &to) const;
    void AimFromAll(const SoftBatch &batch, std::size_t sample, PointRays &to) const;
    void AimAtSun(const SoftBatch &batch, std::size_t sample, PointRays &to) const;
    static void AddSample(const PointRays &to, const Vec3f &color, SoftBatch &batch);
    void ClearRays(const SurfaceReceiverBatch &receivers, PointRays &to) const;

    std::span<const Light *const> samples_;
    Vec3f color_;               ///< LightGroup::Color
    std::vector<Vec3f> colors_; ///< of the samples, divided by color_
    bool isColored_ = false;    ///< LightGroup::ColorsDiffer
    std::size_t step_ = 1;      ///< from a sample to the next one of a receiver
};

} // namespace q3
