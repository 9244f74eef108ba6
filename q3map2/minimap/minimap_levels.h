// GPL-2.0-or-later. Level curves of minimaps. Internal to minimaps.
#pragma once

#include "q3map2/minimap/minimap.h"

namespace q3 {

/// Boost, automatic level, brightness and contrast, in this order, then sharpening.
void ApplyMinimapLevels(MinimapValues &image, const MinimapOptions &options, Log &log);

} // namespace q3
