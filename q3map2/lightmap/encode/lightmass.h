// GPL-2.0-or-later. Lightmaps in the layout of Unreal's Lightmass: log luminance, chromaticity, direction of luminance.
#pragma once

#include "q3map2/lightmap/encode/rnm.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace q3::lightmass {

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
    Vec3f incident;       ///< lit value at the smooth normal, unit scale
    L1Light l1;           ///< the same light from all directions
    float correction = 0; ///< luminance that `l1` gives at the smooth normal
    Vec3f skyOcclusion;   ///< mean direction of visible sky; its length is the visible fraction
    float unoccluded = 0; ///< ambient occlusion: 0 to 1, 1 is open

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
