// GPL-2.0-or-later. Which texels of a surface's lightmap hold light of that surface.
#pragma once

#include "q3map2/light/scene/light_space.h"
#include "tools/measure/lightmap_compare/lit_map.h"

namespace q3::compare {

/// Tells which lightmap texels of a map hold light of their own surface. A luxel is lit at an open point one unit above
/// its center or above a point half a luxel beside. If all of these are in solids, the luxel is unused, and packing may
/// put another lightmap there. Keeps a reference.
class LuxelCover {
  public:
    explicit LuxelCover(const LitMap &map);
    /// Whether all texels that the light at a position on the surface is blended from are covered. True on patches and
    /// on surfaces of brush entities, where positions are not known.
    bool Covers(std::size_t surface, const SurfacePoint &position) const;

  private:
    /// The surface around texel coordinates: xyz = origin + s along[0] + t along[1].
    struct TexelFrame {
        Vec3d origin, normal;
        std::array<Vec3d, 2> along;
    };
    bool IsOpen(const TexelFrame &frame, double s, double t) const;

    const LitMap &map_;
    BspSpace space_;
};

} // namespace q3::compare
