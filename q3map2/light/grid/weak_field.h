// GPL-2.0-or-later. The weak part of the light at points of the SH grid, and its interpolation where it is smooth.
#pragma once

#include "q3map2/light/batch/lanes.h"
#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/scene/light_space.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace q3 {

/// Sum of the weak shares of all lights (see LightPart), of bounced light and of floodlight at a point: coefficients of
/// the SH grid before ambient light, minimum light and grid scale. 1 = byte 255.
using WeakLight = bspGridPointSH_t;

/// Largest change that coefficients make to displayed light, over the 26 faces, edges and corners of a cube.
class DisplayedChange {
  public:
    /// radiance: the coefficients are not yet convolved with the cosine. scale: what 1 is displayed as.
    DisplayedChange(bool radiance, float scale);
    /// Over all normals and channels, as if nothing were cut at black or white. Unit: that of `scale`.
    float Of(const WeakLight &change) const;

  private:
    static constexpr std::size_t kAxes = 13;
    std::array<Lanes, 9> basis_; ///< by coefficient: basis function on each of 13 normals; the others are opposite
};

/// Weak light at the points of a grid. A point is of one of six levels by its column (x, y), from every fourth column
/// on both axes to every second of a checkerboard; of the first columns, layers of even z are of level 0 and the
/// others of level 1:
///
///     0/1  5   3   5  0/1
///      5   4   5   4   5
///      3   5   2   5   3
///      5   4   5   4   5
///     0/1  5   3   5  0/1
///
/// A point is the midpoint of pairs of points of lower levels: above and below on level 1, else two pairs on the
/// diagonals or on the axes of its layer, as 4 is of 0 2 and 3 3. Its prediction is the cubic through a pair and the
/// points three times as far out, (9 (a + b) - (c + d)) / 16, or their mean where those are not seen; of two pairs, the
/// mean of both. The error of a prediction is known where the point was traced, and expected to be no larger, and
/// smaller from level to level, nearby.
///
/// Levels are filled one after the other; points of one level from any thread.
class WeakField {
  public:
    static constexpr int kLevels = 6;
    static int LevelOf(int x, int y, int z);

    /// states: of the points; those not Open predict nothing and are not predicted. Keeps references.
    WeakField(const BspSpace &space, const GridLayout &layout, const std::vector<PointState> &states,
              const DisplayedChange &change);

    /// What the points of lower levels tell of a point.
    struct Prediction {
        WeakLight light{};
        int pairs = 0;         ///< pairs in the open that the mean is taken from; 0: `light` is not set
        bool isTested = false; ///< errors nearby are known
        float error = 0;       ///< expected error, if isTested. Byte scale
        /// Whether the prediction may stand for the light.
        bool Good() const;
    };
    Prediction Predict(int x, int y, int z) const;
    /// Sets a point to its prediction.
    void Accept(std::uint32_t index, const Prediction &prediction);
    /// Sets a point that was traced; with the prediction, its error becomes known.
    void SetTraced(std::uint32_t index, const WeakLight &light, const Prediction &prediction);

    bool IsOpen(std::uint32_t index) const { return states_[index] == PointState::Open; }
    const WeakLight &At(std::uint32_t index) const { return light_[index]; }

    /// Weak light from the corners of a position's cell that are in the open and in clear sight, plus `offset`; nothing
    /// without such corners, or where the error at one is large. After all levels.
    std::optional<WeakLight> Around(const Vec3f &position, const WeakLight &offset) const;
    /// Weak light that was traced at a position minus Around; nothing if that is missing or too much for a fit.
    std::optional<WeakLight> OffsetAt(const Vec3f &position, const WeakLight &traced) const;

  private:
    /// The cell of a position: its lowest corner, and the position in it from 0 to 1 per axis.
    struct Place {
        Int3 low{};
        std::array<float, 3> part{};
    };
    WeakLight BendAt(const Int3 &at, const Int3 &step, const WeakLight &mean) const;
    bool FindPlace(const Vec3f &position, Place &place) const;
    float ErrorNear(int x, int y, int z) const;
    std::int64_t OpenPoint(int x, int y, int z) const;
    bool IsClear(const Vec3f &a, const Vec3f &b) const;

    const BspSpace &space_;
    const GridLayout &layout_;
    const std::vector<PointState> &states_;
    DisplayedChange change_;
    std::vector<WeakLight> light_;
    std::vector<float> error_; ///< by point, byte scale; kUntested
};

} // namespace q3
