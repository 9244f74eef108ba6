// GPL-2.0-or-later. Brushes of a map as text (.caulk, fakemap), and limits of engines.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/map/map.h"

#include <string>

namespace q3 {

/// -autocaulk: a line for each brush of the world, with its number and a letter per side.
std::string CaulkText(const MapEntity &world);
/// -fakemap: the world's brushes as map source.
std::string FakeMapText(const MapEntity &world, const PlaneTable &planes);
/// Warns of each number of records that exceeds what engines can load.
void WarnOfLimits(const Bsp &bsp, Log &log);

} // namespace q3
