// GPL-2.0-or-later. DDS images.
#pragma once

#include "common/image/image.h"

namespace q3 {

/// Decodes the largest mipmap; of a cube map, that of its first face. DXT1, DXT3, DXT5, and uncompressed texels with
/// any masks. `name`, errors and limits as in image.h.
Image DecodeDds(std::span<const std::byte> file, std::string_view name);

} // namespace q3
