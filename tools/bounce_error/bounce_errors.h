// GPL-2.0-or-later. How far baked bounced light is from the reference.
#pragma once

#include "tools/bounce_error/map_bakes.h"
#include "tools/bounce_error/reference.h"

#include <optional>
#include <span>

namespace q3::bounce {

/// Light at a receiver, byte scale.
struct ComparedLight {
    Vec3f direct, bounced;     ///< as baked
    Vec3f traced, tracedError; ///< reference of `bounced` and its standard error
};

/// Displayed: direct light with baked bounces against the same direct light with traced ones, both cut to 0..255, over
/// receivers and channels. Bytes.
struct BounceErrors {
    std::size_t receivers = 0;
    double rmse = 0, percentile95 = 0, percentile99 = 0;
    double bias = 0;      ///< mean of baked - traced, displayed
    double noise = 0;     ///< RMS of the reference's standard error, as far as it is displayed
    double energy = 0;    ///< sum of baked over sum of traced bounces, nothing cut
    double meanLight = 0; ///< mean traced bounce, nothing cut
};
BounceErrors ErrorsOf(std::span<const ComparedLight> light);
/// Displayed squared error, summed over channels.
double SquaredError(const ComparedLight &light);

/// Baked light at the luxels of the receivers against entry `limit` of the reference.
std::vector<ComparedLight> CompareLuxels(const Receivers &receivers, const Reference &reference, std::size_t limit,
                                         const BakedLuxels &direct, const BakedLuxels &baked);
/// The grids' light at the positions on each of bench::Normals().
std::vector<ComparedLight> ComparePositions(const Receivers &receivers, const Reference &reference, std::size_t limit,
                                            const Bsp &direct, const Bsp &baked);

} // namespace q3::bounce
