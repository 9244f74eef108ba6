// GPL-2.0-or-later. The BSPX directory, and the table of the lumps that Bsp has members for: how each is read, written
// and checked.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_codec.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Lumps with light grids for other engines, which gridformats writes.
inline constexpr std::string_view kBspxGridOctree = "LIGHTGRID_OCTREE", kBspxGrids = "LIGHTGRIDS";

// The directory: a head of "BSPX" and a count, then entries of a name, an offset and a length.
inline constexpr std::size_t kBspxHeadBytes = 8;
inline constexpr std::size_t kBspxEntryBytes = 32;
inline constexpr std::size_t kBspxNameBytes = 24; ///< of an entry's name, filled with NULs

/// An entry of a BSPX directory.
struct BspxPart {
    std::string name;
    FilePart part;
};

/// The BSPX directory at `start`, if there is one. A malformed directory causes a warning and gives no lumps; of two
/// lumps with one name the first is kept.
std::vector<BspxPart> ReadBspx(const ByteSource &file, std::uint64_t start, std::string_view name, Log &log);
/// The bytes of a directory; empty without lumps.
std::vector<std::byte> BspxDirectory(const std::vector<BspxPart> &lumps);

/// A lump of a file that is being read.
struct BspxSource {
    const ByteSource &file;
    FilePart part;
    std::string_view lump, fileName; ///< names for messages
    Log &log;

    /// Throws Error with the names and the text.
    [[noreturn]] void Fail(std::string_view text) const;
    /// All bytes of the lump.
    std::vector<std::byte> Bytes() const;
};

/// The lumps, in the order in which they are written. Lumps of other programs, which stay bytes, follow the first.
enum class BspxId {
    PropLight,
    LightGridSH,
    LightmapsE5bgr9,
    VertexE5bgr9,
    Rnm,
    SparseGridSH,
    NamedGridSH,
    AmbientCubes,
    Count
};
inline constexpr std::size_t kBspxIdCount = std::size_t(BspxId::Count);

/// After which bakes a lump is stale: it has light of an earlier bake, which does not match the new one.
enum class StaleAfter {
    EveryBake,  ///< those of grids alone too
    SurfaceBake ///< those that light surfaces
};
/// Whether such lumps are stale after a bake. `onlyGrid`: it lights no surfaces (-onlygrid).
constexpr bool MakesStale(StaleAfter staleAfter, bool onlyGrid) {
    return staleAfter == StaleAfter::EveryBake || !onlyGrid;
}

/// A lump. Functions may be null where there is nothing to do; `write` is called only for maps that have the lump.
struct BspxRow {
    BspxId id;
    std::string_view name;
    std::string_view content; ///< for messages: "ambient cubes"
    StaleAfter staleAfter;
    bool (*has)(const Bsp &bsp);
    void (*clear)(Bsp &bsp);
    void (*read)(const BspxSource &from, Bsp &bsp); ///< errors: bytes that are no such lump
    ByteRanges (*write)(const Bsp &bsp);
    /// What does not fit the other records of the map; empty: nothing. Such a lump of a file is dropped with a
    /// warning, since another program has changed the map; elsewhere it is an error.
    std::string (*misfit)(const Bsp &bsp);
    /// Errors: a lump that contradicts itself. `name` is for messages.
    void (*check)(const Bsp &bsp, std::string_view name);
};

/// A row for each lump, by BspxId.
std::span<const BspxRow> BspxRows();
inline const BspxRow &RowOf(BspxId id) {
    return BspxRows()[std::size_t(id)];
}
/// Null: another program's lump.
const BspxRow *FindBspxRow(std::string_view name);

/// For tables of other libraries, whose rows have a BspxId `id`: whether each lump has one row.
template <typename Row, std::size_t N> consteval bool HasRowOfEachLump(const Row (&rows)[N]) {
    std::array<int, kBspxIdCount> counts{};
    for (const Row &row : rows)
        ++counts[std::size_t(row.id)];
    return std::ranges::all_of(counts, [](int count) { return count == 1; });
}
/// The row of a lump in such a table.
template <typename Rows> constexpr const auto &RowOf(const Rows &rows, BspxId id) {
    return *std::ranges::find_if(rows, [id](const auto &row) { return row.id == id; });
}

/// Whether the lump is in the BSPX directory: the uniform SH grid may be in lump 18 instead.
bool IsInBspx(const Bsp &bsp, const BspxRow &row);
/// Bytes of the lump, wherever it is; 0: the map has none.
std::uint64_t BytesOfLump(const Bsp &bsp, BspxId id);
/// Bytes of all lumps in the BSPX directory.
std::uint64_t BytesOfBspx(const Bsp &bsp);

/// Errors: lumps that contradict themselves or do not fit the map.
void CheckBspxLumps(const Bsp &bsp, std::string_view name);
/// Drops lumps that do not fit the map, each with a warning.
void DropUnfitLumps(Bsp &bsp, std::string_view name, Log &log);
/// Drops the lumps whose row has this value.
void DropStaleLumps(Bsp &bsp, StaleAfter staleAfter);

/// Reads the BSPX lumps of a file whose directory would be at `start`. Errors: those of the readers of lumps.
void ReadBspxLumps(const ByteSource &file, std::uint64_t start, std::string_view name, Bsp &bsp, Log &log);
/// A lump that is to be written.
struct BspxOutput {
    std::string_view name;
    ByteRanges bytes;
};
/// All lumps of the map in the order of the file. Errors: names that are too long.
std::vector<BspxOutput> WriteBspxLumps(const Bsp &bsp);

} // namespace q3
