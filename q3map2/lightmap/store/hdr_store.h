// GPL-2.0-or-later. HDR light of lightmap pages and basis maps: BSPX lumps of the map, and images beside it.
#pragma once

#include "common/files/files.h"
#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/lightmap/store/lightmap_layers.h"
#include "q3map2/lightmap/store/lightmap_store.h"

#include <filesystem>
#include <string>

namespace q3 {

/// Sets `light` and `basis` of the pages on which `layers` were packed, as far as the options ask for them. Unit scale:
/// light times brightness over -compensate, without the rest of the tone mapping.
void SetPageLight(const SurfaceInputs &in, const LightmapLayers &layers, std::vector<LightmapPage> &pages);

/// Light in full range at the draw vertices of a surface, on the unit scale; see VertexBytes.
Vec3f VertexLightOf(const SurfaceInputs &in, const ShaderInfo &shader, const Vec3f &light, const ToneOptions &tone);

/// Writes LIGHTING_E5BGR9 as lightmap_NNNN.EXT and LIGHTING_RNM as lightmap_NNNN_b1.EXT to _b3.EXT, in the row order of
/// ExportLightmaps. EXT is formatName, exp32.json for exp32; if that is empty exr, or pfm without OpenEXR. The formats
/// rend2 and ioquake3 are the files that these engines load: lm_NNNN.hdr, and VERTEX_E5BGR9 as vertlight.raw. `side`:
/// texels on a side of a page. The folder must exist. Errors: Error for files that cannot be written, and if the HDR
/// texels are no multiple of side * side.
void AddHdrExport(const Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &formatName,
                  FileSet &written, Log &log);
/// Reads such images back; if formatName is empty, the first of exr, pfm, hdr and exp32 that exists for a page. Pages
/// without an image stay as they are, and so do those whose image has another size, with a warning. Errors: Error for
/// files that cannot be read, and if the HDR texels are no multiple of side * side.
void ImportHdrLight(Bsp &bsp, int side, const std::filesystem::path &folder, const std::string &formatName, Log &log);

/// Adds the BSPX lumps to `bsp`, which must have none of them: HDR light of pages and vertices, basis maps of pages.
/// Pages that are only images beside the map are left out. Call after the draw vertices are complete.
void StoreHdrLight(const LightmapOptions &options, const StoredLightmaps &stored, Bsp &bsp);

/// With -hdrfiles, writes HDR pages as FOLDER/lm_NNNN.hdr, .exr or .pfm, their basis maps as lm_NNNN_b1 to _b3, and
/// for rend2 and ioquake3 vertlight.raw. Pages outside the .bsp are written without -hdrfiles too, as Radiance, and
/// their 8-bit basis maps as TGA. Warns of HDR files of an earlier run. Errors: Error for files that cannot be written.
void AddHdrFiles(const std::filesystem::path &folder, const LightmapOptions &options, const StoredLightmaps &stored,
                 FileSet &written, Log &log);

} // namespace q3
