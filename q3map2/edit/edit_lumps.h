// GPL-2.0-or-later. BSPX lumps of maps that were scaled, moved or merged.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/edit/edit_grids.h"

#include <string_view>

namespace q3 {

/// Keeps lumps without positions and transforms positions in lumps of known formats. Other lumps may hold positions:
/// each is dropped with a warning.
void TransformLumps(const AxisTransform &transform, Bsp &bsp, Log &log);

/// Merges the lumps into `bsp`, which is `main` with the entities of `added` after its own: light of static props is
/// that of both maps, light grids are those of `main`. Other lumps fit neither the records nor the entities of the
/// merged map: each is dropped with a warning, as are grids of `added` if `main` has none.
void MergeLumps(const Bsp &main, const Bsp &added, std::string_view mainName, std::string_view addedName, Bsp &bsp,
                Log &log);

} // namespace q3
