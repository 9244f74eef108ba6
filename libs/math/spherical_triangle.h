// GPL-2.0-or-later. Uniform sampling of spherical triangles.
#pragma once

#include "libs/math/lane_functions.h"
#include "libs/math/low_discrepancy.h"
#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

/// The triangle a, b, c seen from the origin. Samples unit directions uniformly over its solid angle (Arvo, Stratified
/// Sampling of Spherical Triangles, 1995). Below about 3e-4 sr rounding shows; a triangle without solid angle gives
/// directions between its corners.
class SphericalTriangle {
  public:
    SphericalTriangle(const Vec3d &a, const Vec3d &b, const Vec3d &c) : a_(Normalize(a)), b_(Normalize(b)) {
        const Vec3d vc = Normalize(c);
        const Vec3d ab = Normalize(Cross(a_, b_)), bc = Normalize(Cross(b_, vc)), ca = Normalize(Cross(vc, a_));
        const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
        alpha_ = angle(-Dot(ca, ab));
        area_ = std::max(0.0, alpha_ + angle(-Dot(ab, bc)) + angle(-Dot(bc, ca)) - std::numbers::pi);
        sinA_ = std::sin(alpha_), cosA_ = std::cos(alpha_);
        cosC_ = Dot(a_, b_);
        side_ = Normalize(vc - a_ * Dot(vc, a_));
    }

    double SolidAngle() const { return area_; }

    /// Without branches or calls, so that loops over samples vectorize.
    Vec3d Sample(const Sample2 &s) const {
        const auto [sinD, cosD] = SineCosineOf(s.u * area_ - alpha_);
        const double u = cosD - cosA_, v = sinD + sinA_ * cosC_;
        const double denominator = (v * sinD + u * cosD) * sinA_;
        const double ratio = ((v * cosD - u * sinD) * cosA_ - v) / denominator;
        const double q = std::abs(denominator) < 1e-300 ? 1 : std::min(1.0, std::max(-1.0, ratio));
        const Vec3d onArc = a_ * q + side_ * std::sqrt(std::max(0.0, 1 - q * q));
        const double z = 1 - s.v * (1 - Dot(onArc, b_));
        const Vec3d up = onArc - b_ * Dot(onArc, b_);
        const double length = Length(up);
        const Vec3d d = b_ * z + up * (std::sqrt(std::max(0.0, 1 - z * z)) / (length > 0 ? length : 1));
        return d / Length(d);
    }

  private:
    Vec3d a_, b_, side_;
    double alpha_ = 0, area_ = 0, sinA_ = 0, cosA_ = 0, cosC_ = 0;
};

} // namespace q3
