// GPL-2.0-or-later. The page that shows a map, the map in it, and the options of -shreport.
#pragma once

#include "common/arguments.h"
#include "common/log.h"
#include "common/settings.h"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

// ---- Options of the stage -shreport ----

struct SHReportOptions {
    std::string output;    ///< path of the page; empty: x.html beside x.bsp
    int textureSize = 128; ///< most texels on the longer side of a texture; 0: no textures
};

/// The options of the stage, declared.
std::vector<SettingGroup<SHReportOptions>> SHReportSettings();
/// Takes them off `arguments`.
SHReportOptions ParseSHReportOptions(Arguments &arguments, Log &log);

/// The text of tools/viewer/viewer.html, embedded when the program was built.
std::string ViewerPage();

/// The page with `<!-- package -->` replaced by a script element that holds the archive in base64: its id is `package`,
/// its type `application/zip;base64`, and its attribute `data-map` is `map`, the name of the .bsp in the archive.
/// Errors: the comment is not in the page, or more than once.
std::string PageWithPackage(std::string_view page, std::string_view map, std::span<const std::byte> archive);

} // namespace q3
