// GPL-2.0-or-later. Tangents of luxels from texture coordinates.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Sets the tangents of the raw lightmaps that have basis channels: the mean texture axis of the triangles that pass
/// through a luxel. Mapped luxels that no triangle covers take the mean of their neighbors. Call after MapLuxels.
void FindTangents(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
