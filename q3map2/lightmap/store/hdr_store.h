// GPL-2.0-or-later. HDR lightmaps and basis maps: BSPX lumps of the map and images beside it.
#pragma once

#include "q3map2/lightmap/store/lightmap_store.h"

#include <filesystem>

namespace q3 {

/// Adds the BSPX lumps to `bsp`, which must have none of them: HDR light of pages and vertices, basis maps of pages.
/// Pages that are only images beside the map are left out. Call after the draw vertices are complete.
void StoreHdrLight(const LightmapOptions &options, const StoredLightmaps &stored, Bsp &bsp);

/// With -hdrfiles, writes HDR pages as FOLDER/lm_NNNN.hdr, .exr or .pfm, their basis maps as lm_NNNN_b1 to _b3, and
/// for rend2 and ioquake3 vertlight.raw. Pages outside the .bsp are written without -hdrfiles too, as Radiance, and
/// their 8-bit basis maps as TGA. Warns of HDR files of an earlier run. Errors: Error for files that cannot be written.
void WriteHdrFiles(const std::filesystem::path &folder, const LightmapOptions &options, const StoredLightmaps &stored,
                   Log &log);

} // namespace q3
