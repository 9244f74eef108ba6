// GPL-2.0-or-later. Stores the light of surfaces in the Bsp: pages, coordinates, vertex colors, generated shaders.
#pragma once

#include "q3map2/lightmap/raw/lightmaps.h"
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A lightmap page: RGB rows.
struct LightmapPage {
    int width = 128, height = 128;
    int number = -1;       ///< lightmapNum of its surfaces; -1: only generated shaders name its image
    int file = 0;          ///< number of its image; deluxe: the page of directions has the next one
    bool external = false; ///< the image is needed
    std::vector<std::uint8_t> colors;
    std::vector<std::uint8_t> directions; ///< deluxe: the page after it; else empty
};

/// Results of storing that are not in the Bsp.
struct StoredLightmaps {
    std::vector<LightmapPage> pages;
    struct Script {
        std::string shader, text;
    };
    std::vector<Script> scripts; ///< generated shaders, each once
};

/// Packs results into pages and writes them, coordinates, numbers and vertex colors into `bsp`. mapName: without path
/// and extension.
StoredLightmaps StoreLightmaps(const SurfaceInputs &in, const SurfaceLight &surfaces, std::string_view mapName,
                               Bsp &bsp);

} // namespace q3
