// GPL-2.0-or-later. Directional light as stored: L1 spherical harmonics, and radiosity normal mapping.
#pragma once

#include "libs/math/rnm_basis.h"
#include "libs/math/vec.h"
#include "libs/sh/sh.h"

#include <array>

namespace q3 {

/// Radiance coefficients L0, y, z, x (index l * l + l + m, no Condon-Shortley sign), RGB each: 12 floats. A light of
/// lit value `c` at normal incidence from the unit direction w has L0 = pi Y0 c and L1 = pi Y1 c w. Any frame; the
/// compiler uses world axes. Unit scale: lit value 1 is byte 255.
struct L1Light {
    std::array<Vec3f, 4> c{};

    /// A light that gives `color` to a surface that faces it; `direction`: unit, towards the light.
    void AddLight(const Vec3f &color, const Vec3f &direction);
    /// Light from everywhere: lit value `color` for every normal.
    void AddUniform(const Vec3f &color) { c[0] += color * float(1 / kSHC0); }
    /// Lit value of a surface with that unit normal, the clamped cosine convolved: negative where the two bands are
    /// too few, down to -0.25 of one light.
    Vec3f Evaluate(const Vec3f &normal) const;
    /// Coefficients of the luminance of each color: weights 0.30, 0.59, 0.11.
    std::array<float, 4> Luminance() const;

    L1Light &operator+=(const L1Light &o);
    L1Light &operator*=(float scale);
    L1Light operator+(const L1Light &o) const { return L1Light(*this) += o; }
    L1Light operator*(float scale) const { return L1Light(*this) *= scale; }
    bool operator==(const L1Light &) const = default;
};
static_assert(sizeof(L1Light) == 12 * sizeof(float));

/// Factors of L0 and L1 in the lit value: Y0, and Y1 times 2/3 of the clamped cosine.
inline constexpr float kL1Flat = float(kSHC0), kL1Directed = float(kSHC1 * 2 / 3);

/// Luminance as directional lightmaps have it.
constexpr float DirectionalLuminance(const Vec3f &color) {
    return 0.30f * color.x + 0.59f * color.y + 0.11f * color.z;
}

inline void L1Light::AddLight(const Vec3f &color, const Vec3f &direction) {
    constexpr double kPi = std::numbers::pi;
    const Vec3f band1 = color * float(kPi * kSHC1);
    c[0] += color * float(kPi * kSHC0);
    c[1] += band1 * direction.y;
    c[2] += band1 * direction.z;
    c[3] += band1 * direction.x;
}

inline Vec3f L1Light::Evaluate(const Vec3f &normal) const {
    return c[0] * kL1Flat + (c[1] * normal.y + c[2] * normal.z + c[3] * normal.x) * kL1Directed;
}

inline std::array<float, 4> L1Light::Luminance() const {
    return {DirectionalLuminance(c[0]), DirectionalLuminance(c[1]), DirectionalLuminance(c[2]),
            DirectionalLuminance(c[3])};
}

inline L1Light &L1Light::operator+=(const L1Light &o) {
    for (std::size_t i = 0; i < c.size(); i++)
        c[i] += o.c[i];
    return *this;
}

inline L1Light &L1Light::operator*=(float scale) {
    for (Vec3f &coefficient : c)
        coefficient *= scale;
    return *this;
}

// ---- Radiosity normal mapping: light on three basis normals
// McTaggart, Half-Life 2 / Valve Source Shading, 2004.

/// Lit values of the three vectors of kRnmBasis as normals, RGB, unit scale.
struct RnmLight {
    std::array<Vec3f, 3> map{};
    bool operator==(const RnmLight &) const = default;
};

/// Scales the three maps, per channel, so that their mean is the lit value of the flat surface, as shaders expect
/// that square and normalize the weights. A channel without light in all three maps gets `flat` in each. Negative and
/// NaN values count as 0.
RnmLight RescaleToFlat(const RnmLight &raw, const Vec3f &flat);

/// For storage up to 1: the excess over 1 in one map moves in equal halves to the other two, or to one if the other is
/// full. Keeps the mean of each channel up to 1; brighter channels are 1 in all maps.
RnmLight OverflowToOthers(const RnmLight &light);

} // namespace q3
