// GPL-2.0-or-later. The light of the wall in every encoding, on a grid of luxels, and decoded between them.
#pragma once

#include "q3map2/lightmap/encode/l1_light.h"
#include "q3map2/lightmap/encode/lightmass.h"
#include "q3map2/lightmap/encode/rnm.h"
#include "tools/bump_wall/wall.h"

#include <span>
#include <vector>

namespace q3::bump_wall {

enum class Encoding {
    Flat,
    Deluxe,
    DeluxeReceived,
    RnmRaw,
    RnmRescaled,
    RnmSquared,
    Ssbump,
    SsbumpRescaled,
    L1,
    L1WithFlat,
    L1Curved,
    High,
    Low
};

/// Luxels with `spacing` world units between them, baked from both lamps. All floats but those of High and Low.
class LuxelGrid {
  public:
    explicit LuxelGrid(float spacing);
    /// Light on the bump at (x, y) as an engine gets it: luxels filtered bilinearly, then decoded with the normal.
    /// `texel`: of the self-shadowed bump map, for Ssbump.
    Vec3f Decoded(Encoding encoding, float x, float y, const Vec3f &normal, const std::array<float, 3> &texel) const;

  private:
    struct Luxel {
        Vec3f flat, direction;
        RnmLight raw, rescaled;
        L1Light l1;
    };
    /// Corners around a position, and their shares.
    struct Corners {
        std::array<std::size_t, 4> index;
        std::array<float, 4> share;
    };
    Luxel Baked(float x, float y) const;
    Corners Around(float x, float y) const;
    template <typename Value, typename Member> Value Filtered(const Corners &corners, Member member) const;
    Vec3f DecodedRnm(Encoding encoding, const Corners &corners, const float normal[3],
                     const std::array<float, 3> &texel) const;
    Vec3f DecodedLightmass(std::size_t image, const Corners &corners, const float normal[3]) const;

    float spacing_;
    int columns_, rows_;
    std::vector<Luxel> luxels_;
    lightmass::Lightmap lightmass_;
};

} // namespace q3::bump_wall
