// GPL-2.0-or-later. Normal mapping: q3map_normalImage, q3map_ssbumpImage.
#include "q3map2/lightmap/raw/luxel_normal.h"

#include "libs/math/rnm_basis.h"
#include "q3map2/lightmap/raw/texture_axes.h"

#include <cmath>

namespace q3 {

namespace {

int NearestTexel(float coordinate, int size) {
    const float fraction = coordinate - std::floor(coordinate);
    return std::isfinite(fraction) ? int(float(size) * fraction + 0.5f) % size : 0;
}

} // namespace

NormalMap::NormalMap(const NormalImage &normals, const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c)
    : image_(normals.image.get()), ssbump_(normals.ssbump) {
    if (const auto axes = TextureAxesOf(a, b, c))
        s_ = axes->s, t_ = axes->t;
    else
        image_ = nullptr;
}

Vec3f NormalMap::Perturbed(const SurfaceVertex &v) const {
    const auto texel = image_->Texel(NearestTexel(v.st[0], image_->width), NearestTexel(v.st[1], image_->height));
    const auto signedOf = [](std::uint8_t c) { return (float(c) - 127) / 127.5f; };
    Vec3f bent = v.normal + s_ * signedOf(texel[0]) + t_ * signedOf(texel[1]) + v.normal * signedOf(texel[2]);
    if (ssbump_) {
        Vec3f sum;
        for (std::size_t i = 0; i < kRnmBasis.size(); ++i)
            sum += kRnmBasis[i] * float(texel[i]);
        bent = s_ * sum.x + t_ * sum.y + v.normal * sum.z;
    }
    bent = Normalize(bent);
    return bent == Vec3f{} ? v.normal : bent;
}

} // namespace q3
