// GPL-2.0-or-later. RBSP files (Soldier of Fortune II, Jedi Outcast, Jedi Academy) and FBSP files (qfusion): bytes to
// records and back. See docs/reference/bsp_format.md.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_codec.h"
#include "q3map2/bspfile/entities.h"

#include <cstddef>
#include <string_view>

namespace q3 {

/// Version of both formats, and lump entries of their header.
inline constexpr int kRbspVersion = 1;
inline constexpr std::size_t kRbspSlots = 18;

/// Key of worldspawn with the side of lightmap pages in FBSP files, a power of two.
inline constexpr std::string_view kLightmapImageSizeKey = "_lightmapimagesize";
/// The side of the lightmap pages of an FBSP file whose worldspawn this is.
int FbspLightmapSide(const Entity &world);

/// The two functions of BspCodec, for both formats: the records are the same. A grid point that
/// names no record becomes a black point in a wall, with a warning. Errors of encoding: over kMaxGridPoints grid
/// points. A grid with too many different points for its table is joined with a warning that says what is lost
/// (MakeGridTable).
Bsp DecodeRbsp(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);
ByteRanges EncodeRbsp(const Bsp &bsp, const BspFormat &format, Log &log);

} // namespace q3
