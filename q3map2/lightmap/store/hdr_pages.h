// GPL-2.0-or-later. HDR light of lightmap pages as images beside the map.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"

#include <filesystem>
#include <string>

namespace q3 {

/// Writes LIGHTING_E5BGR9 as lightmap_NNNN.EXT and LIGHTING_RNM as lightmap_NNNN_b1.EXT to _b3.EXT, in the row order of
/// ExportLightmaps. EXT is the format, exp32.json for exp32; by default exr, or pfm without OpenEXR. The formats rend2
/// and ioquake3 are the files that these engines load: lm_NNNN.hdr, and VERTEX_E5BGR9 as vertlight.raw. `side`: texels
/// on a side of a page. The folder must exist. Errors: Error for files that cannot be written, and if the HDR texels
/// are no multiple of side * side.
void ExportHdrLight(const Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &format, Log &log);
/// Reads such images back; without a format, the first of exr, pfm, hdr and exp32 that exists for a page. Pages without
/// an image stay as they are, and so do those whose image has another size, with a warning. Errors: Error for files
/// that cannot be read, and if the HDR texels are no multiple of side * side.
void ImportHdrLight(Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &format, Log &log);

} // namespace q3
