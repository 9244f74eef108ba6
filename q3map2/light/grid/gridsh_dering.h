// GPL-2.0-or-later. The SH grid without negative lobes.
#pragma once

#include "common/jobs.h"
#include "q3map2/bspfile/bspfile.h"

#include <cstdint>

namespace q3 {

/// Result of deringing.
struct DeringStats {
    std::int64_t points = 0;  ///< number of points changed
    double largestChange = 0; ///< of displayed light in 26 directions, in 255ths
};

/// Makes the smallest change to each channel that leaves no direction below zero; see RemoveNegativeLobes. Channels
/// without negative directions keep their bits. radiance: coefficients are not convolved with the cosine.
DeringStats DeringPoint(bspGridPointSH_t &point, bool radiance);

/// DeringPoint for all points. Since games blend points with weights that are not negative, nothing between them is
/// below zero either.
DeringStats DeringGridSH(LightGridSH &grid, bool radiance, const JobPool &jobs);

} // namespace q3
