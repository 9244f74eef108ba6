// GPL-2.0-or-later. Lightmap pages and generated shaders as files beside the map, and the options of -export and
// -import.
#pragma once

#include "common/files/files.h"
#include "common/image/float_image.h"
#include "common/settings.h"
#include "q3map2/lightmap/store/lightmap_store.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

// ---- Options of the stages -export and -import ----

struct ExportOptions {
    std::string hdrFormat; ///< exr, pfm, hdr, exp32, rend2 or ioquake3; empty: chosen by the stage
};

/// The options of -export and -import, declared.
std::vector<SettingGroup<ExportOptions>> ExportSettings();
/// Removes these options from `arguments`.
ExportOptions ParseExportOptions(Arguments &arguments, Log &log);

/// A JSON object with width, height and texels, each [r, g, b, exponent]; row 0 first. Precision: see EncodeRgbExp32.
std::vector<std::byte> EncodeExp32Json(const FloatImage &image);
/// Errors: Error for missing members, values out of range, and a list that is not width * height long.
FloatImage DecodeExp32Json(std::span<const std::byte> file, std::string_view name);

/// Writes the pages that need an image as lm_NNNN.tga (24 bit, row 0 of the page on top) into the folder, which is
/// created if there is something to write, and deletes files of higher numbers that an earlier run left, up to the
/// first gap. Errors: Error, for files that cannot be written.
void AddPages(const std::filesystem::path &folder, const StoredLightmaps &stored, FileSet &written, Log &log);

/// Path of the generated shaders of a map: ../scripts/q3map2_NAME.shader, beside the folder of the map.
std::filesystem::path ScriptPath(const std::filesystem::path &bspPath, const Game &game);
/// Writes the generated shaders; without any, deletes the file of an earlier run.
void AddScript(const std::filesystem::path &script, const StoredLightmaps &stored, FileSet &written, Log &log);

/// Writes every page of the file as lightmap_NNNN.tga into the folder: rows in the order of the file, which the TGA
/// header declares as bottom up; and HDR light (hdr_store.h). `side`: texels on a side of a page. Errors: as
/// AddPages.
void ExportLightmaps(const Bsp &bsp, int side, const std::filesystem::path &folder, Log &log,
                     const ExportOptions &options = {});
/// Replaces the pages of the file by such images; pages whose image is missing or has another size stay as they are,
/// with a warning. HDR light: hdr_store.h. Errors: Error for a map without lightmaps of any kind, and for images that
/// cannot be read.
void ImportLightmaps(Bsp &bsp, int side, const std::filesystem::path &folder, Log &log,
                     const ExportOptions &options = {});

} // namespace q3
