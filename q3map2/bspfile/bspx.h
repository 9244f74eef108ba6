// GPL-2.0-or-later. The BSPX directory that may follow the header lumps.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp_codec.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Lumps with light grids for other engines, which gridformats writes.
inline constexpr std::string_view kBspxGridOctree = "LIGHTGRID_OCTREE", kBspxGrids = "LIGHTGRIDS";

inline constexpr std::size_t kBspxNameBytes = 24;
inline constexpr std::size_t kBspxHeadBytes = 8;
inline constexpr std::size_t kBspxEntryBytes = 32;

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
    std::string_view lump, fileName; ///< for messages
    Log &log;

    /// Throws Error with the names and the text.
    [[noreturn]] void Fail(std::string_view text) const;
    std::vector<std::byte> Bytes() const;
};

} // namespace q3
