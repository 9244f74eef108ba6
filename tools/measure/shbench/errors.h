// GPL-2.0-or-later. How far shown light is from the reference.
#pragma once

#include "tools/measure/shbench/truth.h"

#include <functional>
#include <span>
#include <vector>

namespace q3::bench {

/// Displayed: shown and reference light are clamped to 0..1 first, as a screen does; differences are in bytes of 255.
/// Over all positions, normals and channels.
struct ShownErrors {
    double rmse = 0, percentile95 = 0, percentile99 = 0; ///< displayed, against the reference
    double grid = 0;     ///< displayed RMS difference to the exact L2 projection at the place itself
    double leak = 0;     ///< share of positions, see IsLeak
    double relative = 0; ///< RMSE over RMS of the reference, nothing cut
};

/// Light that is shown at a position on each of Normals().
using ShownLight = std::function<NormalLight(const Vec3f &)>;

/// All zero without positions.
ShownErrors MeasureErrors(const Truth &truth, const ShownLight &shown);

/// What the exact L2 projection at the position shows: the best that nine coefficients can.
NormalLight ProjectedLight(const TruthPoint &point);
/// Displayed RMSE of it: the floor.
double FloorError(const Truth &truth);

/// Displayed light, mean over normals and channels.
double MeanDisplayed(const NormalLight &light);
/// A place that is dark, under 1 % of the map's mean, and shown with over 5 % of it.
inline bool IsLeak(double truth, double shown, double mapMean) {
    return truth < 0.01 * mapMean && shown > 0.05 * mapMean;
}

/// Displayed errors of one position: RMS over normals and channels, bytes.
struct PositionErrors {
    double shown = 0; ///< of what is shown
    double floor = 0; ///< of the exact L2 projection
    double grid = 0;  ///< difference of these two
};
/// shown, projected: light on each of Normals().
PositionErrors ErrorsAt(const TruthPoint &point, const NormalLight &shown, const NormalLight &projected);
/// One for each position.
std::vector<PositionErrors> ErrorsByPlace(const Truth &truth, const ShownLight &shown);

/// The error by which positions are ranked.
enum class WorstBy {
    Reference, ///< PositionErrors::shown
    Projection ///< PositionErrors::grid
};
double ErrorOf(const PositionErrors &errors, WorstBy by);

/// A position and the normal that errs most there.
struct WorstPosition {
    std::size_t point = 0, normal = 0; ///< indexes of Truth::points and Normals()
    double error = 0;                  ///< displayed, the largest of the normals and channels; bytes
    Vec3f shown;                       ///< light on that normal, 1.0 = byte 255
};
/// The `count` positions with the largest ErrorOf(errors, by), which is an RMS, the worst first.
std::vector<WorstPosition> WorstPositions(const Truth &truth, const ShownLight &shown, std::size_t count,
                                          WorstBy by = WorstBy::Reference);

} // namespace q3::bench
