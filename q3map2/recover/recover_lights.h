// GPL-2.0-or-later. The lamps of a lit map whose light entities are gone, from the light that it stores.
#pragma once

#include "common/log.h"
#include "q3map2/recover/lamp_fit.h"

#include <vector>

namespace q3 {

struct RecoveredLights {
    std::vector<Lamp> lamps;            ///< by falling strength
    double rmsBefore = 0, rmsAfter = 0; ///< of light on luxels that no source explains. Byte scale
};

/// Finds lamps by alternating descent: new ones where they lower the error most, then intensities and positions of all.
RecoveredLights RecoverLights(const ObservedMap &map, const LightSetup &setup, const JobPool &jobs, Log &log);

} // namespace q3
