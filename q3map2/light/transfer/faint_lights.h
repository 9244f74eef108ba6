// GPL-2.0-or-later. Many faint lights represented by a few of them.
#pragma once

#include "libs/math/bounds.h"
#include "q3map2/light/sources/light_sources.h"

namespace q3 {

/// Whether a light that gives at most `strongest` times `weight` is taken. Lights of at least `faint` are (byte scale;
/// 0 takes every light). Of the fainter ones, gone through in order, their light adds up in `residual`; each time the
/// sum reaches `faint` that light is taken for all of them, and its weight raised so that it gives `faint`.
bool SelectFaintLight(float faint, float strongest, float &residual, float &weight);

/// Upper bound of what the light can give to any point of the box, byte scale times its colour's largest component:
///
///     sun:         photons
///     point, spot: falloff at the distance of the box
///     area:        add min(1, A cos / (pi d^2)), A its area, d the least distance of the box from it, cos the greatest
///                  height of the box over its plane divided by d, at most 1
float LightBound(const Light &light, const Boundsf &box);

} // namespace q3
