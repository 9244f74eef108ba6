// GPL-2.0-or-later. The encodings of a luxel's light that are compared.
#pragma once

#include "q3map2/lightmap/encode/directional_encode.h"
#include "tools/measure/directional_error/luxel_bake.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace q3::directional {

/// What a luxel stores, on the unit scale, and its frame.
struct LuxelSample {
    Vec3f flat;                   ///< light on the luxel's own normal
    Vec3f normal;                 ///< that normal, world space
    Vec3f direction;              ///< deluxe: unit, world space
    BasisNormals basis;           ///< of RNM, world space
    std::array<Vec3f, 3> onBasis; ///< light on these
    std::array<Vec3f, 4> sh;      ///< bands 0 and 1, see DirectionalChannels
    lightmass::LuxelLight lightmass;
    lightmass::LuxelBytes lightmassBytes; ///< the same, quantized to `range`
    const lightmass::ByteRange *range = nullptr;

    /// A world-space vector in the tangent space of the basis.
    Vec3f InTangentSpace(const Vec3f &n) const {
        return {TangentComponent(0, n), TangentComponent(1, n), TangentComponent(2, n)};
    }

  private:
    float TangentComponent(std::size_t axis, const Vec3f &n) const;
};

/// One way to store a luxel.
struct Encoding {
    std::string name;
    double bytes = 0; ///< per luxel
    /// Light on a world-space normal, unit scale.
    std::function<Vec3f(const LuxelSample &, const Vec3f &normal)> decode;
};

/// Encodings as floats and as stored.
std::vector<Encoding> AllEncodings();

/// The samples of a bake with deluxe, SH and basis channels. encoded: filled by lightmap number; samples point into it.
std::vector<LuxelSample> MakeSamples(const LuxelBake &bake, std::span<const LuxelPlace> places,
                                     std::map<std::size_t, lightmass::Lightmap> &encoded);

} // namespace q3::directional
