// GPL-2.0-or-later. Compiled maps as files on disk. Includes what users of the folder need.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_hdr.h"
#include "q3map2/bspfile/bspfile_ibsp.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace q3 {

/// ReadBsp from disk, without the file image in memory.
Bsp ReadBspFile(const std::filesystem::path &path, const BspFormat &format, Log &log);
/// The exact bytes of the file. The same Bsp always gives the same bytes. Errors: 2^31 bytes or
/// more, a bad SH grid, a BSPX lump name that is too long.
std::vector<std::byte> WriteBsp(const Bsp &bsp, const BspFormat &format);
/// Writes the bytes of WriteBsp without a second copy in memory. Replaces the file by a complete one or leaves the old
/// one unchanged. Prints path and size.
void WriteBspFile(const std::filesystem::path &path, const Bsp &bsp, const BspFormat &format, Log &log);

} // namespace q3
