// GPL-2.0-or-later. -shade: phong shading of vertex normals.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Vertices at one position whose normals differ by less than their shading angle get the mean normal. Does nothing
/// without -shade.
void SmoothNormals(const SurfaceInputs &in, SurfaceLight &surfaces);

} // namespace q3
