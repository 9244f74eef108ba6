// GPL-2.0-or-later. Lamps fitted to observed light: intensities by non-negative least squares, positions by
// Gauss-Newton, cones by search.
#pragma once

#include "common/jobs.h"
#include "q3map2/recover/lamp_light.h"

#include <Eigen/SparseCore>

#include <array>
#include <limits>
#include <span>
#include <vector>

namespace q3 {

/// Weighted least squares between observed light and that of lamps. With y the observed light less the known, g(j) the
/// column of lamp j and I(j) its intensity, the residual at a place is
///
///     r = y - sum over j of I(j) g(j)
///
/// and counts as 0 where stored light is a bound that it does not contradict. The weight of a place is w = u / (1 + (s
/// c)^2) with the relative noise s and the greatest light c around, u falling with the residual (Huber), so that shadow
/// edges, which this program does not place exactly where others do, do not count much.
class LampFit {
  public:
    LampFit(const ObservedMap &map, const LampTracer &tracer, const JobPool &jobs);

    const std::vector<Lamp> &Lamps() const { return lamps_; }
    /// Sets s, and the weights by it.
    void SetRelativeNoise(float noise) {
        relativeNoise_ = noise;
        UpdateWeights();
    }

    // ---- Intensities: lamp_fit.cpp ----

    /// Adds lamps and traces them.
    void Add(std::span<const Lamp> added);
    /// Intensities of all lamps by coordinate descent, then new weights.
    void SolveIntensities(int sweeps);
    /// Removes lamps whose own light lowers the error by at most `leastGain` times the noise there.
    void Prune(double leastGain);
    /// Merges lamps nearer than `distance` into one at their mean. Cones stay apart.
    void Merge(float distance);

    /// Weighted squares of residuals.
    double Error() const;
    /// Root of the mean square of residuals, byte scale, of luxels and vertices.
    double RmsOfSurfaces() const;
    float WeightOf(std::size_t place) const { return weights_[place]; }
    /// With the residuals r as they are: b = sum of w g r and a = sum of w g^2. A lamp of this column lowers the error
    /// most if its intensity changes by b / a, namely by b^2 / a.
    struct Slope {
        Vec3f b;
        float a = 0;
        float noise = 1; ///< mean of w r^2 over the places and channels, at least 1
    };
    Slope SlopeOf(const LampColumn &column) const;
    /// The residual of a place, 0 where it does not contradict a bound. Byte scale.
    Vec3f EffectiveResidual(std::size_t place) const;
    /// The same without the lamp of number j, if the place has its light `g` for intensity 1.
    Vec3f ResidualWithout(std::size_t j, const LampEntry &g) const;
    const LampColumn &ColumnOf(std::size_t j) const { return columns_[j]; }

    // ---- Positions and cones: lamp_moves.cpp ----

    /// One damped Gauss-Newton step of positions and strengths of all lamps together (Levenberg-Marquardt); each lamp
    /// stays where it is if its move would raise the error.
    void MoveLamps();
    /// Moves each lamp by `step` along an axis if the error falls, or tilts, widens or narrows its cone.
    /// Unlike MoveLamps it does not need visibility to be constant.
    void Search(float step);
    /// Puts a lamp in the place of number j, unless the error would fall by less than `leastGain` times the noise
    /// there; a negative gain allows that it rises. Returns whether it did.
    bool Replace(std::size_t j, const Lamp &lamp, double leastGain);
    /// Removes lamps whose absence raises the error by less than `leastGain` times the noise there once the others have
    /// moved and changed in their place, by the linearized model. No two of them are within `apart` of each other, so
    /// that twins do not go together. Returns their number.
    std::size_t DropRedundant(double leastGain, float apart);
    /// Standard errors of a lamp, by the same model.
    struct Spread {
        float position = 0;  ///< game units
        float intensity = 0; ///< relative
    };
    /// By lamp.
    std::vector<Spread> Spreads() const;

  private:
    LampColumn Traced(const Lamp &lamp) const;
    void TraceAll(std::span<const std::size_t> which);
    void FindContrast();
    void UpdateResiduals();
    void UpdateWeights();
    double ErrorAt(const LampColumn &column) const;
    void AddToResiduals(const LampColumn &column, const Vec3f &intensity);

    Eigen::SparseMatrix<float> Jacobian() const;
    std::vector<float> BestStep() const;
    std::vector<std::size_t> Step(const std::vector<float> &step);
    /// For noise 1, with all other lamps free to move and change.
    struct Variance {
        static constexpr double kUnknown = std::numeric_limits<double>::infinity();
        double position = kUnknown; ///< sum over the axes, in units of the step
        double strength = kUnknown; ///< of the logarithm
        double strengthAtRest = 0;  ///< the same if the lamp itself stays in place
    };
    std::vector<Variance> Variances() const;
    std::vector<Lamp> TrialsOf(std::size_t j, float step) const;
    void TryAround(std::size_t j, float step);
    static Lamp Changed(const Lamp &lamp, const std::array<float, 6> &by);
    bool MoveCone(std::size_t j);
    bool KeepIfBetter(std::size_t j, const Lamp &oldLamp, LampColumn &oldColumn, double leastGain);
    bool KeepIfBetterForAll(std::size_t j, const Lamp &lamp, LampColumn column);

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
