// GPL-2.0-or-later. Which surfaces share a raw lightmap, its size and its projection, and the phong shading of its
// normals.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"

namespace q3 {

/// Vertices at one position whose normals differ by less than their shading angle get the mean normal. Does nothing
/// without -shade.
void SmoothNormals(const SurfaceInputs &in, SurfaceLight &surfaces);

/// What the options say about surfaces, without ambient light.
SurfaceDefaults SurfaceDefaultsOf(const LightmapOptions &options);

/// Vertices, clusters and raw lightmaps of all draw surfaces. Logs how many surfaces get a lightmap.
SurfaceLight SetupSurfaceLight(const SurfaceInputs &in);

} // namespace q3
