// GPL-2.0-or-later. The SH light grid: where its points are lit from, and their light.
#pragma once

#include "q3map2/light/grid/grid_pass.h"

#include <vector>

namespace q3 {

/// Points of an SH grid of that cell, which is enlarged until the lump stays under 2^31 bytes.
GridLayout LayoutGridSH(const Bsp &bsp, Float3 size);
/// SH grid: -gridsh or the legacy cell size divided by -gridscalesh, at least 8, enlarged as LayoutGridSH does.
GridLayout SetupGridSH(const Bsp &bsp, const Float3 &legacySize, const LightOptions &options, Log &log);
/// The SH light grid: points in the open lit exactly, points in solids next to the open filled and fitted, others zero.
LightGridSH TraceGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                        GridStats &stats);

} // namespace q3
