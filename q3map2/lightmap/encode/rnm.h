// GPL-2.0-or-later. Radiosity normal mapping: light by three directions about the normal.
// McTaggart, Half-Life 2 / Valve Source Shading, 2004.
#pragma once

#include "libs/math/rnm_basis.h"

#include <array>

namespace q3 {

/// Lit values of the three basis vectors as normals, RGB, unit scale.
struct RnmLight {
    std::array<Vec3f, 3> map{};

    /// A light that gives `color` to a surface that faces it; `direction`: unit, in tangent space, towards the light.
    void AddLight(const Vec3f &color, const Vec3f &direction);
    /// Light from everywhere: lit value `color` for every normal.
    void AddUniform(const Vec3f &color);
    /// Light of which only the flat surface's lit value is known, as if along the normal: flat / sqrt(3) in each map.
    void AddFlat(const Vec3f &flat);
    bool operator==(const RnmLight &) const = default;
};

/// Scales the three maps, per channel, so that their mean is the lit value of the flat surface: what shaders expect
/// that square and normalise the weights. A channel without light in all three maps gets `flat` in each. Negative and
/// NaN values count as 0.
RnmLight RescaleToFlat(const RnmLight &raw, const Vec3f &flat);

/// For storage that ends at 1: what exceeds 1 in one map moves half and half to the other two, or to one if the other
/// is full. Keeps the mean of each channel up to 1; brighter channels are 1 in all maps.
RnmLight OverflowToOthers(const RnmLight &light);

/// Tangent space of a luxel: three orthogonal unit vectors.
struct TangentFrame {
    Vec3f s, t, normal;
    constexpr Vec3f ToTangent(const Vec3f &v) const { return {Dot(v, s), Dot(v, t), Dot(v, normal)}; }
    constexpr Vec3f ToWorld(const Vec3f &v) const { return s * v.x + t * v.y + normal * v.z; }
};

/// `alongS`, `alongT`: directions in which the texture coordinates grow, any length. s is alongS made orthogonal to the
/// normal, t is orthogonal to both on the side of alongT, so mirrored mappings have mirrored frames. An axis without
/// length, or along the normal, is replaced by one that fits.
TangentFrame MakeTangentFrame(const Vec3f &alongS, const Vec3f &alongT, const Vec3f &normal);

} // namespace q3
