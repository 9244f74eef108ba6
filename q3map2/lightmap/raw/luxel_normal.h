// GPL-2.0-or-later. Normals from images: q3map_normalImage.
#pragma once

#include "common/image/image.h"
#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// The normal map of one triangle.
class NormalMap {
  public:
    /// No image, or a triangle without area in texture space: normals stay as they are. Keeps a reference.
    NormalMap(const Image *image, const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c);
    bool Active() const { return image_ != nullptr; }
    /// The vertex's normal bent by the nearest texel, a unit vector.
    Vec3f Bent(const SurfaceVertex &v) const;

  private:
    const Image *image_;
    Vec3f s_, t_; ///< unit directions of growing texture coordinates
};

} // namespace q3
