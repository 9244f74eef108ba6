// GPL-2.0-or-later. Pictures whose texels are numbers of palette entries.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// Row 0 on top, one byte a texel. The palette itself is of no interest here.
struct IndexImage {
    int width = 0, height = 0;
    std::vector<std::uint8_t> indexes;
};

/// Decoders; names, errors and limits as those of image.h. 8 bits a texel, one plane.
IndexImage DecodePcx(std::span<const std::byte> file, std::string_view name);
/// Nothing when the PNG is in order but has no palette.
std::optional<IndexImage> DecodePngIndexes(std::span<const std::byte> file, std::string_view name);

} // namespace q3
