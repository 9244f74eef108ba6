// GPL-2.0-or-later. Shaders made for surfaces whose light one lightmap of the file cannot show.
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
    int file = -1;               ///< number of the page's image; -1: the page of the first style, by $lightmap
    std::array<float, 2> move{}; ///< from the lightmap coordinates of the first style to its own
};

/// Name of a page's image: the game's path to it.
std::string PagePath(std::string_view mapName, int file);

/// The shader's text with a stage for each style in place of its marker; empty when it has none.
std::string StyledText(const ShaderInfo &shader, std::span<const StyleStage> stages, const Entity &world,
                       std::string_view mapName);

/// The text (of StyledText, else empty for the shader's own) with the image of a page in place of its lightmap; empty
/// when it has no lightmap stage.
std::string ImageText(const ShaderInfo &shader, std::string text, int file, std::string_view mapName);

/// Name that only this text has: the map's and a checksum. At most 63 bytes.
std::string ShaderNameFor(std::string_view text, std::string_view mapName);
/// Whether ShaderNameFor made that name for this map.
bool IsMadeName(std::string_view shader, std::string_view mapName);

/// Number of the shader in the file, which gets it if it is new.
int ShaderNumber(Bsp &bsp, std::string_view name, std::uint32_t surfaceFlags, std::uint32_t contentFlags);

/// Last changes for a file; nothing else may be made of this Bsp. Where made shaders name images of pages, surfaces
/// without vertices come first whose shaders make engines load these images without mipmaps: the numbers of all
/// surfaces move. With -trisoup flat surfaces become triangle soups without lightmap.
void FinishForFile(const LightmapOptions &options, std::string_view mapName, StoredLightmaps &stored, Bsp &bsp);

/// Takes those first surfaces away again: a surface file counts without them. Before anything is made of a Bsp.
void RemoveMipmapHints(std::string_view mapName, Bsp &bsp);

} // namespace q3
