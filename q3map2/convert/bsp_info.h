// GPL-2.0-or-later. Counts and sizes of a .bsp file, and what may be in one of an unknown game.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// An entry of the directory that follows ident and version.
struct FoundLump {
    std::int32_t offset = 0, length = 0;
};

/// Entries up to where the first lump begins or to one that does not lie in the file, 100 at most. `lumpSwap`: length
/// first. `name` is for messages. Error: the file is too short for a directory.
std::vector<FoundLump> FindLumps(std::span<const std::byte> file, bool lumpSwap, std::string_view name);
/// What lumps of these bytes may be: by their text, else all kinds of record whose size divides the length.
std::vector<std::string> GuessLump(std::span<const std::byte> lump);
/// Prints ident, version, and each lump with its first bytes and what it may be.
void PrintAnalysis(std::span<const std::byte> file, bool lumpSwap, std::string_view name, Log &log);

/// Prints counts and bytes of every lump, as -info does. `fileBytes` is the size on disk.
void PrintBspInfo(const std::filesystem::path &path, const Bsp &bsp, std::uintmax_t fileBytes, Log &log);

} // namespace q3
