// GPL-2.0-or-later. HDR light of lightmap pages as images beside the map.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"

#include <filesystem>
#include <string>

namespace q3 {

/// Writes LIGHTING_E5BGR9 as lightmap_NNNN.EXT and LIGHTING_RNM as lightmap_NNNN_b1.EXT to _b3.EXT, in the row order of
/// ExportLightmaps. EXT is the format, exp32.json for exp32; by default exr, or pfm without OpenEXR. The formats rend2
/// and ioquake3 are the files that these engines load: lm_NNNN.hdr, and VERTEX_E5BGR9 as vertlight.raw. side: of a
/// page, texels. The folder must be there. Errors: Error, for files that cannot be written and for pages of another
/// side.
void ExportHdrLight(const Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &format, Log &log);
/// Replaces what such images show; without a format, by the first of exr, pfm, hdr and exp32 that is there. Luxels
/// without an image stay as they are, as do those whose image has another size, with a warning. Errors: Error, for
/// files that cannot be read and for pages of another side.
void ImportHdrLight(Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &format, Log &log);

} // namespace q3
