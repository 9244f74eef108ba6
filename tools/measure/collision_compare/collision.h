// GPL-2.0-or-later. Moving boxes against the brushes of a compiled map, as games move players.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"

#include <cstdint>
#include <vector>

namespace q3 {

/// Flags of shader contents in Quake III: CONTENTS_SOLID, CONTENTS_PLAYERCLIP.
inline constexpr std::uint32_t kSolidContents = 0x1, kPlayerClipContents = 0x10000;
/// Contents that stop a player.
inline constexpr std::uint32_t kPlayerContents = kSolidContents | kPlayerClipContents;

/// The brushes of a map's world. Keeps a reference to the Bsp. Patches do not collide here.
class CollisionMap {
  public:
    explicit CollisionMap(const Bsp &bsp) : bsp_(bsp) {}

    /// Where a move ends.
    struct Hit {
        bool startsInside = false; ///< the box touches a brush before it moves
        double fraction = 1;       ///< of the move, before the first hit
        Vec3d normal;              ///< of the plane hit; zero: none
        int brush = -1;            ///< that is hit; -1: none
    };
    /// Traces `box`, whose bounds are relative to its position, from start to end against brushes with any of these
    /// contents.
    Hit Move(const Boundsd &box, const Vec3d &start, const Vec3d &end, std::uint32_t contents = kPlayerContents) const;

  private:
    void Gather(const Boundsd &swept, std::vector<int> &brushes) const;
    void Clip(int brush, const Boundsd &box, const Vec3d &start, const Vec3d &end, Hit &hit) const;

    const Bsp &bsp_;
};

} // namespace q3
