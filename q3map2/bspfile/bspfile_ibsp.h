// GPL-2.0-or-later. IBSP files of version 46 and 47: bytes to records and back. See docs/bsp_format.md.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_records.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Limit of clusters without visibility data, so that a damaged .bsp cannot cause huge allocations.
inline constexpr int kMaxClusters = 0x20000;
/// Limit of engines for clusters with visibility data, so also that of portal files.
inline constexpr int kMaxVisClusters = 16384;
inline constexpr std::size_t kBspxNameBytes = 24;
inline constexpr std::size_t kBspxHeadBytes = 8;
inline constexpr std::size_t kBspxEntryBytes = 32;

/// Lump names for messages, by slot.
inline constexpr std::array<std::string_view, kNumLumps> kLumpNames = {
    "entities",  "shaders",    "planes",     "nodes",          "leafs",        "leaf surfaces", "leaf brushes",
    "models",    "brushes",    "sides",      "verts",          "indexes",      "fogs",          "surfaces",
    "lightmaps", "light grid", "visibility", "advertisements", "SH light grid"};

/// Bytes of a header with `slots` lump entries.
constexpr std::size_t HeaderBytes(std::size_t slots) {
    return 8 + 8 * slots;
}

/// Position rounded up to the next multiple of 4.
constexpr std::uint64_t Align4(std::uint64_t position) {
    return (position + 3) & ~std::uint64_t(3);
}

/// A part of a file. 64 bits, so that sums of untrusted 32-bit values cannot wrap.
struct FilePart {
    std::int64_t offset = 0, length = 0;
    std::int64_t End() const { return offset + length; }
};

/// Loads a record from byte `at`, which need not be aligned.
template <typename Record> Record LoadRecord(std::span<const std::byte> bytes, std::size_t at) {
    Record record;
    std::memcpy(&record, bytes.data() + at, sizeof record);
    return record;
}

/// Where a file is read from: memory or disk.
struct ByteSource {
    std::uint64_t size = 0;
    std::function<void(std::uint64_t at, std::span<std::byte> into)> read; ///< the range must lie in the file

    /// Reads consecutive records from byte `at`.
    template <typename Record> void Fill(std::uint64_t at, std::span<Record> records) const {
        static_assert(std::is_trivially_copyable_v<Record>);
        if (!records.empty())
            read(at, std::as_writable_bytes(records));
    }
};

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
    std::size_t slots = 17;
    std::array<FilePart, kNumLumps> lumps{}; ///< only the first `slots` are in the file
    std::uint64_t bspxStart = 0;             ///< position of the BSPX directory, when there is one
    std::vector<FilePart> bspx;
    std::uint64_t size = 0; ///< of the whole file
};

/// Lays out the lumps. `slots` is 17, 18 or 19; an empty slot 17 of a 19-slot file gets offset 0. Errors: a file of
/// 2^31 bytes or more, which no reader could address.
FilePlan PlanFile(std::size_t slots, const std::array<std::uint64_t, kNumLumps> &lengths,
                  std::span<const std::uint64_t> bspxLengths);

/// A .bsp file as a list of memory ranges. Most of them point into the Bsp, which must outlive this.
class BspPieces {
  public:
    using Append = std::function<void(std::span<const std::byte>)>;

    /// Errors: those of WriteBsp.
    BspPieces(const Bsp &bsp, const BspFormat &format);
    BspPieces(const BspPieces &) = delete; // pieces view headers of this object
    BspPieces &operator=(const BspPieces &) = delete;
    std::uint64_t Size() const { return plan_.size; }
    /// Appends all bytes of the file in order.
    void Write(const Append &append) const;

  private:
    using Pieces = std::vector<std::span<const std::byte>>; ///< consecutive ranges of one lump

    void TakeLumps(const Bsp &bsp, const BspFormat &format);
    void TakeBspx(const Bsp &bsp);
    void MakeHeader(int version);
    void MakeDirectory();

    std::array<Pieces, kNumLumps> lumps_;
    std::vector<std::string_view> bspxNames_;
    std::vector<Pieces> bspx_;
    FilePlan plan_;
    std::vector<std::byte> header_, directory_;
    bspCubeHeader_t cubeHeader_;
    bspSparseGridHeader_t sparseHeader_;
};

// ---- IBSP files of version 46 and 47: bytes to records ----

struct ByteSource;

/// Parses and validates a whole file in memory. `name` is for messages. Errors: Error, one line, for anything that a
/// later stage could trip over; recoverable oddities are warnings.
Bsp ReadBsp(std::span<const std::byte> file, std::string_view name, const BspFormat &format, Log &log);
/// The same from any source. Each byte is read once, into the records.
Bsp ReadBspFrom(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);

} // namespace q3
