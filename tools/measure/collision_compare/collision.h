// GPL-2.0-or-later. Moving boxes against the brushes of a compiled map, as games move players.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// Contents that stop a player: solid, playerclip.
inline constexpr std::uint32_t kPlayerContents = 0x1 | 0x10000;

/// The brushes of a map's world. Keeps a reference to the Bsp. Patches do not collide here.
class CollisionMap {
  public:
    explicit CollisionMap(const Bsp &bsp) : bsp_(bsp) {}

    struct Hit {
        bool startsInside = false; ///< the box touches a brush before it moves
        double fraction = 1;       ///< of the move, before the first hit
        Vec3d normal;              ///< of the plane hit; zero: none
        int brush = -1;
    };
    /// Traces `box`, whose bounds are relative to its position, from start to end.
    Hit Move(const Boundsd &box, const Vec3d &start, const Vec3d &end, std::uint32_t contents = kPlayerContents) const;

  private:
    void Gather(const Boundsd &swept, std::vector<int> &brushes) const;
    void Clip(int brush, const Boundsd &box, const Vec3d &start, const Vec3d &end, Hit &hit) const;

    const Bsp &bsp_;
};

} // namespace q3
