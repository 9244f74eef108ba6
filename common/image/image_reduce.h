// GPL-2.0-or-later. Images of fewer texels.
#pragma once

#include "common/image/image.h"

namespace q3 {

/// The image with its longer side at most `longestSide` texels (over 0), the other in proportion; the same image if it
/// fits already. Each texel is the mean of the area that it covers, of stored values, as engines make mipmaps.
Image Reduced(const Image &image, int longestSide);

} // namespace q3
