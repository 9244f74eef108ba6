// GPL-2.0-or-later. BSPX lumps of HDR light: LIGHTING_E5BGR9, VERTEX_E5BGR9, LIGHTING_RNM.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <string_view>

namespace q3 {

struct ByteSource;
struct BspxPart;

/// Whether a BSPX lump of this name is a member of Bsp.
bool IsHdrLump(std::string_view name);
/// Reads such a lump into its member; false: it is another lump. Errors: a length or a head of LIGHTING_RNM that no
/// program writes.
bool ReadHdrLump(const ByteSource &file, const BspxPart &lump, std::string_view name, Bsp &bsp);

/// Errors: HDR light that does not fit the lightmaps or vertices of the map, or in itself.
void CheckHdrLight(const Bsp &bsp, std::string_view name);
/// Drops such light with a warning: another program has changed the map.
void DropUnfitHdrLight(Bsp &bsp, std::string_view name, Log &log);
/// All three lumps, for a map that is lit again.
void ClearHdrLight(Bsp &bsp);

} // namespace q3
