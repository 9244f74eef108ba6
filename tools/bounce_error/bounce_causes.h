// GPL-2.0-or-later. Why baked bounced light errs, and how far the reference's direct light is from that of luxels.
#pragma once

#include "tools/bounce_error/bounce_errors.h"

#include <string>

namespace q3::bounce {

/// What causes are measured on.
struct CauseInputs {
    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    const PathTracer &tracer;
    const DirectLights &lights;
    const Receivers &receivers;
    const BakedLuxels &direct;
};

/// Light of one bounce at a receiver, computed in steps from the reference to a gather of texels. Undisplayed, bytes.
struct BounceSteps {
    Vec3f atTexels;  ///< emission is the baked direct light of the luxel that is hit times the reflectance at the hit
    Vec3f coarse;    ///< the same times the reflectance at the luxel's own texture coordinates, 16 x 16 texels
    Vec3f deviation; ///< standard deviation of `coarse` over single rays
    Vec3f window;    ///< mean of `coarse` over the 5 x 5 luxels around, if all of them are of the same plane
    bool complete = false; ///< they are
};
std::vector<BounceSteps> StepsOfFirstBounce(const CauseInputs &inputs, int rays);

/// Shares of the squared error of one bounce by step, as text. `light`: the luxels of one bounce.
std::string CausesText(const CauseInputs &inputs, std::span<const ComparedLight> light, int rays);

/// What is right around a luxel: whether solids are within a quarter unit, the share of its rays that end within 2 and
/// 16 units, and how many of these reflect.
std::string SurroundingsText(const CauseInputs &inputs, const LuxelReceiver &luxel);

/// Direct light of the reference against baked direct luxels, as text: at the luxels' own positions, at the hits of
/// rays toward them, and by sampled lights.
std::string DirectCheckText(const CauseInputs &inputs);

} // namespace q3::bounce
