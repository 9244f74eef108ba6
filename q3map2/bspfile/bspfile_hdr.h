// GPL-2.0-or-later. BSPX lumps of HDR light: LIGHTING_E5BGR9, VERTEX_E5BGR9, LIGHTING_RNM.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <string_view>

namespace q3 {

struct ByteSource;
struct BspxPart;

/// Whether this BSPX lump is one of HDR light, which Bsp has members for.
bool IsHdrLump(std::string_view name);
/// Reads such a lump into its member; false: it is another lump. Errors: a length that is not
/// whole codes, an invalid LIGHTING_RNM.
bool ReadHdrLump(const ByteSource &file, const BspxPart &lump, std::string_view name, Bsp &bsp);

/// Errors: Error if HDR light does not fit the lightmaps or vertices of the map, light of static props (prop_light.h)
/// does not fit its entities, or either contradicts itself.
void CheckHdrLight(const Bsp &bsp, std::string_view name);
/// Drops such light with a warning: another program has changed the map.
void DropUnfitHdrLight(Bsp &bsp, std::string_view name, Log &log);
/// Removes the three lumps of HDR light, before the map is lit again.
void ClearHdrLight(Bsp &bsp);

} // namespace q3
