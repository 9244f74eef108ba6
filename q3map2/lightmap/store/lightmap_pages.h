// GPL-2.0-or-later. Lightmap pages and generated shaders as files beside the map.
#pragma once

#include "q3map2/lightmap/store/export_options.h"
#include "q3map2/lightmap/store/lightmap_store.h"

#include <filesystem>

namespace q3 {

/// Writes the pages that need an image as lm_NNNN.tga (24 bit, row 0 of the page on top) into the folder, which is
/// created if there is something to write, and then deletes files of higher numbers that an earlier run left, up to the
/// first gap. Errors: Error, for files that cannot be written.
void WritePages(const std::filesystem::path &folder, const StoredLightmaps &stored, Log &log);

/// Path of the generated shaders of a map: ../scripts/q3map2_NAME.shader, beside the folder of the map.
std::filesystem::path ScriptPath(const std::filesystem::path &bspPath, const Game &game);
/// Writes the generated shaders; without any, deletes the file of an earlier run.
void WriteScript(const std::filesystem::path &script, const StoredLightmaps &stored, Log &log);

/// Writes every page of the file as lightmap_NNNN.tga into the folder: rows in the order of the file, which the TGA
/// header declares as bottom up; and HDR light (hdr_pages.h). `side`: texels on a side of a page. Errors: as
/// WritePages.
void ExportLightmaps(const Bsp &bsp, int side, const std::filesystem::path &folder, Log &log,
                     const ExportOptions &options = {});
/// Replaces the pages of the file by such images; pages whose image is missing or has another size stay as they are,
/// with a warning. HDR light: hdr_pages.h. Errors: Error for a map without lightmaps of any kind, and for images that
/// cannot be read.
void ImportLightmaps(Bsp &bsp, int side, const std::filesystem::path &folder, Log &log,
                     const ExportOptions &options = {});

} // namespace q3
