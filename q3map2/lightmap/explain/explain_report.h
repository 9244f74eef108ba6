// GPL-2.0-or-later. Explanations as text for the log.
#pragma once

#include "q3map2/lightmap/explain/explanation.h"

#include <string>

namespace q3 {

/// How much of the lists is printed.
struct ReportLimits {
    std::size_t lights = 12;  ///< that reach the point or are in shadow
    std::size_t nothing = 12; ///< that give nothing
    std::size_t sources = 6;  ///< of a filled grid point
};

/// The report of -explain, lines of plain text.
std::string ReportOf(const Explanation &explanation, const ReportLimits &limits = {});

} // namespace q3
