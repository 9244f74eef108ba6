// GPL-2.0-or-later. HDR lightmaps and basis maps: BSPX lumps of the map and images beside it.
#pragma once

#include "q3map2/lightmap/store/lightmap_store.h"

#include <filesystem>

namespace q3 {

/// Moves light in full range into the lumps of `bsp`: HDR light of its pages and vertices, basis maps of its pages.
/// Pages outside the file have none there. Call after the draw vertices are complete.
void StoreHdrLight(const LightmapOptions &options, const StoredLightmaps &stored, Bsp &bsp);

/// Writes HDR pages as FOLDER/lm_NNNN.hdr, .exr or .pfm with -hdrfiles (and pages outside the file always, as Radiance
/// unless it names another form), their basis maps as lm_NNNN_b1 to _b3, and for engines vertlight.raw. 8-bit basis
/// maps are TGA images beside those of their pages. Errors: Error, for files that cannot be written.
void WriteHdrFiles(const std::filesystem::path &folder, const LightmapOptions &options, const StoredLightmaps &stored,
                   Log &log);

} // namespace q3
