// GPL-2.0-or-later. SH grid points fitted to the light between them.
#pragma once

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/weak_field.h"

#include <map>
#include <mutex>
#include <span>
#include <vector>

namespace q3 {

/// Light at a position between grid points.
struct FitSample {
    Vec3f position;
    bspGridPointSH_t value;
    float weight = 1; ///< samples wanted per cell / candidates tried in it: about the open fraction of the cell
    std::uint8_t seenCorners = 0xff; ///< bit per corner of its cell: whether the sample counts for that point
};

/// The points that a fit moves.
enum class FittedPoints {
    InSolids, ///< in or beside solids, and on emitters
    All
};

/// Weight of a sample in a fit: its own `weight` times (d / (d + m))^(1/4), since leaks show in the dark, with d =
/// kDarkLight and m the mean light of the brightest channel, 1 = byte 255; divided by a power of m where it is beyond
/// what a screen shows; constants are in the source.
float FitWeight(float weight, float mean, FittedPoints fitted);

/// Least-squares fit of grid points to the light between them, so that trilinear interpolation matches it best where
/// players can be. By default only points in or beside solids and on emitters are fitted; with -shfit all.
///
/// Minimizes the sum over samples s of w(s) |interpolated(s) - value(s)|^2 in SH coefficients, plus for each point p
/// pull * (sum of its samples' weights) * |value(p) - value before(p)|^2. Weights fall with a power of the light beyond
/// what a screen can show.
///
/// Keeps references to its constructor arguments.
class GridFit {
  public:
    /// states: of the points, before FillGridSH; isSplit: see VisibilityGroups.
    GridFit(const GridInputs &in, const GridLayout &layout, const std::vector<PointState> &states,
            const std::vector<bool> &isSplit);

    /// Samples of the cells whose lowest corners are the points of a brick. From any thread.
    std::vector<FitSample> SampleCells(std::span<const BrickPoint> points, const LightAtPositions &light,
                                       GridStats &work) const;
    /// Takes the samples of a brick; call once per brick, empty or not. From any thread; sums in the order of bricks.
    void AddSamples(std::int64_t brick, std::vector<FitSample> samples);
    /// Moves the fitted points to their best values. Call once all bricks are in.
    void Solve(LightGridSH &grid, const JobPool &jobs);

  private:
    static constexpr std::size_t kStencil = 27, kCenter = kStencil / 2;
    /// The normal equation of one point: the sum over the 27 points around it of stencil * value equals rhs.
    struct Row {
        std::uint32_t index = 0;
        std::array<float, kStencil> stencil{};
        std::array<float, kSHFloats> rhs{};
    };
    /// A corner of the cell of a position.
    struct Corner {
        std::int64_t index; ///< of the grid point
        float weight;       ///< trilinear, at the position
    };

    /// Samples of the cell whose lowest corner is a point, drawn in up to two rounds: their ranges among all samples,
    /// and the number of candidates tried.
    struct CellSamples {
        struct Range {
            std::size_t first = 0, count = 0;
        };
        const BrickPoint *point;
        int wanted = 0; ///< samples of the round that is drawn
        int tried = 0;  ///< candidates, in all rounds
        std::array<Range, 2> rounds{};
        /// WeakField::OffsetAt of the first sample.
        std::optional<WeakLight> offset{};
    };

    /// A position outside the grid counts as the nearest one inside.
    std::array<Corner, 8> CornersAt(const Vec3f &p) const;
    /// Whether a corner of the cell whose lowest corner is the point is fitted.
    bool HasFittedCorner(const BrickPoint &point) const;
    void DrawSamples(std::span<CellSamples> cells, std::size_t round, const LightAtPositions &light,
                     std::vector<FitSample> &samples, GridStats &work) const;
    /// The samples of one round, 0 or 1: `receivers` in the order of the cells. The first one is sample `firstSample`
    /// of all rounds.
    struct Round {
        std::span<CellSamples> cells;
        std::size_t number, firstSample;
        std::span<const ProbeReceiver> receivers;
        std::uint64_t seed;
    };
    void LightCells(const Round &round, const LightAtPositions &light, std::span<FitSample> samples,
                    GridStats &work) const;
    void FindSeen(std::span<FitSample> samples, GridStats &work) const;
    /// Adds a sample to the rows of the corners of its cell.
    void Accumulate(const FitSample &sample);
    bool AddPull(const bspGridPointSH_t &present, Row &row) const;
    float Relax(const Row &row, LightGridSH &grid) const;

    const GridInputs &in_;
    const GridLayout &layout_;
    int perCell_;        ///< samples wanted in a cell
    float pull_;         ///< see the class comment
    float maxBandRatio_; ///< limit of the norm of bands 1 and 2 over coefficient 0
    const std::vector<PointState> &states_;
    std::vector<std::int32_t> rowOf_; ///< by point; -1: not fitted
    std::vector<Row> rows_;
    std::mutex mutex_;                                       ///< guards the members below
    std::map<std::int64_t, std::vector<FitSample>> waiting_; ///< by brick: samples that must wait for brick next_
    std::int64_t next_ = 0;                                  ///< brick whose samples are added next
    bool isAdding_ = false;
};

} // namespace q3
