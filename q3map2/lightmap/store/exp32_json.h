// GPL-2.0-or-later. Lightmaps as JSON of ColorRGBExp32.
#pragma once

#include "common/image/float_image.h"

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// A JSON object with width, height and texels, each [r, g, b, exponent]; row 0 first. Precision: see EncodeRgbExp32.
std::vector<std::byte> EncodeExp32Json(const FloatImage &image);
/// Errors: Error for missing members, values out of range, and a list that is not width * height long.
FloatImage DecodeExp32Json(std::span<const std::byte> file, std::string_view name);

} // namespace q3
