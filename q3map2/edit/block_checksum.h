// GPL-2.0-or-later. The checksum by which a bot navigation file knows its map.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace q3 {

/// MD4 digest (RFC 1320) as four words; their bytes in little-endian order are the digest as it is printed.
std::array<std::uint32_t, 4> Md4(std::span<const std::byte> data);

/// The four words of the MD4 digest, xored: what Quake III engines call a block checksum.
std::uint32_t BlockChecksum(std::span<const std::byte> data);

} // namespace q3
