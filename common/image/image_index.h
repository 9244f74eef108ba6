// GPL-2.0-or-later. Palette images, whose texels are indices of palette entries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Row 0 on top, one byte a texel. The palette itself is not kept.
struct IndexImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> indexes;
};

/// Decoders; `name`, errors and limits as in image.h. 8 bits a texel, one plane.
IndexImage DecodePcx(std::span<const std::byte> file, std::string_view name);
/// std::nullopt if the PNG is valid but has no palette.
std::optional<IndexImage> DecodePngIndexes(std::span<const std::byte> file, std::string_view name);

} // namespace q3
