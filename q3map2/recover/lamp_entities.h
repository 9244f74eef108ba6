// GPL-2.0-or-later. Lamps as light entities of a map source.
#pragma once

#include "q3map2/recover/lamp_light.h"

#include <span>
#include <string>

namespace q3 {

/// Text of a map source without brushes: worldspawn, and a light entity for each lamp.
std::string LampEntities(std::span<const Lamp> lamps);

} // namespace q3
