// GPL-2.0-or-later. Macro textures: images over the whole world that tint lightmaps and vertex light.
#pragma once

#include "common/image/image.h"
#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// An image seen from above: its left edge is at mins.x, its lowest row at mins.y.
class MacroTexture {
  public:
    /// Keeps a reference to the image. The box is not empty along x and y.
    MacroTexture(const Image &image, const Boundsf &world) : image_(image), world_(world) {}

    /// Factor of light at a position: the linear color of the nearest texel times its alpha, 0 to 1. Positions outside
    /// of the world take the texel at its edge.
    Vec3f At(const Vec3f &position) const;

  private:
    const Image &image_;
    Boundsf world_;
};

/// Sets the tint of all raw lightmaps with a macro texture. Before the positions of luxels are freed. Error: the world
/// has no extent.
void FindTints(const SurfaceInputs &in, SurfaceLight &surfaces);

/// Multiplies the results by the tint: light and directional channels of all styles, in lightmaps and at vertices.
void ApplyTints(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
