// GPL-2.0-or-later. DDS images.
#pragma once

#include "common/image/image.h"

namespace q3 {

/// The largest mipmap, of a cube its first side: DXT1, DXT3, DXT5, and uncompressed with any masks. As the decoders of
/// image.h.
Image DecodeDds(std::span<const std::byte> file, std::string_view name);

} // namespace q3
