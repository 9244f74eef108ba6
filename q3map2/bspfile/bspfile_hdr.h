// GPL-2.0-or-later. BSPX lumps of HDR light: LIGHTING_E5BGR9, VERTEX_E5BGR9, LIGHTING_RNM.
#pragma once

#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <cstdint>
#include <string>
#include <vector>

namespace q3 {

/// Reads a lump of E5BGR9 codes. Errors: a length that is not whole codes.
std::vector<std::uint32_t> ReadCodes(const BspxSource &from);
/// Reads LIGHTING_RNM. Errors: a bad head, a length that does not fit it.
RnmLightmaps ReadRnm(const BspxSource &from);
/// The bytes of LIGHTING_RNM.
ByteRanges RnmRanges(const RnmLightmaps &rnm);

// What does not fit the lightmaps or vertices of the map, or contradicts itself; empty: nothing.
std::string LightmapsFault(const Bsp &bsp);
std::string VertexFault(const Bsp &bsp);
std::string RnmFault(const Bsp &bsp);

} // namespace q3
