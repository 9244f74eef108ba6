// GPL-2.0-or-later. The archive in a report: a map, and the files that the viewer needs to draw it.
#pragma once

#include "common/jobs.h"
#include "common/log.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/pk3/map_needs.h"
#include "q3map2/shader/games.h"

#include <cstddef>
#include <filesystem>
#include <vector>

namespace q3 {

/// A map on disk, and the files of its game.
struct ReportedMap {
    std::filesystem::path path; ///< of the .bsp
    const Bsp &bsp;
    const Game &game;
    const PackageSource &source;
    const EngineScripts &scripts;
};

/// A pk3 with
/// - maps/x.bsp unchanged, and those of maps/x.lin, x.prt and x.sherror.json that exist beside it,
/// - external lightmaps maps/x/lm_*,
/// - scripts/x.shader: the shaders of what is drawn, as StrippedText,
/// - their images and those of surfaces without a shader, unless `textureSize` is 0: at most that many texels on the
///   longer side, NAME.jpg or, if any texel is not opaque, NAME.png.
/// The bytes do not depend on the number of threads. Images that are missing or damaged are left out with a warning.
/// Errors: a file beside the map cannot be read.
std::vector<std::byte> MakeReportPackage(const ReportedMap &map, int textureSize, const JobPool &jobs, Log &log);

} // namespace q3
