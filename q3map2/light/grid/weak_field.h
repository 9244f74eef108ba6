// GPL-2.0-or-later. The weak part of the light at points of the SH grid: traced where it is not smooth, else
// interpolated; light between the points.
#pragma once

#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/probe_integrator.h"
#include "q3map2/light/scene/light_space.h"

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace q3 {

/// Sum of the weak parts of all lights (see LightPart), of bounced light and of floodlight at a point: SH coefficients
/// before ambient light, minimum light and grid scale are applied. 1 = byte 255.
using WeakLight = bspGridPointSH_t;

/// The largest absolute difference of displayed light that a difference of coefficients makes, over the three channels
/// and 26 normals: those towards the faces, edges and corners of a cube.
class DisplayedChange {
  public:
    /// radiance: the coefficients are not convolved with the cosine yet. scale: the display value of light 1.
    DisplayedChange(bool radiance, float scale);
    /// As if nothing were clamped at black or white. Unit: that of `scale`.
    float Of(const WeakLight &change) const;

  private:
    static constexpr std::size_t kAxes = 13;
    std::array<Lanes, 9> basis_; ///< by coefficient: its basis function at 13 of the normals; the others are opposite
};

/// Weak light at the points of a grid, in a hierarchy of six levels. The level of a point depends on its column (x, y);
/// of columns where both are multiples of four, layers of even z are of level 0 and those of odd z of level 1:
///
///     0/1  5   3   5  0/1
///      5   4   5   4   5
///      3   5   2   5   3
///      5   4   5   4   5
///     0/1  5   3   5  0/1
///
/// A point above level 0 is the midpoint of pairs of points of lower levels: of those above and below it on level 1,
/// else of two pairs in its layer, on the diagonals or on the axes. (A point of level 4 is between 0/1 and 2 on one
/// diagonal, and between 3 and 3 on the other.) A pair a, b predicts it by the cubic through a, b and the points c, d
/// three times as far out, (9 (a + b) - (c + d)) / 16, or by the mean of a and b where c and d are not seen; two pairs
/// by the mean of their predictions. Where a point was traced, the error of its prediction is known; errors of later
/// predictions nearby are expected to be as large, but smaller from level to level.
///
/// Levels are filled one after the other, the points of a level from any thread.
class WeakField {
  public:
    static constexpr int kLevels = 6;
    /// Level of the point with these grid coordinates.
    static int LevelOf(int x, int y, int z);

    /// states: of the points; those that are not Open predict nothing and are not predicted. change: on the byte scale.
    /// Keeps references.
    WeakField(const BspSpace &space, const GridLayout &layout, const std::vector<PointState> &states,
              const DisplayedChange &change, const JobPool &jobs);

    /// Light at a point, predicted from points of lower levels.
    struct Prediction {
        WeakLight light{};
        int pairs = 0;         ///< pairs with both ends in sight; 0: `light` is not set
        bool isTested = false; ///< errors of predictions nearby are known
        float error = 0;       ///< expected, if isTested. Byte scale
        /// Whether it is accurate enough to be used in place of the light.
        bool IsGood() const;
    };
    Prediction Predict(int x, int y, int z) const;
    /// Sets a point to its prediction.
    void Accept(std::uint32_t index, const Prediction &prediction);
    /// Sets a point that was traced. prediction: what Predict gave for it, whose error becomes known.
    void SetTraced(std::uint32_t index, const WeakLight &light, const Prediction &prediction);

    bool IsOpen(std::uint32_t index) const { return states_[index] == PointState::Open; }
    /// Weak light of a point; valid once its level is filled.
    const WeakLight &At(std::uint32_t index) const { return light_[index]; }

    /// Weak light interpolated between those corners of a position's cell that are in the open and in clear sight, plus
    /// `offset`; nothing without such corners, or where the error at one is large. After all levels.
    std::optional<WeakLight> Interpolate(const Vec3f &position, const WeakLight &offset) const;
    /// Weak light that was traced at a position minus that of Interpolate; nothing if there is none, or the difference
    /// is large.
    std::optional<WeakLight> OffsetAt(const Vec3f &position, const WeakLight &traced) const;

  private:
    /// The cell of a position: its lowest corner, and the position in it from 0 to 1 per axis.
    struct Place {
        Int3 low{};
        std::array<float, 3> part{};
    };
    WeakLight FarPairDifference(const Int3 &at, const Int3 &step, const WeakLight &mean) const;
    bool FindPlace(const Vec3f &position, Place &place) const;
    float ErrorNear(int x, int y, int z) const;
    /// Index of a point in the open; -1: it is not in the open, or outside the grid.
    std::int64_t OpenPoint(int x, int y, int z) const;
    /// Whether the box with these opposite corners touches no solid.
    bool IsClear(const Vec3f &a, const Vec3f &b) const;

    const BspSpace &space_;
    const GridLayout &layout_;
    const std::vector<PointState> &states_;
    DisplayedChange change_;
    std::vector<WeakLight> light_; ///< by point
    std::vector<float> error_;     ///< by point: of its prediction, byte scale, or kUntested
};

/// Fills a WeakField level by level: points that lower levels do not predict well are traced. Keeps references.
class WeakFieldTracer {
  public:
    /// isWanted: whether the light at grid coordinates is needed; only other parts of a bake need the rest.
    WeakFieldTracer(const GridInputs &in, const GridLayout &layout, const LitGridPoints &points,
                    const ProbeIntegrator &integrator, std::function<bool(const Int3 &)> isWanted)
        : in_(in), layout_(layout), points_(points), integrator_(integrator), isWanted_(std::move(isWanted)) {}

    /// Sets `weak` at all lit points. The result does not depend on the number of threads. False: the first levels
    /// predict too few points, so that tracing all light at once is faster; `weak` is not complete.
    bool Fill(WeakField &weak, GridStats &stats) const;

  private:
    bool IsSmooth(const WeakField &weak) const;
    void TraceBrick(int level, std::int64_t brick, const std::vector<BrickPoint> &points, WeakField &weak,
                    GridStats &work) const;

    const GridInputs &in_;
    const GridLayout &layout_;
    const LitGridPoints &points_;
    const ProbeIntegrator &integrator_;
    const std::function<bool(const Int3 &)> isWanted_;
};

/// A position in the open whose light is wanted.
struct ProbeReceiver {
    Vec3f position;
    int cluster = 0;
    std::uint32_t seed = 0; ///< of its sample patterns
};

/// Computes light at positions: strong light is traced, weak light interpolated in a WeakField, or traced where that
/// has none. Const after construction; safe from several threads. Keeps references.
class LightAtPositions {
  public:
    /// weak: of a grid around the positions, complete; null: all light is traced.
    LightAtPositions(const ProbeIntegrator &integrator, const WeakField *weak) : integrator_(integrator), weak_(weak) {}

    /// Light at receivers that are near to each other, as in a brick. seed: see ProbeIntegrator::Trace.
    /// observer: sees strong lights as they arrive, or all if there is no weak light; or null.
    std::vector<bspGridPointSH_t> At(std::span<const ProbeReceiver> receivers, std::uint64_t seed, GridStats &work,
                                     LightObserver *observer = nullptr) const;
    /// The two steps of At, for callers that know some of the weak light. The first traces the weak light of receivers
    /// for which `weak` has nothing. Only with weak light.
    void TraceMissingWeak(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                          std::span<std::optional<WeakLight>> weak, GridStats &work) const;
    /// The second returns the light: the strong light, which it traces, plus `weak`, which must be set for all
    /// receivers.
    std::vector<bspGridPointSH_t> TraceStrongAndSum(std::span<const ProbeReceiver> receivers, std::uint64_t seed,
                                                    std::span<const std::optional<WeakLight>> weak, GridStats &work,
                                                    LightObserver *observer = nullptr) const;
    const WeakField *Weak() const { return weak_; }

  private:
    const ProbeIntegrator &integrator_;
    const WeakField *weak_;
};

} // namespace q3
