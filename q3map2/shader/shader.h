// GPL-2.0-or-later. Shaders. Includes what users of the folder need.
#pragma once

#include "q3map2/shader/shader_color.h"
#include "q3map2/shader/shader_info.h"
#include "q3map2/shader/shader_library.h"

namespace q3 {} // namespace q3
