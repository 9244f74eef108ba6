// GPL-2.0-or-later. The tone of the lightmaps, for grids that hold bytes.
#pragma once

#include "common/log.h"
#include "libs/math/vec.h"
#include "libs/shgrid/shgrid.h"

#include <array>
#include <cstdint>
#include <string_view>

namespace q3 {

/// Turns linear light, where 1 is byte 255, into what lightmaps would store.
class GridTone {
  public:
    /// The entities text of a map, whose key _q3map2_tone counts. A key that cannot be read warns and is plain.
    GridTone(std::string_view entities, Log &log);
    /// `tone`: a value of that key; empty: plain. Errors: it cannot be read.
    explicit GridTone(const char *tone = "");

    bool IsPlain() const;
    /// From 0 to 255, or to `_maxlight`; brighter colors are scaled down with their hue.
    Vec3d Limited(const Vec3d &light) const;
    /// The same without the upper limit, unless `_maxlight` sets one below 255.
    Vec3d Unlimited(const Vec3d &light) const;
    /// Limited, rounded.
    std::array<std::uint8_t, 3> Bytes(const Vec3d &light) const;

  private:
    shgrid_tone tone_{};
};

} // namespace q3
