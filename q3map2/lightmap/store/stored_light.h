// GPL-2.0-or-later. Tone and vertex colors as the .bsp stores them. Internal to the folder.
#pragma once

#include "q3map2/light/tone/light_tone.h"
#include "q3map2/lightmap/raw/lightmaps.h"

#include <algorithm>

namespace q3 {

/// Tone of lightmaps and vertices, limited by worldspawn's _maxlight.
inline ToneOptions StoredTone(const SurfaceInputs &in) {
    ToneOptions tone = in.options.tone;
    tone.maxLight = std::min(tone.maxLight, in.world.maxLight);
    return tone;
}

/// Factor of vertex light on a surface with `shader`.
inline float VertexScale(const SurfaceInputs &in, const ShaderInfo &shader) {
    return shader.vertexScale * in.lightmap.vertexScale;
}

/// Stored color of a vertex that receives `light` (byte scale), on a surface with `shader`.
inline std::array<std::uint8_t, 3> VertexBytes(const SurfaceInputs &in, const ShaderInfo &shader, const Vec3f &light,
                                               const ToneOptions &tone) {
    return ColorToBytes(Max(light, in.world.minVertex), VertexScale(in, shader), 1, tone);
}

} // namespace q3
