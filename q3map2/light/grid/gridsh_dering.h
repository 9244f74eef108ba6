// GPL-2.0-or-later. The SH grid without negative lobes.
#pragma once

#include "common/jobs.h"
#include "q3map2/bspfile/bspfile.h"

#include <cstdint>

namespace q3 {

/// radiance, below: the coefficients are not convolved with the cosine.
struct DeringStats {
    std::int64_t points = 0;  ///< changed
    double largestChange = 0; ///< of displayed light in 26 directions, 255ths
};

/// Changes each channel of the point by the least that leaves no direction below zero; see RemoveNegativeLobes.
/// Channels without such directions keep their bits. Returns the counts of this one point.
DeringStats DeringPoint(bspGridPointSH_t &point, bool radiance);

/// All points. Since games blend points with weights that are not negative, nothing between them is below zero either.
DeringStats DeringGridSH(LightGridSH &grid, bool radiance, const JobPool &jobs);

} // namespace q3
