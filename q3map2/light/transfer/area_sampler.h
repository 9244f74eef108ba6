// GPL-2.0-or-later. Samples of an area light from one receiver, and moments of its polygon for a batch of receivers.
#pragma once

#include "libs/math/sampling.h"
#include "libs/sh/polygon_moments.h"
#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/sources/light_sources.h"

#include <array>
#include <span>
#include <vector>

namespace q3 {

/// PolygonMoments of sixteen receivers at once.
class MomentLanes {
  public:
    /// Sets the moments of the polygon (see MomentsOfPolygon) in `lanes`; other lanes keep theirs. The receivers must
    /// be at least 1/64 unit in front of its plane. Relative error: 1e-14 times the distance of the farthest corner
    /// over that of the nearest edge.
    void Measure(std::span<const Vec3f> corners, const Lanes3 &receivers, const LaneMask &lanes);
    /// Moments of receiver i.
    PolygonMoments Of(std::size_t i) const;
    /// Sets the projections (see PolygonMoments::Projection) in `lanes`, times scale.
    void Project(double scale, const LaneMask &lanes, std::array<Lanes, 9> &projections) const;
    /// Length of the first moment of receiver i.
    double FirstLength(std::size_t i) const { return Length(Vec3d{x[i], y[i], z[i]}); }

  private:
    /// A corner as the receivers see it: the vector to it, its direction and length.
    struct SeenCorner {
        DoubleLanes x, y, z, dx, dy, dz, length;
        void See(Vec3f corner, const Lanes3 &receivers);
    };
    /// A complex number per receiver; its argument is half the solid angle of the edges so far.
    struct HalfSolidAngles {
        DoubleLanes real, imaginary;
    };
    void Clear();
    void AddEdge(const SeenCorner &a, const SeenCorner &b, Vec3d normal, HalfSolidAngles &half);
    void Finish(const HalfSolidAngles &half);
    void CopyLanes(const MomentLanes &from, const LaneMask &lanes);

    DoubleLanes solidAngle, x, y, z, xx, yy, zz, xy, yz, xz;
};

/// Point of the emitter for a sample of the unit square, uniform in area.
Vec3f SampleUniformArea(const Light &light, const Sample2 &s);

/// Sixteen points of the emitter, uniform in area. u, v: from 0 to below 1; points are as evenly spread as these.
void PointsByArea(const Light &light, const Lanes &u, const Lanes &v, Lanes3 &points);

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
    static constexpr int kSamplesPerCall = int(kPacketSize); ///< number of samples per call of Sample
    /// corners: of the polygon, clockwise as seen from p; height: of p over its plane; seed: of the pattern; near:
    /// samples are uniform in solid angle.
    AreaSampler(const Light &light, std::span<const Vec3f> corners, const Vec3f &p, float height, std::uint64_t seed,
                bool near);
    /// Samples first to first + 15 of the pattern.
    void Sample(std::uint32_t first, AreaSamples &samples) const;

  private:
    const Light &light_;
    Vec3f p_;
    float height_;
    Sample2 start_;                            ///< of the pattern
    std::vector<SphericalTriangle> triangles_; ///< fan of the polygon as seen from p; empty: samples by area
    std::vector<double> cumulative_;           ///< their solid angles, summed up
    Vec3d normal_;                             ///< of the polygon
    double planeDistance_ = 0;                 ///< of its plane from p, along the normal
};

} // namespace q3
