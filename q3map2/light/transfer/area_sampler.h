// GPL-2.0-or-later. Samples of a polygon as a place sees it.
#pragma once

#include "libs/math/low_discrepancy.h"
#include "libs/math/spherical_triangle.h"
#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/sources/light_sources.h"

#include <span>
#include <vector>

namespace q3 {

/// Point of the emitter for a sample of the unit square, uniform in area.
Vec3f PointByArea(const Light &light, const Sample2 &s);

/// Sixteen samples: where they are, the unit direction to there, and a weight: the mean of weight times f(direction)
/// over all samples is the integral of f over the solid angle.
struct AreaSamples {
    Lanes3 target, direction;
    Lanes weight;
};

/// Low-discrepancy samples of an area light: by solid angle where it is near, else by area, which is many times
/// cheaper and as good.
class AreaSampler {
  public:
    /// corners: of the side that p sees; height: of p over it; seed: of the pattern.
    AreaSampler(const Light &light, std::span<const Vec3f> corners, const Vec3f &p, float height, std::uint64_t seed,
                bool near);
    /// Samples number `first` and the 15 after it.
    void Take(std::uint32_t first, AreaSamples &samples) const;

  private:
    const Light &light_;
    Vec3f p_;
    float height_;
    Sample2 start_;                            ///< of the pattern
    std::vector<SphericalTriangle> triangles_; // empty: by area
    std::vector<double> cumulative_;
    Vec3d normal_;
    double planeDistance_ = 0;
};

} // namespace q3
