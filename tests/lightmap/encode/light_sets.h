// GPL-2.0-or-later. Random lights over a surface, and what it receives from them.
#pragma once

#include "libs/math/vec.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace q3::test {

struct Lamp {
    Vec3f color, direction; ///< lit value at normal incidence; unit, towards the light
};

/// Unit vector at `degrees` from z, in the plane of z and the angle `around` from x.
inline Vec3f Tilted(double degrees, double around = 0) {
    const double t = degrees * std::numbers::pi / 180, a = around * std::numbers::pi / 180;
    return {float(std::sin(t) * std::cos(a)), float(std::sin(t) * std::sin(a)), float(std::cos(t))};
}

/// What a surface with this normal receives from the lamps: the sum of color * max(0, n . w).
inline Vec3f Received(const std::vector<Lamp> &lamps, const Vec3f &normal) {
    Vec3d sum;
    for (const Lamp &lamp : lamps)
        sum += Vec3d(lamp.color) * std::max(0.0, Dot(Vec3d(lamp.direction), Vec3d(normal)));
    return Vec3f(sum);
}

class LightSets {
  public:
    explicit LightSets(unsigned seed) : random_(seed) {}

    float Uniform(float low, float high) { return std::uniform_real_distribution<float>(low, high)(random_); }
    /// Evenly over the sphere.
    Vec3f Direction() {
        const double z = Uniform(-1, 1), turn = Uniform(0, 6.2831853f), r = std::sqrt(1 - z * z);
        return {float(r * std::cos(turn)), float(r * std::sin(turn)), float(z)};
    }
    /// Evenly over the hemisphere about `normal`.
    Vec3f DirectionAbove(const Vec3f &normal) {
        const Vec3f d = Direction();
        return Dot(d, normal) < 0 ? -d : d;
    }
    /// One to five lamps of any color and a strength of 0.01 to 10, above the surface.
    std::vector<Lamp> Lamps(const Vec3f &normal) {
        std::vector<Lamp> lamps(std::size_t(Uniform(1, 5.999f)));
        for (Lamp &lamp : lamps) {
            const float strength = std::pow(10.0f, Uniform(-2, 1));
            lamp = {Vec3f{Uniform(0, 1), Uniform(0, 1), Uniform(0, 1)} * strength, DirectionAbove(normal)};
        }
        return lamps;
    }

  private:
    std::mt19937 random_;
};

} // namespace q3::test
