// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records and back. See docs/reference/bsp_format.md.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_codec.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Limit of clusters without visibility data, so that a damaged .bsp cannot cause huge allocations.
inline constexpr int kMaxClusters = 0x20000;
/// Limit of engines for clusters with visibility data, so also that of portal files.
inline constexpr int kMaxVisClusters = 16384;

/// Lump entries of a header: those of Quake III, and with the advertisements of Quake Live. The SH light grid makes it
/// kNumLumps.
inline constexpr std::size_t kClassicSlots = 17, kAdvertisementSlots = 18;

/// The two functions of BspCodec. Records of these files hold one light style: reading fills slot 0, writing drops the
/// others.
Bsp DecodeIbsp(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);
ByteRanges EncodeIbsp(const Bsp &bsp, const BspFormat &format, Log &log);

/// The lump of the legacy light grid: 8 bytes a point.
std::vector<std::byte> IbspGridLump(std::span<const bspGridPoint_t> points);

} // namespace q3
