// GPL-2.0-or-later. Errors of both grids of a map by position, as the file .sherror.json for the viewer.
#pragma once

#include "tools/measure/shbench/errors.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3::bench {

/// Displayed errors against the reference at the positions of Truth, in their order: RMS over normals and channels,
/// bytes.
struct ErrorList {
    std::string setting, options; ///< name and light options of the bake
    std::vector<double> sh;
    std::vector<double> legacy; ///< empty: not measured
};

/// PositionErrors::shown of all positions.
std::vector<double> ShownErrorsByPlace(const Truth &truth, const ShownLight &shown);

/// {"format": "q3map2-sh errors", "version": 1, "map": "maps/NAME.bsp", "unit": "displayed bytes", "setting": ...,
/// "options": ..., "positions": [[x, y, z, errorSH, errorLegacy], ...]}. Positions are rounded to 0.1 game units,
/// errors to 0.01 byte; errorLegacy is null if it was not measured.
std::string ErrorListJson(std::string_view map, const Truth &truth, const ErrorList &errors);

} // namespace q3::bench
