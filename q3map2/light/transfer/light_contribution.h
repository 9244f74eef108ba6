// GPL-2.0-or-later. Light of one source at points of the light grids.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/light/batch/receivers.h"
#include "q3map2/light/scene/light_scene.h"
#include "q3map2/light/sources/light_sources.h"
#include "q3map2/light/transfer/light_kernel.h"

#include <algorithm>
#include <span>

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
///     area:        radiosity min(1, A cos / (pi d^2)), A its area, d the least distance of the box from it, cos the
///                  greatest height of the box over its plane divided by d, at most 1
float LightBound(const Light &light, const Boundsf &box);

/// The part of each light that a grid pass traces. Weak and strong part add up to the light; see FractionOfPart.
enum class LightPart {
    Whole,
    Strong, ///< no rays are cast to lights without a strong part
    Weak    ///< for receivers that may be far apart: that their visibility differs is no cause for further rays
};

/// Fraction of a part in a light that gives a receiver `light` without shadows. That of the weak part is 1 up to half
/// of weakBelow, 0 from weakBelow on, linear between. light, weakBelow: byte scale.
inline float FractionOfPart(LightPart part, float light, float weakBelow) {
    const float slope = 2 - 2 * light / weakBelow, weak = slope > 0 ? std::min(slope, 1.0f) : 0;
    return part == LightPart::Whole ? 1 : part == LightPart::Weak ? weak : 1 - weak;
}

/// Settings of a grid pass, the same for all lights and receivers.
struct LightSettings {
    LightPass pass = LightPass::LegacyGrid;
    bool sunOnly = false;    ///< -sunonly: other lights than suns give nothing
    bool pointAreas = false; ///< -faster: area lights of the legacy grid by distance alone
    bool radiance = false;   ///< GridSH: plain projection, not convolved with the cosine
    bool shadows = true;     ///< false: no rays are cast, everything that faces the receiver arrives
    float samples = 1;       ///< factor of the number of rays to partly hidden area lights
    SkipOptions skip;
    /// Area lights that give a batch less may be represented by others, see SelectFaintLight. Byte scale.
    float faint = 0;
    LightPart part = LightPart::Whole; ///< others: GridSH only
    float weakBelow = 0;               ///< see FractionOfPart. Byte scale
};

/// Sets incident[i] to the light of `light`, times `weight`, at batches[i]: falloff, cones, form factors, sides,
/// visibility by PVS and by ray. Where nothing arrives, no receiver is live.
///
/// LegacyGrid follows NetRadiant's q3map2: one ray toward the light's center, form factor toward it. GridSH is
/// exact: an area light's projection in closed form, its visibility by sampling where it is partly hidden; far area
/// lights are approximated with an error under 1/256 of a byte, and the faintest judged by one ray. With skip.coarse,
/// if a few receivers of a batch agree on the visibility of a dim light, the rest use it too. Safe from several
/// threads.
void LightContributionToPoint(const Light &light, float weight, const LightSettings &settings, const LightScene &scene,
                              std::span<ReceiverBatch> batches, std::span<ProbeIncidentLight> incident,
                              ContributionCounts &counts);

} // namespace q3
