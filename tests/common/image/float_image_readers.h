// GPL-2.0-or-later. Plain readers of float images, and a writer of uncompressed OpenEXR files.
#pragma once

#include "common/image/float_image.h"

#include <array>
#include <cstddef>
#include <string>
#include <vector>

namespace q3 {

/// Radiance with a header as EncodeHdr writes it: rows in runs by channel or, if narrow, flat.
FloatImage ReadHdrPlainly(const std::vector<std::byte> &file);
/// OpenEXR, scan lines, ZIP compression, channels B, G and R of 32-bit floats.
FloatImage ReadExrPlainly(const std::vector<std::byte> &file);

enum ExrType { ExrHalf = 1, ExrFloat = 2 };
struct ExrChannel {
    std::string name;
    ExrType type;
    int sampling;
};
/// A file of 2 x 2 texels.
struct ExrFile {
    std::vector<ExrChannel> channels; ///< ascending by name
    std::array<int, 2> windowMin{};
    int claimedSide = 2; ///< in the header
};
/// The sample of channel c at column x of row y is 2^(c - x - 2 y).
std::vector<std::byte> PlainExr(const ExrFile &file);

} // namespace q3
