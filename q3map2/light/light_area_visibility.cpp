// GPL-2.0-or-later. How much of an area light points see.
#include "q3map2/light/light_area_visibility.h"

#include "libs/math/low_discrepancy.h"
#include "libs/math/spherical_triangle.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace q3 {

namespace {

/// First look: a straight shadow edge that crosses a convex emitter hides or shows one of its corners, so each gets a ray, moved
/// inward by this share; and these many samples of the inside find what is smaller.
constexpr float kCornerInset = 0.01f;
constexpr int kInnerProbes = 2;
/// Lights that give less than this are judged by one ray. Byte scale; a sixteenth of what a screen can show.
constexpr double kFaint = 1.0 / 16;
/// Rays for a partly hidden light: as many as keep the expected error of the estimate under kTolerance, within these limits.
constexpr int kMinRefined = 16, kMaxRefined = 512;
/// Byte scale: a quarter of what a screen can show.
constexpr double kTolerance = 0.25;
/// Rays end this far in front of the emitter, which is itself in the scene, or half way to its plane. Game units.
constexpr double kEmitterGap = 0.125;
/// Under this solid angle sampling by area is as good and avoids cancellation; pbrt-v4 uses the same limit.
constexpr double kMinSphericalTriangle = 3e-4;

struct AreaSample {
    Vec3f target;    ///< where the ray ends: just in front of the emitter
    Vec3d direction; ///< unit, to the emitter itself
    double weight;   ///< solid angle it stands for
};

/// Splits the polygon into its fan and samples it in proportion to solid angle.
class AreaSampler {
  public:
    explicit AreaSampler(const AreaView &view) : view_(view) {
        const Vec3d p(view.point);
        for (std::size_t i = 2; i < view.corners.size(); ++i) {
            const double angle =
                TriangleSolidAngle(Vec3d(view.corners[0]) - p, Vec3d(view.corners[i - 1]) - p, Vec3d(view.corners[i]) - p);
            total_ += std::max(0.0, angle);
            cumulative_.push_back(total_);
        }
        normal_ = -Normalize(WindingAreaVector(view.corners));
        const double height = Dot(p - Vec3d(view.corners[0]), normal_);
        lift_ = normal_ * std::min(kEmitterGap, 0.5 * height);
    }

    /// Corner i, a little inward.
    AreaSample Corner(std::size_t i) const {
        Vec3f center;
        for (const Vec3f &p : view_.corners)
            center += p / float(view_.corners.size());
        const Vec3d offset(view_.corners[i] + (center - view_.corners[i]) * kCornerInset - view_.point);
        return {Vec3f(Vec3d(view_.point) + offset + lift_), Normalize(offset), 0};
    }

    /// Sample for s in the unit square, standing for `share` of the polygon's solid angle.
    AreaSample Sample(Sample2 s, double share) const {
        const double pick = s.u * total_;
        std::size_t i = 0;
        while (i + 1 < cumulative_.size() && cumulative_[i] <= pick)
            ++i;
        const double start = i == 0 ? 0 : cumulative_[i - 1], angle = cumulative_[i] - start;
        s.u = angle > 0 ? std::clamp((pick - start) / angle, 0.0, 1.0) : 0;
        const Vec3d p(view_.point);
        const Vec3d a = Vec3d(view_.corners[0]) - p, b = Vec3d(view_.corners[i + 1]) - p, c = Vec3d(view_.corners[i + 2]) - p;
        AreaSample sample;
        sample.weight = share * total_;
        if (angle > kMinSphericalTriangle) {
            sample.direction = SampleSphericalTriangle(a, b, c, s);
            const double facing = Dot(sample.direction, normal_);
            const double distance = facing != 0 ? Dot(a, normal_) / facing : 0;
            sample.target = Vec3f(p + sample.direction * distance + lift_);
        } else {
            const double root = std::sqrt(s.u);
            const Vec3d offset = a * (1 - root) + b * (root * (1 - s.v)) + c * (root * s.v);
            sample.direction = Normalize(offset);
            sample.target = Vec3f(p + offset + lift_);
        }
        return sample;
    }

  private:
    const AreaView &view_;
    std::vector<double> cumulative_;
    double total_ = 0;
    Vec3d normal_, lift_;
};

void SetRay(RayPacket &rays, std::size_t i, const AreaView &view, const AreaSample &sample) {
    const Vec3f way = sample.target - view.point;
    rays.origin[i] = view.point;
    rays.distance[i] = Length(way);
    rays.direction[i] = Normalize(way);
    rays.blocked[i] = false;
}

/// What the first look found of each view.
struct FirstLook {
    std::array<int, kPacketSize> clear{}, cast{};
    std::array<Vec3f, kPacketSize> tint;
    bool Whole(std::size_t i) const { return clear[i] == cast[i]; }
    bool Hidden(std::size_t i) const { return clear[i] == 0; }
};

double FacingLight(const AreaView &view) { return Length(view.moments.first) * view.scale; }

/// Probe number `probe` of a view: its corners, then samples of its inside. Faint lights get one, from the inside.
bool ProbeOf(const AreaView &view, const AreaSampler &sampler, std::size_t probe, AreaSample &sample) {
    const std::size_t corners = FacingLight(view) < kFaint ? 0 : view.corners.size();
    const std::size_t inner = corners == 0 ? 1 : kInnerProbes;
    if (probe >= corners + inner)
        return false;
    sample = probe < corners ? sampler.Corner(probe)
                             : sampler.Sample(PlasticSample(std::uint32_t(probe - corners), view.seed), 1);
    return true;
}

FirstLook Look(const AreaViews &views, const std::vector<AreaSampler> &samplers, const LightScene &scene,
               ContributionCounts &counts) {
    FirstLook look;
    for (std::size_t probe = 0;; ++probe) {
        RayPacket rays;
        std::array<std::size_t, kPacketSize> of{};
        for (std::size_t i = 0; i < views.size(); ++i) {
            AreaSample sample;
            if (!ProbeOf(views[i], samplers[i], probe, sample))
                continue;
            const auto ray = std::size_t(rays.count++);
            of[ray] = i;
            SetRay(rays, ray, views[i], sample);
        }
        if (rays.count == 0)
            return look;
        scene.TraceToLight(rays, ShadowRules::Exact, counts);
        for (std::size_t ray = 0; ray < std::size_t(rays.count); ++ray) {
            ++look.cast[of[ray]];
            if (!rays.blocked[ray]) {
                ++look.clear[of[ray]];
                look.tint[of[ray]] += rays.tint[ray];
            }
        }
    }
}

int RefinedRays(const AreaView &view) {
    // A stratified pattern's error falls about as n^-0.75, from half of the light at one ray.
    const double n = std::pow(0.5 * FacingLight(view) / kTolerance, 1 / 0.75);
    const int packets = int(std::ceil(std::clamp(n, double(kMinRefined), double(kMaxRefined)) / kPacketSize));
    return packets * kPacketSize;
}

/// Corrects the closed form by what many rays see: with V and W the traced moments of the visible part and of the whole and f
/// the visible share, f * exact + V - f * W is exact where nothing or everything is hidden.
void Refine(AreaView &view, const AreaSampler &sampler, const LightScene &scene, ContributionCounts &counts) {
    const int n = RefinedRays(view);
    ShVector visible{}, whole{};
    Vec3d tint;
    int clear = 0;
    for (int first = 0; first < n; first += kPacketSize) {
        RayPacket rays;
        rays.count = kPacketSize;
        std::array<AreaSample, kPacketSize> samples;
        for (std::size_t i = 0; i < std::size_t(kPacketSize); ++i) {
            samples[i] = sampler.Sample(PlasticSample(std::uint32_t(first) + std::uint32_t(i), view.seed), 1.0 / n);
            SetRay(rays, i, view, samples[i]);
        }
        scene.TraceToLight(rays, ShadowRules::Exact, counts);
        for (std::size_t i = 0; i < std::size_t(kPacketSize); ++i) {
            const ShVector basis = ShBasis(samples[i].direction);
            for (std::size_t k = 0; k < 9; ++k) {
                whole[k] += basis[k] * samples[i].weight;
                visible[k] += rays.blocked[i] ? 0 : basis[k] * samples[i].weight;
            }
            if (!rays.blocked[i]) {
                ++clear;
                tint += Vec3d(rays.tint[i]);
            }
        }
    }
    const double share = double(clear) / n;
    const ShVector exact = view.moments.Projection();
    for (std::size_t k = 0; k < 9; ++k)
        view.arriving[k] = clear == 0 ? 0 : share * exact[k] + visible[k] - share * whole[k];
    view.tint = clear == 0 ? Vec3f{} : Vec3f(tint / double(clear));
    ++counts.refined;
}

} // namespace

void FindAreaVisibility(AreaViews &views, const LightScene &scene, ContributionCounts &counts) {
    std::vector<AreaSampler> samplers;
    samplers.reserve(views.size());
    for (const AreaView &view : views)
        samplers.emplace_back(view);
    const FirstLook look = Look(views, samplers, scene, counts);
    for (std::size_t i = 0; i < views.size(); ++i) {
        bool mixed = !look.Whole(i) && !look.Hidden(i);
        if (FacingLight(views[i]) >= kFaint)
            for (std::size_t j = 0; j < views.size() && !mixed; ++j)
                mixed = look.cast[j] > 0 && (look.Whole(j) != look.Whole(i) || look.Hidden(j) != look.Hidden(i));
        if (mixed) {
            Refine(views[i], samplers[i], scene, counts);
        } else if (!look.Hidden(i)) {
            views[i].arriving = views[i].moments.Projection();
            views[i].tint = look.tint[i] / float(look.clear[i]);
        }
    }
}

} // namespace q3
