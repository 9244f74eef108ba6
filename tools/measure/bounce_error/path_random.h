// GPL-2.0-or-later. Random numbers and random directions for paths.
#pragma once

#include "libs/math/sampling.h"
#include "libs/math/vec.h"

#include <cmath>
#include <numbers>

namespace q3::bounce {

/// The sequence SplitMix64 (Steele, Lea and Flood, 2014): the same numbers on every platform.
class PathRandom {
  public:
    explicit PathRandom(std::uint64_t seed = 0) : state_(HashIndex(seed)) {}
    /// Uniform, 0 <= x < 1.
    double Unit() { return UnitFromHash(HashIndex(state_ += kStep)); }
    /// A point uniform over the unit square.
    Sample2 Unit2() {
        const double u = Unit();
        return {u, Unit()};
    }

  private:
    static constexpr std::uint64_t kStep = 0x9E3779B97F4A7C15u; // 2^64 over the golden ratio, odd
    std::uint64_t state_;
};

/// Maps a point of the unit square to a direction around the unit vector n with density cosine / pi: up to the
/// hemisphere from a point uniform over its disk (Malley's method).
inline Vec3f CosineDirection(const Vec3f &n, const Sample2 &s) {
    const Vec3f axis = std::abs(n.z) > 0.7f ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1};
    const Vec3f right = Normalize(Cross(axis, n)), up = Cross(n, right);
    const double radius = std::sqrt(s.u), angle = 2 * std::numbers::pi * s.v;
    return Normalize(right * float(radius * std::cos(angle)) + up * float(radius * std::sin(angle)) +
                     n * float(std::sqrt(1 - s.u)));
}

/// Maps a point of the unit square to a direction uniform over the sphere.
inline Vec3f SphereDirection(const Sample2 &s) {
    const double z = 1 - 2 * s.u, radius = std::sqrt(std::max(0.0, 1 - z * z)), angle = 2 * std::numbers::pi * s.v;
    return {float(radius * std::cos(angle)), float(radius * std::sin(angle)), float(z)};
}

} // namespace q3::bounce
