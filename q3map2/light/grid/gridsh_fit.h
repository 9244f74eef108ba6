// GPL-2.0-or-later. Grid points fitted to the light between them.
#pragma once

#include "q3map2/light/grid/gridsh_fill.h"
#include "q3map2/light/grid/probe_integrator.h"

#include <map>
#include <mutex>
#include <span>
#include <vector>

namespace q3 {

/// Light at a place between points.
struct FitSample {
    Vec3f position;
    bspGridPointSH_t value;
    float weight = 1;         ///< samples of an open cell over the candidates drawn in this one
    std::uint8_t sees = 0xff; ///< by corner of its cell: whether it may move that point
};

/// Least-squares fit of grid points, so that what trilinear interpolation shows where players can be is as near as can
/// be to the light there. By default it fits the points in solids alone, whose values are free; with -shfit all.
///
/// Minimises, over samples s with weight w, the sum of w |shown(s) - value(s)|^2, plus a pull of each point towards the
/// value that it had, in proportion to the samples that it takes part in. In SH coefficients, so over all normals
/// alike. The weight falls with the fourth power of light beyond what a screen can show.
///
/// Keeps references to everything that it is made of.
class GridFit {
  public:
    /// states: of the points, before FillGridSH; isSplit: see DividedPoints.
    GridFit(const GridInputs &in, const GridLayout &layout, const std::vector<PointState> &states,
            const std::vector<bool> &isSplit);

    /// Samples of the cells whose lowest corners are the points of a brick. From any thread.
    std::vector<FitSample> SampleCells(std::span<const BrickPoint> points, const ProbeIntegrator &lighter,
                                       GridStats &work) const;
    /// Takes the samples of a brick; each brick once. From any thread; sums in the order of bricks.
    void AddSamples(std::int64_t brick, std::vector<FitSample> samples);
    /// Moves the fitted points to their best values. Call once all bricks are in.
    void Solve(LightGridSH &grid, const JobPool &jobs);

  private:
    using ShCoefficients = std::array<float, kShFloats>;
    static constexpr std::size_t kStencil = 27, kCenter = kStencil / 2;
    /// One equation: the sum over 27 points around of stencil times value is rhs.
    struct Row {
        std::uint32_t index = 0;
        std::array<float, kStencil> stencil{};
        std::array<float, kShFloats> rhs{};
    };
    struct Corner {
        std::int64_t index;
        float weight;
    };

    /// Drawing samples of the cell above a point, in two rounds: where those of each are among all, and how many
    /// candidates it took.
    struct Draw {
        struct Range {
            std::size_t first = 0, count = 0;
        };
        const BrickPoint *point;
        int wanted = 0; ///< in this round
        int tried = 0;
        std::array<Range, 2> rounds{};
    };

    std::array<Corner, 8> CornersAt(const Vec3f &p) const;
    bool AnyRow(const BrickPoint &point) const;
    void SurfaceReceiverBatch(const BspRegion &space, std::span<Draw> cells, std::size_t round,
                              const ProbeIntegrator &lighter, std::vector<FitSample> &samples, GridStats &work) const;
    void FindSeen(std::span<FitSample> samples, GridStats &work) const;
    void Accumulate(const FitSample &sample);
    bool AnyMoving(const Row &row, const std::vector<std::uint8_t> &moving) const;
    bool AddPull(const bspGridPointSH_t &present, Row &row) const;
    void Prefetch(const Row &row, const LightGridSH &grid) const;
    float Relax(const Row &row, LightGridSH &grid) const;

    const GridInputs &in_;
    const GridLayout &layout_;
    int perCell_;
    float pull_, beyondScreen_;
    float mostBands_;
    const std::vector<PointState> &states_;
    std::vector<std::int32_t> rowOf_; // by point; -1: not fitted
    std::vector<Row> rows_;
    std::mutex mutex_;
    std::map<std::int64_t, std::vector<FitSample>> waiting_;
    std::int64_t next_ = 0;
};

} // namespace q3
