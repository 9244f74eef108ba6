// GPL-2.0-or-later. Samples of an area light from one receiver.
#pragma once

#include "libs/math/low_discrepancy.h"
#include "libs/math/spherical_triangle.h"
#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/sources/light_sources.h"

#include <span>
#include <vector>

namespace q3 {

/// Point of the emitter for a sample of the unit square, uniform in area.
Vec3f SampleUniformArea(const Light &light, const Sample2 &s);

/// Sixteen samples: points of the emitter, unit directions to them, and weights: the mean of weight * f(direction) over
/// all samples estimates the integral of f over the solid angle of the emitter.
struct AreaSamples {
    Lanes3 target, direction;
    Lanes weight;
};

/// Low-discrepancy samples of an area light: uniform in solid angle if it is near, else uniform in area, which is much
/// cheaper and as accurate at a distance.
class AreaSampler {
  public:
    static constexpr int kSamplesPerTake = int(kPacketSize); ///< number of samples per call of Take
    /// corners: of the polygon, clockwise as seen from p; height: of p over its plane; seed: of the pattern.
    AreaSampler(const Light &light, std::span<const Vec3f> corners, const Vec3f &p, float height, std::uint64_t seed,
                bool near);
    /// Samples first to first + 15.
    void Take(std::uint32_t first, AreaSamples &samples) const;

  private:
    const Light &light_;
    Vec3f p_;
    float height_;
    Sample2 start_;                            ///< of the pattern
    std::vector<SphericalTriangle> triangles_; ///< fan of the polygon as seen from p; empty: samples by area
    std::vector<double> cumulative_;           ///< their solid angles, summed up
    Vec3d normal_;
    double planeDistance_ = 0;
};

} // namespace q3
