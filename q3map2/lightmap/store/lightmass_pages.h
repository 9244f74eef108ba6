// GPL-2.0-or-later. -lightmass: L1 SH lightmaps as images in the layout of Unreal's Lightmass.
#pragma once

#include "common/files/files.h"
#include "q3map2/lightmap/encode/directional_encode.h"
#include "q3map2/lightmap/store/lightmap_layers.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Images of a lightmap page, rows top first. Images without baked data are empty.
struct LightmassPage {
    int number = -1; ///< lightmapNum of its surfaces; -1: generated shaders name its image
    int file = 0;    ///< number in the names of images
    int width = 0, height = 0;
    std::array<std::vector<std::uint8_t>, lightmass::kImages> coefficients; ///< RGBA
    std::vector<std::uint8_t> skyOcclusion;                                 ///< RGBA
    std::vector<std::uint8_t> unoccluded, coverage;                         ///< gray
    std::vector<std::vector<std::uint8_t>> shadows;                         ///< gray, by named light
};

/// A lightmap on a page.
struct LightmassPlace {
    std::vector<int> surfaces; ///< draw surfaces of the file
    int style = 0, page = 0, x = 0, y = 0, width = 0, height = 0;
    bool hasSkyOcclusion = false;
    lightmass::ByteRange range;
};

struct LightmassPages {
    std::vector<LightmassPage> pages; ///< as StoredLightmaps::pages; empty without -lightmass
    std::vector<LightmassPlace> places;
    std::vector<std::string> shadowLights; ///< names, in the order of LightmassPage::shadows
};

/// Encodes the packed layers that have L1 light. `pages` must have sizes and numbers; their images are made here.
void EncodeLightmass(const SurfaceInputs &in, const SurfaceLight &surfaces, const LightmapLayers &layers,
                     LightmassPages &pages);

/// Writes the images as FOLDER/lm_NNNN_WHAT.tga, NNNN the number of the page, and lightmass.json, which names them and
/// holds their byte ranges. mapName: the images are maps/MAPNAME/... for the game. Errors: Error, for files that cannot
/// be written.
void AddLightmass(const std::filesystem::path &folder, std::string_view mapName, const LightmassPages &pages,
                  FileSet &written, Log &log);

} // namespace q3
