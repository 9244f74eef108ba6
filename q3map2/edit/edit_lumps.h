// GPL-2.0-or-later. BSPX lumps of maps that were scaled, moved or merged.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/edit/edit_grids.h"

#include <string_view>

namespace q3 {

/// Lumps without positions stay, positions in known ones are transformed. Others may hold positions, and are dropped
/// with a warning each.
void TransformLumps(const AxisTransform &transform, Bsp &bsp, Log &log);

/// The lumps of `bsp`, which is `main` with the entities of `added` behind its own: light of static props is that of
/// both maps, and light grids are those of the first. Others fit neither the records nor the entities of the merged
/// map, and are dropped with a warning each, as are grids of the second map if the first has none.
void MergeLumps(const Bsp &main, const Bsp &added, std::string_view mainName, std::string_view addedName, Bsp &bsp,
                Log &log);

} // namespace q3
