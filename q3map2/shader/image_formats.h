// GPL-2.0-or-later. The formats of the game's images, their sizes from their headers, and color spaces.
#pragma once

#include "common/image/image.h"
#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A format of the images that shaders name; the extension in the script does not matter.
struct ImageFormat {
    std::string_view extension; ///< with its dot
    Image (*decode)(std::span<const std::byte> file, std::string_view name);
    /// Width and height from the header. nullopt: another format, damaged, or over 16384 texels a side.
    std::optional<std::array<int, 2>> (*size)(std::span<const std::byte> file);
};

std::span<const ImageFormat> ImageFormats();
/// By the extension of a file name, in any case; null: not an image.
const ImageFormat *FindImageFormat(std::string_view fileName);

/// Files that an image may be in, in the order in which they are looked for: the first that exists is used. `patterns`:
/// Game::imageFiles.
std::vector<std::string> ImageFileNames(std::string_view image, std::string_view patterns);

/// Decodes an sRGB channel value in 0..1 to linear.
float LinearFromSrgb(float c);
/// The inverse.
float SrgbFromLinear(float c);
/// c divided by its largest component; zero gives 1 1 1.
Vec3f NormalizeColor(const Vec3f &c);

} // namespace q3
