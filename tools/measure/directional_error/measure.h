// GPL-2.0-or-later. Errors of encodings over normals.
#pragma once

#include "q3map2/light/light_setup.h"
#include "q3map2/lightmap/options/lightmap_options.h"

#include <string>
#include <vector>

namespace q3::directional {

/// Error of one encoding on a map.
struct EncodingError {
    std::string name;
    double bytes = 0;       ///< per luxel
    double rmse = 0;        ///< displayed, bytes of 255, over all luxels, normals and channels
    double atOwnNormal = 0; ///< the same for the luxel's own normal, against the flat float light
};

/// Cost of a bake with the channels that one encoding needs.
struct BakeTime {
    std::string name;
    double overFlat = 0; ///< CPU time divided by that of flat light
};

/// Results of one map.
struct MapErrors {
    std::size_t luxels = 0;
    /// Displayed RMSE of the stored flat light against traced light at the luxel's normal.
    double flatAgainstTraced = 0;
    std::vector<EncodingError> encodings;
    std::vector<BakeTime> times;
};

/// Compares the encodings with light traced by `rays` rays, at `luxels` luxels, for `normals` normals within 60 degrees
/// of each. Errors: as LightWorld.
MapErrors Measure(const LightSetup &setup, const LightmapOptions &options, std::size_t luxels, int normals, int rays,
                  const JobPool &jobs, Log &log);

} // namespace q3::directional
