// GPL-2.0-or-later. Under -fast: how far bounced light reaches.
#pragma once

#include "q3map2/lightmap/bounce/bounce_scene.h"

namespace q3 {

/// Surfaces in the pieces that the established program makes area lights of in a bounce: under -fast such a light
/// counts only where it gives more than the tolerance in white, whatever its colour. Const after construction; safe
/// from several threads.
class RadiosityPatches {
  public:
    /// Pieces are smaller where the light, what emitters send on in the first bounce, varies much.
    RadiosityPatches(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterNumbers &emitters,
                     std::span<const Vec3f> emission);

    /// Share of this emitter's light that counts at a place with a normal, 0 to 1.
    float Share(EmitterId emitter, const Vec3f &place, const Vec3f &normal, bool twoSided) const {
        const std::uint32_t piece = pieceOf_[emitter];
        return piece == kNone ? 0 : ShareOf(pieces_[piece], place, normal, twoSided);
    }

  private:
    static constexpr std::uint32_t kNone = ~std::uint32_t(0);
    struct Piece {
        Vec3f center, plane;                ///< of gravity; normal of its corners times area
        Vec3f normal;                       ///< that it shines along
        Vec3f origin;                       ///< of its light: 1 unit before its middle
        float dist = 0;                     ///< of the plane 1 unit before it
        float least = 0;                    ///< form factor from which it counts; negative: everywhere
        float far = 0;                      ///< from this squared distance on it looks like a point
        std::uint32_t first = 0, count = 0; ///< in corners_
        bool twoSided = false;
    };
    struct Maker;
    float ShareOf(const Piece &piece, const Vec3f &place, const Vec3f &normal, bool twoSided) const;

    std::vector<Piece> pieces_;
    std::vector<Vec3f> corners_;
    std::vector<std::uint32_t> pieceOf_; ///< by emitter
};

} // namespace q3
