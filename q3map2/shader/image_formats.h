// GPL-2.0-or-later. The formats of the game's images, and their sizes from their headers.
#pragma once

#include "common/image/image.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>

namespace q3 {

/// A format of the images that shaders name; the extension in the script does not matter.
struct ImageFormat {
    std::string_view extension; ///< with its dot
    Image (*decode)(std::span<const std::byte> file, std::string_view name);
    /// Width and height from the header. nullopt: another format, damaged, or over 16384 texels a side.
    std::optional<std::array<int, 2>> (*size)(std::span<const std::byte> file);
};

/// All formats, in the order in which files are looked for: the first that exists is used.
std::span<const ImageFormat> ImageFormats();

} // namespace q3
