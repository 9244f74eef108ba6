// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records and back. See docs/bsp_format.md.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_codec.h"
#include "q3map2/bspfile/bsp_records.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Limit of clusters without visibility data, so that a damaged .bsp cannot cause huge allocations.
inline constexpr int kMaxClusters = 0x20000;
/// Limit of engines for clusters with visibility data, so also that of portal files.
inline constexpr int kMaxVisClusters = 16384;

/// Lump names for messages, by slot.
inline constexpr std::array<std::string_view, kNumLumps> kLumpNames = {
    "entities",  "shaders",    "planes",     "nodes",          "leafs",        "leaf surfaces", "leaf brushes",
    "models",    "brushes",    "sides",      "verts",          "indexes",      "fogs",          "surfaces",
    "lightmaps", "light grid", "visibility", "advertisements", "SH light grid"};

/// Lump entries of a header: those of Quake III, and with the advertisements of Quake Live. The SH light grid makes it
/// kNumLumps.
inline constexpr std::size_t kClassicSlots = 17, kAdvertisementSlots = 18;

/// Bytes of a header with `slots` lump entries: ident and version, then offset and length of each lump.
constexpr std::size_t HeaderBytes(std::size_t slots) {
    return 8 + 8 * slots;
}

/// Calls visit(slot, vector) for every lump that is a plain array of records.
template <typename AnyBsp, typename Visit> void ForEachArray(AnyBsp &bsp, Visit &&visit) {
    visit(LUMP_SHADERS, bsp.shaders);
    visit(LUMP_PLANES, bsp.planes);
    visit(LUMP_NODES, bsp.nodes);
    visit(LUMP_LEAFS, bsp.leafs);
    visit(LUMP_LEAFSURFACES, bsp.leafSurfaces);
    visit(LUMP_LEAFBRUSHES, bsp.leafBrushes);
    visit(LUMP_MODELS, bsp.models);
    visit(LUMP_BRUSHES, bsp.brushes);
    visit(LUMP_BRUSHSIDES, bsp.brushSides);
    visit(LUMP_DRAWVERTS, bsp.drawVerts);
    visit(LUMP_DRAWINDEXES, bsp.drawIndexes);
    visit(LUMP_FOGS, bsp.fogs);
    visit(LUMP_SURFACES, bsp.drawSurfaces);
    visit(LUMP_LIGHTMAPS, bsp.lightmaps);
    visit(LUMP_LIGHTGRID, bsp.gridPoints);
    visit(LUMP_VISIBILITY, bsp.visibility);
    visit(LUMP_ADVERTISEMENTS, bsp.advertisements);
}

/// Layout of a file.
struct FilePlan {
    std::size_t slots = kClassicSlots;
    std::array<FilePart, kNumLumps> lumps{}; ///< only the first `slots` are in the file
    std::uint64_t bspxStart = 0;             ///< position of the BSPX directory, when there is one
    std::vector<FilePart> bspx;              ///< the lumps of that directory, in its order
    std::uint64_t size = 0;                  ///< of the whole file
};

/// Lays out the lumps. `slots` is 17, 18 or 19; an empty slot 17 of a 19-slot file gets offset 0. Errors: a file of
/// 2^31 bytes or more, which no reader could address.
FilePlan PlanFile(std::size_t slots, const std::array<std::uint64_t, kNumLumps> &lengths,
                  std::span<const std::uint64_t> bspxLengths);

/// BspCodec::ident of these files, and its two functions.
inline constexpr std::string_view kIbspIdent = "IBSP";
Bsp DecodeIbsp(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);
ByteRanges EncodeIbsp(const Bsp &bsp, const BspFormat &format);

} // namespace q3
