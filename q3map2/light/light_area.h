// GPL-2.0-or-later. Area lights as the SH grid sees them: exact moments, sampled visibility.
#pragma once

#include "libs/sh/polygon_moments.h"
#include "q3map2/light/light_contribution.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// One place's view of the light.
struct AreaView {
    Vec3f position, rayOrigin;
    std::uint32_t place = 0;
    std::uint64_t seed = 0;
    bool fromBehind = false; ///< a two-sided light, seen from its back
    float height = 0;        ///< distance to the plane of the light
    float weight = 1;        ///< of what arrives
    float facing = 0;        ///< about the light on a surface that faces the light, byte scale
    /// How its moments are found: as a point with a cosine or by three samples a triangle where that errs by less than
    /// a set fraction of a byte, else in closed form.
    enum class Method { Point, Quadrature, ClosedForm } method = Method::ClosedForm;
};

/// Light of one area light at many places: collects views, traces them in packets.
///
/// A few well-spread rays first: one for a faint light, else the corners and, for a bright one, samples of the inside.
/// All clear: the closed form is the answer; all blocked: zero. Where they disagree, among themselves or, for a bright
/// light, with the neighbours before and after, many rays stratified in solid angle correct the closed form; for a
/// light of less than a byte the share of the first rays that arrive does.
class AreaRays {
  public:
    AreaRays(const Light &light, const ContributionSettings &settings, const LightScene &scene,
             std::vector<Arrival> &arrivals, ContributionCounts &counts)
        : light_(light), settings_(settings), scene_(scene), arrivals_(arrivals), counts_(counts) {}

    void Add(LightPlace &place, std::uint32_t number, float weight);
    void Flush();

  private:
    /// What the first rays found.
    struct Look {
        int cast = 0, clear = 0;
        Vec3f tint;
        bool Whole() const { return clear == cast; }
        bool Hidden() const { return clear == 0; }
    };
    static constexpr std::size_t kMaxViews = 64; ///< traced at once

    std::span<const Vec3f> Corners(const AreaView &view) const;
    PolygonMoments Moments(const AreaView &view) const;
    /// Whether the view's light is under that limit, byte scale, and shortcuts are allowed.
    bool Under(const AreaView &view, float limit) const { return view.facing < limit && !settings_.exactAreas; }
    int Probes(const AreaView &view) const;
    Vec3f ProbeTarget(const AreaView &view, int probe) const;
    void FirstLook();
    bool NeedsMore(std::size_t i) const;
    void Refine(const AreaView &view);
    void ArriveWhole(const AreaView &view, const Vec3f &tint);
    void ArriveByQuadrature(const AreaView &view, const Vec3f &tint);
    void Arrive(const AreaView &view, const ShVector &projection, double solidAngle, const Vec3f &tint);

    const Light &light_;
    const ContributionSettings &settings_;
    const LightScene &scene_;
    std::vector<Arrival> &arrivals_;
    ContributionCounts &counts_;
    std::array<AreaView, kMaxViews> views_;
    std::array<Look, kMaxViews> looks_;
    std::size_t count_ = 0;
};

} // namespace q3
