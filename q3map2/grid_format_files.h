// GPL-2.0-or-later. Light grids in the formats of -gridformats: after a bake, and their files.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/gridformats/grid_formats.h"
#include "q3map2/light/options/light_options.h"

#include <filesystem>

namespace q3 {

/// The formats that the light stage stores: those of -gridformats, and the SH grid, uniform or sparse, if an option
/// that includes it is given. None without -gridformats. Turns the legacy grid of the bake off if one of them replaces
/// it, and the sparse one on if one of them is that. Errors: those of ParseGridFormats, -shpreview without an SH grid
/// in the file.
GridFormats TakeGridFormats(LightOptions &options);

/// After a bake: stores the formats and writes their files to `folder`, maps/x. Without formats, drops grids of earlier
/// runs from the map.
void StoreBakedGrids(const GridFormats &formats, const LightOptions &options, const std::filesystem::path &folder,
                     Bsp &bsp, const JobPool &jobs, Log &log);

/// Writes files of the formats to `folder`, maps/x. Warns of a raw file that is there from an earlier run, if engines
/// would take it for that of this map.
void WriteGridFiles(const std::filesystem::path &folder, const std::vector<GridFile> &files, Log &log);

} // namespace q3
