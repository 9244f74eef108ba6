// GPL-2.0-or-later. Bot navigation files (.aas) beside a map, and the checksum by which they know it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// MD4 digest (RFC 1320) as four words; their bytes in little-endian order are the digest as it is printed.
std::array<std::uint32_t, 4> Md4(std::span<const std::byte> data);

/// The four words of the MD4 digest, xored: what Quake III engines call a block checksum.
std::uint32_t BlockChecksum(std::span<const std::byte> data);

/// A navigation file names the map that it was made for by the checksum of the whole .bsp. An engine that finds another
/// one refuses the file, and bots stand still.
struct BotFile {
    std::filesystem::path path;
    std::uint32_t checksum = 0; ///< of the .bsp that it was made for
};

/// What follows the name of the map in the names of its bot files.
inline constexpr std::string_view kBotFileEnds[] = {".aas", "_b0.aas", "_b1.aas"};

/// The map checksum stored in the bytes of a bot file. Errors: Error if they are not a bot file; `path` is for the
/// message.
std::uint32_t ChecksumIn(std::span<const std::byte> file, const std::filesystem::path &path);
/// The paths of x.aas, x_b0.aas and x_b1.aas, whether they exist or not.
std::vector<std::filesystem::path> BotFilesBeside(const std::filesystem::path &bspPath);
/// x.aas, x_b0.aas and x_b1.aas, as far as they are there. Errors: Error, for files that cannot be read or are none.
std::vector<BotFile> FindBotFiles(const std::filesystem::path &bspPath);
/// BlockChecksum of the file. Errors: it cannot be read.
std::uint32_t MapChecksum(const std::filesystem::path &bspPath);
/// Writes another checksum into the file. Errors: it cannot be written.
void SetChecksum(const BotFile &file, std::uint32_t checksum);

} // namespace q3
