// GPL-2.0-or-later. Moments of one polygon as neighbouring receivers see it.
#pragma once

#include "libs/sh/polygon_moments.h"
#include "q3map2/light/batch/lanes.h"

#include <array>
#include <span>

namespace q3 {

/// PolygonMoments of sixteen receivers at once.
class MomentLanes {
  public:
    /// Moments of the polygon (see MomentsOfPolygon) for those receivers, 1/64 of a unit or more in front of its plane;
    /// the others keep theirs. Right to 1e-14 times the distance of the farthest corner over that of the nearest edge;
    /// tested against quadrature.
    void Measure(std::span<const Vec3f> corners, const Lanes3 &receivers, const LaneMask &those);
    PolygonMoments Of(std::size_t i) const;
    /// Sets the projections (see PolygonMoments::Projection) of those receivers, times scale.
    void Project(double scale, const LaneMask &those, std::array<Lanes, 9> &projections) const;
    /// Length of the first moment of place i.
    double FirstLength(std::size_t i) const { return Length(Vec3d{x[i], y[i], z[i]}); }

  private:
    /// A corner as the receivers see it: the way there, its direction and length.
    struct SeenCorner {
        DoubleLanes x, y, z, dx, dy, dz, length;
        void See(Vec3f corner, const Lanes3 &receivers);
    };
    /// A complex number of each place whose argument is half the solid angle so far.
    struct HalfAngle {
        DoubleLanes real, imaginary;
    };
    void Clear();
    void AddEdge(const SeenCorner &a, const SeenCorner &b, Vec3d normal, HalfAngle &half);
    void Finish(const HalfAngle &half);
    void Keep(const MomentLanes &from, const LaneMask &those);

    DoubleLanes solidAngle, x, y, z, xx, yy, zz, xy, yz, xz;
};

} // namespace q3
