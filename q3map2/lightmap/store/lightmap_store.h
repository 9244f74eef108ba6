// GPL-2.0-or-later. Stores the light of surfaces in the Bsp: pages, coordinates, vertex colors, generated shaders.
#pragma once

#include "q3map2/light/options/light_tone.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/store/lightmass_pages.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Mean normal of the super luxels of a luxel.
inline Vec3f MeanNormal(const RawLightmap &lightmap, int x, int y) {
    Vec3f sum;
    for (int sy = y * lightmap.super; sy < (y + 1) * lightmap.super; ++sy)
        for (int sx = x * lightmap.super; sx < (x + 1) * lightmap.super; ++sx)
            if (const std::size_t at = lightmap.SuperIndex(sx, sy); lightmap.luxelClusters[at] != kUnmapped)
                sum += lightmap.normals[at];
    return sum == Vec3f{} ? lightmap.planeNormal : Normalize(sum);
}

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

/// The same for light of a style other than 0.
inline std::array<std::uint8_t, 3> StyledVertexBytes(const SurfaceInputs &in, const ShaderInfo &shader,
                                                     const Vec3f &light, const ToneOptions &tone) {
    return ColorToBytes(light, VertexScale(in, shader), 1, tone);
}

/// Name of the image of a page, without folder and extension.
inline std::string PageImageName(int file) {
    return fmt::format("lm_{:04}", file);
}
/// Name of the image of a page's light on a basis normal: lm_NNNN_b1 to lm_NNNN_b3 for `basis` from 0 to 2.
inline std::string BasisImageName(int file, std::size_t basis) {
    return fmt::format("{}_b{}", PageImageName(file), basis + 1);
}

/// A lightmap page: RGB rows.
struct LightmapPage {
    int width = 128, height = 128;
    int number = -1;         ///< lightmapNum of its surfaces; -1: only generated shaders name its image
    int file = 0;            ///< number of its image; deluxe: the page of directions has the next one
    bool needsImage = false; ///< an image file is needed; unless -external, the .bsp holds the page too if number >= 0
    std::vector<std::uint8_t> colors;     ///< empty under -hdr
    std::vector<std::uint8_t> directions; ///< deluxe: bytes of the page after it; else empty

    // Linear light, unit scale: 1 is byte 255.
    std::vector<Vec3f> light;                ///< -hdr, -both; else empty
    std::array<std::vector<Vec3f>, 3> basis; ///< -rnm: light on the basis normals; empty if no lightmap here has it

    std::size_t Texels() const { return std::size_t(width) * std::size_t(height); }
    std::size_t Index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
    bool HasBasis() const { return !basis[0].empty(); }
};

/// Results of storing that are not in the Bsp.
struct StoredLightmaps {
    std::vector<LightmapPage> pages;
    struct Script {
        std::string shader, text;
    };
    std::vector<Script> scripts;    ///< generated shaders, each once
    LightmassPages lightmass;       ///< -lightmass; else empty
    std::vector<Vec3f> vertexLight; ///< -hdr, -both: linear light by draw vertex, unit scale; else empty
};

/// Packs results into pages and writes them, coordinates, numbers and vertex colors into `bsp`. Takes the directional
/// channels out of `surfaces`. mapName: without path and extension.
StoredLightmaps StoreLightmaps(const SurfaceInputs &in, SurfaceLight &surfaces, std::string_view mapName, Bsp &bsp);

} // namespace q3
