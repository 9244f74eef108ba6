// GPL-2.0-or-later. The falloff that keys of a light entity ask for.
#pragma once

#include "common/log.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/light/sources/light_sources.h"

#include <optional>

namespace q3 {

/// How messages name a light: editors find it by its position.
std::string LightLabel(const Entity &entity);

/// The curve of _fifty_percent_distance: 1 / polynomial is 1/2 at `fifty`. The polynomial is a multiple of that through
/// (0, 1), (fifty, m), (zero, 256) with m = 2, or the next larger m, in steps of 5 % of the way to the straight line,
/// whose slope at distance 1 is not negative. `hard`: a fade to nothing at `zero`; else a curve with its vertex at a
/// distance over 0 stays as it is there from the vertex on, and fades to nothing at 10 times its distance. Empty if the
/// polynomial is not positive at all distances that count, or `fifty` is below 1. The distances differ. Game units.
std::optional<Attenuation> FiftyPercentCurve(double fifty, double zero, bool hard);

/// Sets curve and attenuation of a light by the keys of kFalloffKeys, if there are any, and multiplies its photons by
/// what makes its intensity light in byte values; `byQuad`: the intensity is that of a color and brightness. True if
/// the photons are for byte values, false if they are still to be multiplied by the scale of point lights or
/// spotlights. Errors: distances without a curve.
bool SetCurve(const Entity &entity, bool byQuad, Light &light, Log &log);

/// Whether the brightness of a light is in byte values, as in Source: its _light is a color and a brightness, or keys
/// for falloff make it so.
bool CountsInBytes(const Entity &entity);

} // namespace q3
