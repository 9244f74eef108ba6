// GPL-2.0-or-later. A small original arena that shows what the light grids do.
#pragma once

#include "q3map2/bspfile/bspfile.h"

#include <string>

namespace q3 {

/// A compiled, unlit map and the other inputs of the light stage.
struct DemoMap {
    Bsp bsp;                ///< entities without lights, as after the bsp stage
    std::string mapText;    ///< all entities, lights too; no brushes
    std::string shaderText; ///< script with the surface light, the sky with its sun, and the walls
};

/// Two rooms of 1024 x 768 x 320 in all: in the west a red lamp faces a blue one between four pillars and a round bay;
/// in the east the sun falls through an opening, with a warm ceiling lamp behind a wall of 4 units.
DemoMap DemoScene();

} // namespace q3
