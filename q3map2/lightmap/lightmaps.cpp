// GPL-2.0-or-later. Light on surfaces: shared pieces.
#include "q3map2/lightmap/lightmaps.h"
