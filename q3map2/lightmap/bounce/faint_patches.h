// GPL-2.0-or-later. Under -fast: surfaces cut into patches as by NetRadiant's q3map2, and which of them are too
// faint to light a receiver.
#pragma once

#include "q3map2/lightmap/bounce/bounce_scene.h"

namespace q3 {

/// Surfaces subdivided into patches as in NetRadiant's q3map2, which turns them into area lights in a bounce. Under
/// -fast that program skips a patch at receivers where it would give at most the tolerance even if its texture and the
/// light on it were white: 255 * rho * form factor <= tolerance, rho = BounceScale. Const after construction; safe from
/// several threads.
class FaintPatches {
  public:
    /// emission: radiosity of the first bounce; patches are smaller where it varies much.
    FaintPatches(const SurfaceInputs &in, const SurfaceLight &surfaces, const EmitterIndex &emitters,
                 std::span<const Vec3f> emission);

    /// Fraction of the light of an emitter that counts at a receiver, 0 to 1.
    float ContributionFraction(EmitterId emitter, const Vec3f &position, const Vec3f &normal, bool twoSided) const {
        const std::uint32_t patch = patchOf_[emitter];
        return patch == kNone ? 0 : PatchContributionFraction(patches_[patch], position, normal, twoSided);
    }

  private:
    static constexpr std::uint32_t kNone = ~std::uint32_t(0);
    struct Patch {
        Vec3f center, areaNormal;           ///< center of gravity; unit normal times area
        Vec3f normal;                       ///< mean vertex normal: points to the side that it lights
        Vec3f origin;                       ///< of the area light: 1 unit over the mean of the corners
        float dist = 0;                     ///< of the plane through origin
        float minFormFactor = 0;            ///< it counts where the form factor is above this; negative: everywhere
        float farDistance2 = 0;             ///< squared distance beyond which it counts as a point source
        std::uint32_t first = 0, count = 0; ///< range in corners_
        bool twoSided = false;
    };
    struct PatchBuilder;
    float PatchContributionFraction(const Patch &patch, const Vec3f &position, const Vec3f &normal,
                                    bool twoSided) const;

    std::vector<Patch> patches_;
    std::vector<Vec3f> corners_;
    std::vector<std::uint32_t> patchOf_; ///< by emitter
};

} // namespace q3
