// GPL-2.0-or-later. Sizes of images from their headers.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>

namespace q3 {

/// Width and height from the header. nullopt: another format, damaged, or over 16384 texels a side.
std::optional<std::array<int, 2>> TgaSize(std::span<const std::byte> file);
std::optional<std::array<int, 2>> PngSize(std::span<const std::byte> file);
std::optional<std::array<int, 2>> JpegSize(std::span<const std::byte> file);

} // namespace q3
