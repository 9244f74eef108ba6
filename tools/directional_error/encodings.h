// GPL-2.0-or-later. The encodings of a luxel's light that are compared.
#pragma once

#include "q3map2/lightmap/encode/lightmass.h"
#include "tools/directional_error/luxel_bake.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace q3::directional {

/// What a luxel stores, on the unit scale, and its frame.
struct LuxelSample {
    Vec3f flat, normal;
    Vec3f direction;    ///< deluxe; unit
    BasisNormals basis; ///< world
    std::array<Vec3f, 3> onBasis;
    std::array<Vec3f, 4> sh;
    lightmass::LuxelLight lightmass;
    lightmass::LuxelBytes lightmassBytes;
    const lightmass::ByteRange *range = nullptr;

    Vec3f InTangentSpace(const Vec3f &n) const { return {Along(0, n), Along(1, n), Along(2, n)}; }

  private:
    float Along(std::size_t axis, const Vec3f &n) const;
};

struct Encoding {
    std::string name;
    double bytes = 0; ///< a luxel
    /// Light on a world-space normal, unit scale.
    std::function<Vec3f(const LuxelSample &, const Vec3f &normal)> decode;
};

/// Encodings as floats and as stored.
std::vector<Encoding> AllEncodings();

/// The samples of a bake with deluxe, SH and basis channels. ranges: kept for them, by lightmap.
std::vector<LuxelSample> MakeSamples(const LuxelBake &bake, std::span<const LuxelPlace> places,
                                     std::map<std::size_t, lightmass::Lightmap> &encoded);

} // namespace q3::directional
