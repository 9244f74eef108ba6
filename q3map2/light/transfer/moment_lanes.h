// GPL-2.0-or-later. Moments of one polygon as the receivers of a batch see it.
#pragma once

#include "libs/sh/polygon_moments.h"
#include "q3map2/light/batch/lanes.h"

#include <array>
#include <span>

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
    void Take(const MomentLanes &from, const LaneMask &lanes);

    DoubleLanes solidAngle, x, y, z, xx, yy, zz, xy, yz, xz;
};

} // namespace q3
