// GPL-2.0-or-later. Optional files beside a .bsp that the light stage reads.
#pragma once

#include "q3map2/light/light.h"

#include <filesystem>

namespace q3 {

/// The .map and the .srf beside the .bsp, if they exist. Errors: Error, for files that cannot be read or
/// parsed.
LightInputs ReadLightInputs(const std::filesystem::path &bspPath, Log &log);

} // namespace q3
