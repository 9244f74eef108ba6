// GPL-2.0-or-later. A map as a page: its package for the viewer, the page, and the options of -shreport.
#pragma once

#include "common/arguments.h"
#include "common/jobs.h"
#include "common/log.h"
#include "common/settings.h"
#include "q3map2/bspfile/bspfile.h"
#include "q3map2/pk3/map_needs.h"
#include "q3map2/shader/games.h"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// A map on disk, and the files of its game.
struct ReportedMap {
    std::filesystem::path path; ///< of the .bsp
    const Bsp &bsp;
    const Game &game;
    const PackageSource &source;
    const EngineScripts &scripts;
    std::string explanations{}; ///< text of maps/x.explain.json; empty: none
};

/// A pk3 with
/// - maps/x.bsp unchanged, and those of maps/x.lin, x.prt, x.sherror.json and x.unexplained.json that exist beside it,
/// - the explanations, if there are any,
/// - external lightmaps maps/x/lm_*,
/// - scripts/x.shader: the shaders of what is drawn, as StrippedText,
/// - their images and those of surfaces without a shader, unless `textureSize` is 0: at most that many texels on the
///   longer side, NAME.jpg or, if any texel is not opaque, NAME.png.
/// The bytes do not depend on the number of threads. Images that are missing or damaged are left out with a warning.
/// Errors: a file beside the map cannot be read.
std::vector<std::byte> MakeReportPackage(const ReportedMap &map, int textureSize, const JobPool &jobs, Log &log);

/// The same without the map and the files beside it.
std::vector<std::byte> MakeResourcePackage(const ReportedMap &map, int textureSize, const JobPool &jobs, Log &log);

// ---- Options of the stage -shreport ----

struct SHReportOptions {
    std::string output;    ///< path of the page; empty: x.html beside x.bsp
    int textureSize = 128; ///< most texels on the longer side of a texture; 0: no textures
    bool explain = false;  ///< places are explained; options of the light stage may follow
    int places = 2000;     ///< explained at most
};

/// The options of the stage, declared.
std::vector<SettingGroup<SHReportOptions>> SHReportSettings();
/// Takes them off `arguments`.
SHReportOptions ParseSHReportOptions(Arguments &arguments, Log &log);

// ---- The page that shows a map, and the map in it ----

/// The text of tools/viewer/viewer.html, embedded when the program was built.
std::string ViewerPage();

/// The page with `<!-- package -->` replaced by a script element that holds the archive in base64: its id is `package`,
/// its type `application/zip;base64`, and its attribute `data-map` is `map`, the name of the .bsp in the archive.
/// Errors: the comment is not in the page, or more than once.
std::string PageWithPackage(std::string_view page, std::string_view map, std::span<const std::byte> archive);

/// The page as the server of -watch sends it: `<!-- package -->` is replaced by an element with the id `watch` and the
/// attribute `data-map`, and the page may connect to `origins`, such as "http://127.0.0.1:8027 ws://127.0.0.1:8027".
/// Errors: what is replaced is not in the page, or more than once.
std::string PageForWatch(std::string_view page, std::string_view map, std::string_view origins);

} // namespace q3
