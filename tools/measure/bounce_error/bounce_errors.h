// GPL-2.0-or-later. Error of baked bounced light against the reference.
#pragma once

#include "tools/measure/bounce_error/map_bakes.h"
#include "tools/measure/bounce_error/reference.h"

#include <span>

namespace q3::bounce {

/// Light at a receiver, byte scale.
struct ComparedLight {
    Vec3f direct, bounced;     ///< as baked
    Vec3f traced, tracedError; ///< bounced light of the reference and its standard error
};

/// Errors of displayed light: direct plus baked bounced light minus the same direct plus traced bounced light, both
/// clamped to 0..255, over receivers and channels. Bytes.
struct BounceErrors {
    std::size_t receivers = 0;
    double rmse = 0, percentile95 = 0, percentile99 = 0;
    double bias = 0;      ///< mean of baked - traced, displayed
    double noise = 0;     ///< RMS of the reference's standard error, 0 where its light is clamped
    double energy = 0;    ///< sum of baked / sum of traced bounced light, not clamped
    double meanLight = 0; ///< mean traced bounced light, not clamped
};
BounceErrors ErrorsOf(std::span<const ComparedLight> light);
/// Displayed error of a channel: baked - traced.
double ShownDifference(const ComparedLight &light, std::size_t channel);
/// Displayed squared error, summed over channels.
double SquaredError(const ComparedLight &light);

/// Baked and reference light of the receivers' luxels, for kBounceLimits[limit] bounces.
std::vector<ComparedLight> CompareLuxels(const Receivers &receivers, const Reference &reference, std::size_t limit,
                                         const BakedLuxels &direct, const BakedLuxels &baked);
/// The same for the SH grids at the receivers' positions, on each of bench::Normals().
std::vector<ComparedLight> ComparePositions(const Receivers &receivers, const Reference &reference, std::size_t limit,
                                            const Bsp &direct, const Bsp &baked);

} // namespace q3::bounce
