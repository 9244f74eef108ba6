// GPL-2.0-or-later. Many faint lights represented by a few of them.
#pragma once

#include "libs/math/bounds.h"
#include "q3map2/light/sources/light_sources.h"

namespace q3 {

/// Whether a light that gives at most `bound` times `weight` (byte scale) is used. One of at least `faint` always is;
/// with `faint` 0 all are. Called for the lights in order: the light of the fainter ones adds up in `residual`. When
/// the sum reaches `faint`, the light at hand is used in place of all of them: its weight becomes faint / bound, and
/// `faint` is subtracted from `residual`.
bool SelectFaintLight(float faint, float bound, float &residual, float &weight);

/// Upper bound of what the light can give to any point of the box, byte scale: the largest component of its color times
///
///     sun:         photons
///     point, spot: falloff at the distance of the box
///     area:        add min(1, A cos / (pi d^2)), A its area, d the least distance of the box from it, cos the greatest
///                  height of the box over its plane divided by d, at most 1
float LightBound(const Light &light, const Boundsf &box);

} // namespace q3
