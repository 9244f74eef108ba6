// GPL-2.0-or-later. The lamps of a lit map whose light entities are gone, from the light that it stores.
#pragma once

#include "q3map2/recover/known_sources.h"
#include "q3map2/recover/lamp_fit.h"
#include "q3map2/recover/relit_map.h"

#include <vector>

namespace q3 {

struct RecoveredLights {
    std::vector<Lamp> lamps;              ///< by falling strength
    std::vector<LampFit::Spread> spreads; ///< by lamp
    double rmsBefore = 0, rmsAfter = 0;   ///< of light on luxels and vertices that no source explains. Byte scale
    TexLights sources;                    ///< those of the inputs, with the factors of light that shaders emit
    ObservedMap map;
    RelitDifference difference; ///< of the map lit again with the lamps
};

/// Finds how strong surfaces and skies were that emit light (FitKnownSources), and then lamps by alternating descent:
/// new ones where they lower the error most, then intensities and positions of all. With bounces (-bounce) they are
/// found roughly at first, the map is lit with them, and they are found once more from what their bounced light leaves.
/// At last the map is lit again, for the difference. Errors: as LightWorld.
RecoveredLights RecoverLights(const RecoverInputs &in);

} // namespace q3
