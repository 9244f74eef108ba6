// GPL-2.0-or-later. Errors of both grids of a map by position, as a file that viewers read.
#pragma once

#include "tools/shbench/errors.h"

#include <string>
#include <string_view>
#include <vector>

namespace q3::bench {

/// Displayed errors against the reference, by position: RMS over normals and channels, bytes.
struct ErrorList {
    std::string setting, options; ///< name and light options of the bake
    std::vector<double> sh;
    std::vector<double> legacy; ///< empty: not measured
};

/// PositionErrors::shown of all positions.
std::vector<double> ShownErrorsByPlace(const Truth &truth, const ShownLight &shown);

/// {"format": "q3map2-sh errors", "version": 1, "map": "maps/NAME.bsp", "unit": "displayed bytes", "setting": ...,
/// "options": ..., "positions": [[x, y, z, errorSh, errorLegacy], ...]}. Positions in tenths of a game unit, errors in
/// hundredths of a byte; errorLegacy is null if it was not measured.
std::string ErrorListJson(std::string_view map, const Truth &truth, const ErrorList &errors);

} // namespace q3::bench
