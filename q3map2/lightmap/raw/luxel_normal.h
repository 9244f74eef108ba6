// GPL-2.0-or-later. Normal mapping: q3map_normalImage, q3map_ssbumpImage.
#pragma once

#include "common/image/image.h"
#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// The normal map of one triangle.
class NormalMap {
  public:
    /// Not active without an image, or if the triangle has no area in texture space. Keeps a pointer to the image.
    NormalMap(const NormalImage &normals, const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c);
    bool Active() const { return image_ != nullptr; }
    /// The vertex normal perturbed by the nearest texel; call only if active. q3map_normalImage: Normalize(N + S s + T
    /// t + N n), components s, t, n in [-1, 1] from red, green, blue. q3map_ssbumpImage: Normalize(S x + T y + N z),
    /// with (x, y, z) the sum of the basis vectors of libs/math/rnm_basis.h times the channels; N where all are black.
    Vec3f Perturbed(const SurfaceVertex &v) const;

  private:
    const Image *image_;
    bool ssbump_;
    Vec3f s_, t_; ///< unit vectors along which the texture coordinates s and t grow
};

} // namespace q3
