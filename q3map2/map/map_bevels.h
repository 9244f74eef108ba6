// GPL-2.0-or-later. Bevel planes of brushes.
#pragma once

#include "q3map2/map/map.h"

namespace q3 {

/// Appends the bevel planes that boxes of any size need to collide with the brush exactly: axial planes, and planes
/// through slanted edges. To be called once, after MakeBrushWindings. `snap`: axial bevels are rounded to multiples of
/// it, game units; 0: off. inheritedFlags: surface flags that bevels take over from the sides that they touch.
void AddBrushBevels(Brush &brush, PlaneTable &planes, int snap, std::uint32_t inheritedFlags);

} // namespace q3
