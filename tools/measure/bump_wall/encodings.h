// GPL-2.0-or-later. The light of luxels in every encoding, and decoded between them.
#pragma once

#include "q3map2/lightmap/encode/directional_encode.h"

#include <span>
#include <vector>

namespace q3::bump_wall {

/// Light from one unit direction, in tangent space.
struct Ray {
    Vec3f color; ///< received by a surface that faces it
    Vec3f direction;
};
/// Light that arrives at a point.
struct LocalLight {
    std::vector<Ray> rays;
    Vec3f sky; ///< received by the flat normal from a uniform hemisphere
};
/// What a surface with that normal receives.
Vec3f Received(const LocalLight &light, const Vec3f &normal);

enum class Encoding {
    Flat,
    Deluxe,
    DeluxeReceived,
    RnmRaw,
    RnmRescaled,
    RnmSquared,
    L1,
    L1WithFlat,
    L1Curved,
    LightmassHigh,
    LightmassLow,
    Ssbump,
    SsbumpRescaled
};
/// How an encoding is named and what it stores.
struct EncodingInfo {
    Encoding encoding;
    const char *name, *stored;
    int bytes; ///< a luxel; colors as HDR colors of 4 bytes, directions of 3, floats as half floats
};
std::span<const EncodingInfo> Encodings();

/// The four luxels around a position, and their bilinear weights.
struct Corners {
    std::array<std::size_t, 4> index;
    std::array<float, 4> share;
};

/// Luxels in every encoding: floats, but bytes for the layout of Lightmass.
class EncodedLuxels {
  public:
    explicit EncodedLuxels(std::span<const LocalLight> luxels);
    /// Light on a bump as an engine gets it: luxels filtered, then decoded with the normal. `texel`: of the
    /// self-shadowed bump map, for Ssbump and SsbumpRescaled.
    Vec3f Decoded(Encoding encoding, const Corners &corners, const Vec3f &normal,
                  const std::array<float, 3> &texel) const;

  private:
    struct Luxel {
        Vec3f flat, direction;
        RnmLight raw, rescaled;
        L1Light l1;
    };
    template <typename Value, typename Member> Value Filtered(const Corners &corners, Member member) const;
    Vec3f DecodedDeluxe(Encoding encoding, const Corners &corners, const float normal[3]) const;
    Vec3f DecodedRnm(Encoding encoding, const Corners &corners, const float normal[3],
                     const std::array<float, 3> &texel) const;
    Vec3f DecodedL1(Encoding encoding, const Corners &corners, const float normal[3]) const;
    Vec3f DecodedLightmass(std::size_t image, const Corners &corners, const float normal[3]) const;

    std::vector<Luxel> luxels_;
    lightmass::Lightmap lightmass_;
};

} // namespace q3::bump_wall
