// GPL-2.0-or-later. Directional light of luxels as stored: L1 spherical harmonics, radiosity normal mapping, the layout
// of Lightmass.
#pragma once

#include "libs/math/rnm_basis.h"
#include "libs/math/vec.h"
#include "libs/sh/sh.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

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

namespace q3::lightmass {

// ---- Lightmaps in the layout of Unreal's Lightmass: log luminance, chromaticity, direction of luminance ----

// Names here, the same in Lightmass, and what they hold:
//
//     GatheredLight    FGatheredLightSample       sums over the light of a point
//     GatheredLuxel    FGatheredLightMapSample    the same for both qualities of a luxel
//     LuxelLight       FLightSampleData           coefficients as floats; not additive
//     LuxelBytes       FQuantizedLightSampleData  coefficients as bytes
//     ByteRange        FLightMapDataBase          scale and offset of the bytes, per map
//     Lightmap         FLightMapData2DData        bytes and range of a map
//     Visibility       FShadowSampleData          visibility of one light from a point
//     VisibilityBytes  FQuantizedShadowSampleData the same as a byte
//     VisibilityMap    FShadowMapData2DData       the same for a map

/// Images of a luxel: [kHigh], [kLow] hold color, the image after each of them the direction.
inline constexpr std::size_t kImages = 4, kHigh = 0, kLow = 2;

/// log2(L + black) is stored in the range -scale / 2 to scale / 2. Brighter luminance is clamped to the end of the
/// range: 53.8 in high quality, 256 in low.
struct LogScale {
    float black, scale;
};
inline constexpr LogScale kHighLog{0.01858136f, 11.5f}, kLowLog{0.00390625f, 16.0f}; // blacks: 2^-5.75, 2^-8

/// Light gathered at a point with a smooth normal. Additive: sums and weighted means of samples are samples.
struct GatheredLight {
    Vec3f incident;        ///< lit value at the smooth normal, unit scale
    L1Light l1;            ///< the same light from all directions
    float l1Luminance = 0; ///< that `l1` gives at the smooth normal
    Vec3f skyOcclusion;    ///< mean direction of visible sky; its length is the visible fraction
    float unoccluded = 0;  ///< ambient occlusion: 0 to 1, 1 is open

    /// Adds light, given as L1 and as lit value at the normal. Light from behind counts in `light` only.
    void AddL1(const L1Light &light, const Vec3f &lit, const Vec3f &normal);
    GatheredLight &operator+=(const GatheredLight &o);
    GatheredLight &operator*=(float scale);
};

struct GatheredLuxel {
    GatheredLight high, low; ///< the same light, unless some is left to the engine in one of them
    Vec3f normal{0, 0, 1};   ///< smooth normal, in the frame of the L1 light
    bool mapped = false;     ///< on a surface
};

/// Color: incident light divided by the direction's value at the normal. Direction: (y, z, x) of the luminance, such
/// that decode(n) = color * max(0, 0.282095 + direction . (n.y, n.z, n.x)).
struct LuxelLight {
    std::array<Vec3f, kImages> coefficients{};
    Vec3f skyOcclusion;
    float unoccluded = 0;
    Vec3f normal{0, 0, 1};
    bool mapped = false;
};

struct LuxelBytes {
    std::uint8_t coverage = 0; ///< 255 on a surface; all bytes of other luxels are 0
    /// Color images: square roots of R, G, B over luminance, then log luminance. Direction images: y, z, x, then what
    /// rounding took from the byte of log luminance (high quality; low: 0).
    std::array<std::array<std::uint8_t, 4>, kImages> coefficients{};
    std::array<std::uint8_t, 4> skyOcclusion{}; ///< unit direction from -1 .. 1, square root of the length
    std::uint8_t unoccluded = 0;                ///< square root
    bool operator==(const LuxelBytes &) const = default;
};

/// coefficient = byte / 255 * multiply + add. The fourth of the direction images is the constant 0.282095.
struct ByteRange {
    std::array<std::array<float, 4>, kImages> multiply{}, add{};
};

struct Lightmap {
    int width = 0, height = 0;
    bool hasSkyOcclusion = false; ///< some luxel has
    ByteRange range;
    std::vector<LuxelBytes> luxels; ///< row by row
};

/// Rounding errors of earlier steps that luminance, quantized last, corrects. Measured errors: see Quantize.
struct QuantizeOptions {
    bool foldDirection = true; ///< of the direction, at the smooth normal
    bool foldColor = true;     ///< of the chromaticity
};

struct Visibility {
    float visibility = 0; ///< fraction of the light that arrives, 0 to 1
    bool mapped = false;
};
struct VisibilityBytes {
    std::uint8_t visibility = 0, coverage = 0;
    bool operator==(const VisibilityBytes &) const = default;
};
struct VisibilityMap {
    int width = 0, height = 0;
    std::vector<VisibilityBytes> luxels;
};

/// Decoding at the smooth normal returns `incident`. Guards: without light the direction is 0; it is no longer than
/// that of one light (0.564190), and is shortened where its value at the normal would fall below a quarter of 0.282095,
/// as lights from behind can make it.
LuxelLight ToCoefficients(const GatheredLuxel &gathered);

/// Bytes over the smallest and largest coefficients of the luxels on surfaces; a coefficient that is the same in all
/// has multiply 0. NaN and negative colors count as 0.
/// Root mean square of relative errors, 4096 luxels of random lights | a wall of 64 x 64 with two lights:
///
///     high quality                none              foldDirection     foldColor         both
///     luminance, smooth normal    2.9e-3 | 8.9e-4   1.9e-3 | 3.8e-4   2.1e-3 | 8.0e-4   2.9e-5 | 1.5e-5
///     color, and 30 deg beside    5.0e-3 | 2.2e-3   4.3e-3 | 2.0e-3   4.6e-3 | 2.0e-3   3.8e-3 | 1.7e-3
///
/// Low quality, whose one byte of luminance errs by more: 9.9e-3 | 4.3e-3 with none, 9.3e-3 | 4.3e-3 with both.
Lightmap Quantize(int width, int height, std::span<const LuxelLight> luxels, const QuantizeOptions &options = {});

VisibilityMap Quantize(int width, int height, std::span<const Visibility> luxels);

} // namespace q3::lightmass
