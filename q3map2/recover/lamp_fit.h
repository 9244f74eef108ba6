// GPL-2.0-or-later. Lamps fitted to observed light: intensities by non-negative least squares, positions by
// Gauss-Newton.
#pragma once

#include "common/jobs.h"
#include "q3map2/recover/lamp_light.h"

#include <Eigen/SparseCore>

#include <span>
#include <vector>

namespace q3 {

/// Weighted least squares between observed light and that of lamps. With y the observed light less the known, g(j) the
/// column of lamp j and I(j) its intensity, the residual at a place is
///
///     r = y - sum over j of I(j) g(j)
///
/// and counts as 0 where the light is a bound and r < 0: stored light at its limit says only that there is at least so
/// much. The weight of a place is w = u / (1 + (s c)^2) with the relative noise s and the greatest light c around, u
/// falling with the residual (Huber), so that shadow edges, which this program does not place exactly where others do,
/// do not count much.
class LampFit {
  public:
    LampFit(const ObservedMap &map, const LampTracer &tracer, const JobPool &jobs);

    const std::vector<Lamp> &Lamps() const { return lamps_; }
    /// Sets s, and the weights by it.
    void SetRelativeNoise(float noise) {
        relativeNoise_ = noise;
        UpdateWeights();
    }
    /// Adds lamps and traces them.
    void Add(std::span<const Lamp> added);
    /// Intensities of all lamps by coordinate descent, then new weights.
    void SolveIntensities(int sweeps);
    /// One damped Gauss-Newton step of positions and strengths of all lamps together (Levenberg-Marquardt); each lamp
    /// stays where it is if its move would raise the error. Returns whether any moved.
    bool MoveLamps();
    /// Moves each lamp by `step` along an axis if the error falls. Returns how many moved. Unlike MoveLamps it does not
    /// need visibility to be constant.
    std::size_t Search(float step);
    /// Removes lamps whose own light lowers the error by at most `leastGain`.
    void Prune(double leastGain);
    /// Removes lamps whose absence raises the error by less than `leastGain` once the others have moved and changed
    /// in their place, by the linearized model. No two of them are within `apart` of each other, so that twins do not
    /// go together. Returns their number.
    std::size_t DropRedundant(double leastGain, float apart);
    /// Merges lamps nearer than `distance` into one at their mean.
    void Merge(float distance);

    /// Weighted squares of residuals.
    double Error() const;
    /// Root of the mean square of residuals, byte scale, of luxels.
    double RmsOfLuxels() const;
    float WeightOf(std::size_t place) const { return weights_[place]; }
    /// With the residuals r as they are: b = sum of w g r and a = sum of w g^2. A lamp of this column lowers the error
    /// most if its intensity changes by b / a, namely by b^2 / a.
    struct Slope {
        Vec3f b;
        float a = 0;
    };
    Slope SlopeOf(const LampColumn &column) const;
    /// The residual of a place, 0 where that of a bound is below 0. Byte scale.
    Vec3f EffectiveResidual(std::size_t place) const;

  private:
    using Term = Eigen::Triplet<float, int>;
    std::vector<Term> Derivatives() const;
    bool KeepIfBetterAt(std::size_t j, const Vec3f &origin, LampColumn column);
    bool KeepIfBetterForAll(std::size_t j, const Vec3f &origin, LampColumn column);
    bool KeepIfBetter(std::size_t j, const Lamp &oldLamp, LampColumn &oldColumn);
    LampColumn Traced(const Lamp &lamp) const;
    void TraceAll(std::span<const std::size_t> which);
    void FindContrast();
    void UpdateResiduals();
    void UpdateWeights();

    const ObservedMap &map_;
    const LampTracer &tracer_;
    const JobPool &jobs_;
    std::vector<Lamp> lamps_;
    std::vector<LampColumn> columns_; ///< by lamp
    std::vector<Vec3f> residuals_;    ///< by place
    std::vector<float> weights_;      ///< by place
    std::vector<float> contrast_;     ///< by place. Byte scale
    std::vector<float> damping_;      ///< by lamp: Marquardt's factor
    float relativeNoise_ = 0;
};

} // namespace q3
