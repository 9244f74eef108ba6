// GPL-2.0-or-later. Hashes, low-discrepancy points and uniform sampling of spherical triangles, as functions of an
// index.
#pragma once

#include "libs/math/lane_functions.h"
#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace q3 {

/// A hash of 64 bits: the output function of SplitMix64 (Steele, Lea and Flood, 2014).
constexpr std::uint64_t HashIndex(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

/// 0 <= value < 1 from the upper bits of a hash.
constexpr double UnitFromHash(std::uint64_t hash) {
    return double(hash >> 11) * 0x1p-53;
}
/// The same in single precision, from the upper 24 bits.
constexpr float UnitFloatFromHash(std::uint64_t hash) {
    return float(hash >> 40) * 0x1p-24f;
}

struct Sample2 {
    double u, v;
};

/// Steps of the R2 sequence, the additive recurrence with the plastic number (Roberts, 2018).
inline constexpr double kPlasticA1 = 0.7548776662466927, kPlasticA2 = 0.5698402909980532;

/// Point `i` of the R2 sequence in [0, 1)^2, with a toroidal shift by a hash of `seed`.
constexpr Sample2 PlasticSample(std::uint32_t i, std::uint64_t seed) {
    const std::uint64_t hash = HashIndex(seed);
    const double u = UnitFromHash(hash) + kPlasticA1 * double(i),
                 v = UnitFromHash(HashIndex(hash)) + kPlasticA2 * double(i);
    return {u - double(std::int64_t(u)), v - double(std::int64_t(v))};
}

struct Sample3 {
    double u, v, w;
};

/// Point `i` of the R3 sequence in [0, 1)^3, likewise: steps are 1/x, 1/x^2 and 1/x^3 of the
/// root x of x^4 = x + 1.
constexpr Sample3 R3Sample(std::uint32_t i, std::uint64_t seed) {
    constexpr double kSteps[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    std::uint64_t hash = seed;
    double at[3] = {};
    for (int axis = 0; axis < 3; ++axis) {
        hash = HashIndex(hash);
        const double value = UnitFromHash(hash) + kSteps[axis] * double(i);
        at[axis] = value - double(std::int64_t(value));
    }
    return {at[0], at[1], at[2]};
}

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
