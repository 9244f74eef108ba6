// GPL-2.0-or-later. What luxels show instead of light, for looking into a map.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Sets every mapped luxel of style slot 0 to what `show` asks for.
void DrawDebugView(DebugView show, RawLightmap &lightmap);

} // namespace q3
