// GPL-2.0-or-later. The BSPX directory that may follow the header lumps.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bspfile_ibsp.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// Lumps with light grids for other engines, which gridformats writes.
inline constexpr std::string_view kBspxGridOctree = "LIGHTGRID_OCTREE", kBspxGrids = "LIGHTGRIDS";

/// An entry of a BSPX directory.
struct BspxPart {
    std::string name;
    FilePart part;
};

/// The BSPX directory at `start`, if there is one. A malformed directory causes a warning and gives no lumps; of two
/// lumps with one name the first is kept.
std::vector<BspxPart> ReadBspx(const ByteSource &file, std::uint64_t start, std::string_view name, Log &log);

} // namespace q3
