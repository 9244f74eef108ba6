// GPL-2.0-or-later. Lightmaps as JSON of ColorRGBExp32.
#pragma once

#include "common/image/float_image.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// An object of width, height and texels: [r, g, b, exponent] each, row 0 first. Precision: EncodeRgbExp32.
std::vector<std::byte> EncodeExp32Json(const FloatImage &image);
/// Errors: Error for other members' values, sizes as in image.h, and a list that is not width * height long.
FloatImage DecodeExp32Json(std::span<const std::byte> file, std::string_view name);

} // namespace q3
