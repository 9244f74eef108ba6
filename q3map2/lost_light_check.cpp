// GPL-2.0-or-later. Warns if lighting a map that lost its light entities made it darker.
#include "q3map2/lost_light_check.h"

namespace q3 {

namespace {

/// Of a point of the legacy grid, all channels together; byte scale.
double MeanLight(const Bsp &bsp) {
    std::uint64_t sum = 0;
    for (const bspGridPoint_t &point : bsp.gridPoints)
        for (std::size_t channel = 0; channel < 3; ++channel)
            sum += point.ambient[channel] + unsigned(point.directed[channel]);
    return bsp.gridPoints.empty() ? 0 : double(sum) / double(bsp.gridPoints.size());
}

} // namespace

LostLightCheck::LostLightCheck(const Bsp &bsp) : before_(MeanLight(bsp)) {}

void LostLightCheck::Report(const Bsp &bsp, Log &log) const {
    const double after = MeanLight(bsp);
    if (log.WarningCount("no light entities") == 0 || after * 3 >= before_ * 2)
        return;
    const std::string text = fmt::format(
        "the light grid has {:.0f} % of the light that it had: the map was lit by light entities, which its .bsp "
        "does not have; put its .map beside it, or keep the map as it was",
        after * 100 / before_);
    log.Warn("light entities lost", "{}", text);
    log.Repeat(text);
}

} // namespace q3
