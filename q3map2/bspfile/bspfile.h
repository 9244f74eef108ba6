// GPL-2.0-or-later. Compiled maps as files on disk, and names for files that are something else.
#pragma once

#include "common/files/files.h"
#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/bspfile/bsp_validate.h"
#include "q3map2/bspfile/bspfile_cubes.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspfile_hdr.h"
#include "q3map2/bspfile/bspfile_ibsp.h"
#include "q3map2/bspfile/bspx_lumps.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// How many bytes KindOfFile looks at.
inline constexpr std::size_t kKindBytes = 4096;

/// What KindOfFile returns for files that may be map sources.
inline constexpr std::string_view kKindEmpty = "empty", kKindText = "text",
                                  kKindMapSource = "a map source: compile it with -bsp";

/// What a file is by its first bytes: "a map of Quake II (IBSP 38)", "a zip archive", "text". Empty: IBSP 46 or 47, or
/// unknown.
std::string KindOfFile(std::span<const std::byte> begin);

/// What a map source of another game family is: "a map source of Doom 3 (Version 2)". Empty: none of these.
std::string KindOfSource(std::string_view text);

/// Parses and validates a whole file in memory, of the format that its first bytes name. `name` is for messages.
/// Errors: Error, one line, for anything that a later stage could trip over; recoverable oddities are warnings.
Bsp ReadBsp(std::span<const std::byte> file, std::string_view name, const BspFormat &format, Log &log);
/// The same from any source. Each byte is read once, into the records.
Bsp ReadBspFrom(const ByteSource &file, std::string_view name, const BspFormat &format, Log &log);
/// ReadBsp from disk, without the file image in memory.
Bsp ReadBspFile(const std::filesystem::path &path, const BspFormat &format, Log &log);
/// The exact bytes of the file. The same Bsp always gives the same bytes. Errors: 2^31 bytes or
/// more, a bad BSPX lump, a lump name that is too long, an unknown format.
std::vector<std::byte> WriteBsp(const Bsp &bsp, const BspFormat &format);
/// Writes the bytes of WriteBsp without a second copy in memory. Replaces the file by a complete one or leaves the old
/// one unchanged. Prints path and size.
void WriteBspFile(const std::filesystem::path &path, const Bsp &bsp, const BspFormat &format, Log &log);
/// The same as a file of a set, which the caller commits. Returns its bytes.
std::uint64_t AddBspFile(const std::filesystem::path &path, const Bsp &bsp, const BspFormat &format, FileSet &written,
                         Log &log);

} // namespace q3
