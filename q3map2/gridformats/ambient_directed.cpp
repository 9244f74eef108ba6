// GPL-2.0-or-later. Light of SH coefficients as an ambient part and one directed light.
#include "q3map2/gridformats/ambient_directed.h"

#include "libs/math/color.h"
#include "libs/sh/sh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

using std::numbers::pi;

constexpr double kMinDirection = 1e-7; ///< shorter vectors are rounding errors. 1 is byte 255

Vec3d Coefficient(const bspGridPointSH_t &light, std::size_t k) {
    const Float3 &rgb = light.coeffs[k];
    return {double(rgb[0]), double(rgb[1]), double(rgb[2])};
}

Vec3d DominantDirection(const bspGridPointSH_t &light) {
    const auto luminance = [&](std::size_t k) { return double(Luminance(Vec3f(light.coeffs[k]))); };
    const Vec3d v{luminance(3), luminance(1), luminance(2)}; // basis functions 3, 1, 2 are x, y, z
    const double length = Length(v);
    return length > kMinDirection ? v / length : Vec3d{0, 0, 1};
}

/// Integrals over all normals n of the light, and of the light times max(0, n . direction).
struct Integrals {
    Vec3d whole, lobe;
};

Integrals Integrate(const bspGridPointSH_t &light, const Vec3d &direction) {
    Integrals sum{Coefficient(light, 0) / kShC0, {}};
    const ShVector basis = ShBasis(direction);
    for (std::size_t k = 0; k < 9; ++k)
        sum.lobe += Coefficient(light, k) * (kCosineLobe[k] * basis[k]);
    return sum;
}

} // namespace

Vec3d MeanLight(const bspGridPointSH_t &light) {
    return Coefficient(light, 0) * kShC0;
}

Vec3d LightOn(const bspGridPointSH_t &light, const Vec3d &normal) {
    const ShVector basis = ShBasis(normal);
    Vec3d sum;
    for (std::size_t k = 0; k < 9; ++k)
        sum += Coefficient(light, k) * basis[k];
    return Max(sum, Vec3d{});
}

AmbientDirected FitAmbientDirected(const bspGridPointSH_t &light, double minAmbient) {
    // Normal equations of (light - ambient - directed * lobe)^2; the integrals of 1, lobe and lobe^2 over the sphere
    // are 4 pi, pi and 2 pi / 3.
    AmbientDirected fit;
    fit.direction = DominantDirection(light);
    const Integrals sum = Integrate(light, fit.direction);
    for (std::size_t i = 0; i < 3; ++i) {
        const double e1 = sum.whole[i], e2 = sum.lobe[i];
        double ambient = (2 * e1 - 3 * e2) / (5 * pi), directed = (12 * e2 - 3 * e1) / (5 * pi);
        if (directed < 0)
            directed = 0, ambient = e1 / (4 * pi);
        if (ambient < minAmbient)
            ambient = minAmbient, directed = 3 * (e2 - pi * minAmbient) / (2 * pi);
        fit.ambient[i] = ambient;
        fit.directed[i] = std::max(directed, 0.0);
    }
    return fit;
}

AmbientDirected FitMeanAndDirected(const bspGridPointSH_t &light, double directedShare) {
    AmbientDirected fit = FitAmbientDirected(light);
    const Vec3d mean = Max(MeanLight(light), Vec3d{});
    for (std::size_t i = 0; i < 3; ++i) {
        fit.directed[i] = std::min(fit.directed[i], mean[i] / directedShare);
        fit.ambient[i] = std::max(mean[i] - directedShare * fit.directed[i], 0.0);
    }
    return fit;
}

} // namespace q3
