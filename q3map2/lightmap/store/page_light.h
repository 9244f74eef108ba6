// GPL-2.0-or-later. Light of lightmap pages in full range: HDR pages and the basis maps of radiosity normal mapping.
#pragma once

#include "q3map2/lightmap/store/lightmap_layers.h"
#include "q3map2/lightmap/store/lightmap_store.h"

namespace q3 {

/// Sets `light` and `basis` of the pages on which `stored` was packed, as far as the options ask for them. Unit scale:
/// light times brightness over -compensate, without the rest of the tone mapping.
void SetPageLight(const SurfaceInputs &in, const LightmapLayers &stored, std::vector<LightmapPage> &pages);

/// Light in full range at the draw vertices of a surface, on the unit scale; see VertexBytes.
Vec3f VertexLightOf(const SurfaceInputs &in, const ShaderInfo &shader, const Vec3f &light, const ToneOptions &tone);

} // namespace q3
