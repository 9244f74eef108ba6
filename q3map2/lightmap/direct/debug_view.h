// GPL-2.0-or-later. Debug views: luxels show something other than light.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Overwrites the light of every mapped luxel, style slot 0, with the view. Does nothing for DebugView::Light.
void DrawDebugView(DebugView view, RawLightmap &lightmap);

} // namespace q3
