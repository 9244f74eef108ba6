// GPL-2.0-or-later. Directional channels of luxels: L1 SH, and light on the RNM basis normals.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <numbers>
#include <vector>

namespace q3 {

/// RGB values kept per luxel and style, byte scale like the light itself, and linear in it:
///
///     sh:    four channels, the bands 0 and 1 of the SH projection of incident light in the order 1, y, z, x of sh.h,
///            world space. Light c from the unit vector w adds pi k0 c to the first and pi k1 c w to the others, so
///            k0 c0 + 2/3 k1 (c1 . n) approximates the light on normal n
///     basis: three channels, the light on the RNM basis normals: c max(0, b_i . w)
///
/// Uniform light c, the same on all normals, adds c / k0 to the first channel of sh and c to those of basis.
struct DirectionalChannels {
    bool sh = false, basis = false;

    static constexpr std::size_t kSh = 4, kBasis = 3;
    std::size_t Count() const { return (sh ? kSh : 0) + (basis ? kBasis : 0); }
    std::size_t FirstBasis() const { return sh ? kSh : 0; }
    bool Any() const { return sh || basis; }
    bool IsSh(std::size_t channel) const { return sh && channel < kSh; }
};
inline constexpr std::size_t kMaxChannels = DirectionalChannels::kSh + DirectionalChannels::kBasis;

/// Constants of the SH basis, k0 and k1.
inline constexpr float kSh0 = 0.28209479f, kSh1 = 0.48860251f;
/// Channel values per unit of light: the two bands of directed light, and uniform light.
inline constexpr float kDirectedSh0 = std::numbers::pi_v<float> * kSh0, kDirectedSh1 = std::numbers::pi_v<float> * kSh1,
                       kUniformSh0 = 1 / kSh0;

/// A value per channel, SH channels first.
using ChannelWeights = std::array<float, kMaxChannels>;
/// [channel][luxel].
using ChannelImages = std::vector<std::vector<Vec3f>>;

/// The three RNM basis normals of a luxel in world space.
using BasisNormals = std::array<Vec3f, DirectionalChannels::kBasis>;

/// Tangent of a luxel: along growing texture coordinate s, not exactly perpendicular to its normal.
struct LuxelTangent {
    Vec3f s;
    float side = 1; ///< 1, or -1 where the texture is mirrored: t grows against normal x s
};

/// kRnmBasis in the frame of s, t and the normal. A tangent along the normal gives an arbitrary frame.
BasisNormals BasisNormalsOf(const Vec3f &normal, const LuxelTangent &tangent);

/// Channel values per unit of light from the unit vector `w`. basis: null without basis channels.
ChannelWeights WeightsOf(const Vec3f &w, const DirectionalChannels &channels, const BasisNormals *basis);
/// Channel values per unit of uniform light.
ChannelWeights UniformWeights(const DirectionalChannels &channels);

} // namespace q3
