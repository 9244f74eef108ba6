// GPL-2.0-or-later. Causes of the error of baked bounced light; a check of the reference's direct light.
#pragma once

#include "tools/measure/bounce_error/bounce_errors.h"

#include <string>

namespace q3::bounce {

/// Inputs of the measurements below. Keeps references.
struct CauseInputs {
    const SurfaceInputs &in;
    const SurfaceLight &surfaces; ///< of the bake without bounces
    const PathTracer &tracer;
    const DirectLights &lights;
    const Receivers &receivers;
    const BakedLuxels &direct; ///< of the same
};

/// Light of one bounce at a receiver, each step one approximation nearer to the bake. Byte scale, not clamped.
struct BounceSteps {
    Vec3f atTexels; ///< emission: baked direct light of the luxel that a ray hits, times the reflectance at the hit
    Vec3f coarse;   ///< the same with the reflectance at the luxel's center, image averaged to 16 x 16 texels
    Vec3f window;   ///< mean of `coarse` over the window of 5 x 5 luxels, if it is complete
    bool complete = false; ///< whether all luxels of the window are mapped, visible and face about the same way
};
/// For each luxel of the receivers, by `rays` rays.
std::vector<BounceSteps> StepsOfFirstBounce(const CauseInputs &inputs, int rays);

/// Text with the share of each step in the squared error of one bounce. light: of the receivers' luxels, by one bounce.
std::string CausesText(const CauseInputs &inputs, std::span<const ComparedLight> light, int rays);

/// Text on the surroundings of a luxel: whether a solid is within a quarter unit; the shares of its rays that hit a
/// surface, and one that reflects, within 2 and 16 units.
std::string SurroundingsText(const CauseInputs &inputs, const LuxelReceiver &luxel);

/// Text with the difference between the reference's direct light and baked direct light of luxels: evaluated at the
/// luxels' positions, at the points of the surface beneath them, and there by sampled lights.
std::string DirectCheckText(const CauseInputs &inputs);

} // namespace q3::bounce
