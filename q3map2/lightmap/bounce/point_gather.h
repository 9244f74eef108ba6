// GPL-2.0-or-later. Bounced light at points of the light grids.
#pragma once

#include "q3map2/lightmap/bounce/bright_emitters.h"

namespace q3 {

/// Bounced light of style 0 at points in the open: uniform rays gather radiosity summed over bounces, and shadow rays
/// sample the brightest emitters. Const after construction; safe from several threads. Keeps references.
class PointGather : public IndirectLight {
  public:
    /// Default number of rays from a point, not counting shadow rays to bright emitters.
    static constexpr int kRays = 96;

    /// emission: radiosity without the part that `bright` samples. rays: number of rays from a point.
    PointGather(const BounceScene &scene, const std::vector<Vec3f> &emission, const BrightEmitters &bright, int rays)
        : scene_(scene), emission_(emission), bright_(bright), rays_(rays) {}
    int RaysPerPoint() const override { return rays_; }
    void Gather(const Vec3f &position, std::uint64_t seed, std::vector<IndirectRay> &rays) const override;

  private:
    const BounceScene &scene_;
    const std::vector<Vec3f> &emission_;
    const BrightEmitters &bright_;
    const int rays_;
};

} // namespace q3
