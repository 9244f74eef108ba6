// GPL-2.0-or-later. Color spaces.
#pragma once

#include "libs/math/vec.h"

namespace q3 {

/// Decodes an sRGB channel value in 0..1 to linear.
float LinearFromSrgb(float c);
float SrgbFromLinear(float c);
/// c divided by its largest component; zero gives 1 1 1.
Vec3f NormalizeColor(const Vec3f &c);

} // namespace q3
