// GPL-2.0-or-later. Text output about the brushes of a map, and limits of engines.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/map.h"

#include <string>

namespace q3 {

/// -autocaulk: a line for each brush of the world, with its number and a letter a side.
std::string CaulkText(const MapEntity &world);
/// -fakemap: the world's brushes as map source.
std::string FakeMapText(const MapEntity &world, const PlaneTable &planes);
/// Warns of each count of the .bsp that engines cannot load.
void WarnOfLimits(const Bsp &bsp, Log &log);

} // namespace q3
