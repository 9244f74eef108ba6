// GPL-2.0-or-later. Shaders generated for surfaces with several light styles or with a page outside the file.
#pragma once

#include "q3map2/bspfile/entities.h"
#include "q3map2/lightmap/store/lightmap_store.h"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A light style of a surface beyond its first, as a stage of a shader shows it.
struct StyleStage {
    std::uint8_t style = 0;
    int file = -1;                 ///< number of the page's image; -1: the page of the first style, by $lightmap
    std::array<float, 2> offset{}; ///< from the lightmap coordinates of the first style to its own
};

/// Name of a page's image: the game's path to it.
std::string PagePath(std::string_view mapName, int file);

/// The shader's text with a stage for each style in place of q3map_styleMarker; empty if it has no marker.
std::string StyledText(const ShaderInfo &shader, std::span<const StyleStage> stages, const Entity &world,
                       std::string_view mapName);

/// `text` (from StyledText; empty: the shader's own) with the image of a page in place of $lightmap; empty if it has no
/// lightmap stage.
std::string ImageText(const ShaderInfo &shader, std::string text, int file, std::string_view mapName);

/// `text` with a line that names the basis maps of a page and how they are stored. Engines without radiosity normal
/// mapping skip it, as they skip all q3map_ directives.
std::string WithBasisMaps(std::string text, std::string_view mapName, int file, bool rescaled);

/// Name of a generated shader: the map name and a checksum of the text. At most 63 bytes.
std::string ShaderNameFor(std::string_view text, std::string_view mapName);
/// Whether the name is one of ShaderNameFor for this map.
bool IsGeneratedName(std::string_view shader, std::string_view mapName);

/// Index of the shader in the file; adds it if it is new.
int ShaderNumber(Bsp &bsp, std::string_view name, std::uint32_t surfaceFlags, std::uint32_t contentFlags);

/// Last changes before writing the file; surface numbers change. If generated shaders name images of pages, puts
/// surfaces without vertices first ("mipmap hints"), whose shaders make engines load these images without mipmaps. With
/// -trisoup planar surfaces become triangle soups without lightmap.
void FinishForFile(const LightmapOptions &options, std::string_view mapName, StoredLightmaps &stored, Bsp &bsp);

/// Removes mipmap hints of an earlier run, so that surface numbers are again those of the surface file.
void RemoveMipmapHints(std::string_view mapName, Bsp &bsp);

} // namespace q3
