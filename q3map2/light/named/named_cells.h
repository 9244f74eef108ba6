// GPL-2.0-or-later. The cells of a grid that names lights while it is built: an octree, receivers at its corners and
// inside its cells, and the error of interpolation in each cell.
#pragma once

#include "q3map2/light/grid/light_gridsh.h"
#include "q3map2/light/named/named_receivers.h"
#include "q3map2/light/sparse/display_error.h"
#include "q3map2/light/sparse/lattice.h"
#include "q3map2/light/sparse/octree.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// Whether the grid has the cells of the uniform grid, or cells that are split and joined to lower its error.
enum class CellSizes { Uniform, Adaptive };

/// The receivers at the corners of a cell, by number of the corner; null for corners in solids.
using CornerReceivers = std::array<const NamedReceiver *, 8>;

/// An octree with traced receivers at its corners and, as samples, inside its cells. Keeps references.
class NamedCells {
  public:
    NamedCells(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
               const LightTable &table, CellSizes sizes);

    /// Traces the points of the uniform grid, makes its cells the leafs, and samples them. Call it first.
    void Start(GridStats &work);
    /// Splits leafs whose mean squared error times open volume (bytes^2 times smallest cells) is above `threshold`,
    /// unless their children would have an edge below 8 game units. The error is the displayed one at the samples in
    /// the leaf, of interpolation between its corners with the strongest lights named; leaks of light into the dark
    /// have a larger weight. False if no leaf is to be split.
    bool Split(float threshold, GridStats &work);
    const SparseLattice &Lattice() const { return lattice_; }
    const Octree &Tree() const { return tree_; }
    const LatticePoints &Points() const { return points_; }
    const LightTable &Table() const { return table_; }
    /// The receiver at a lattice point; null for points in solids.
    const NamedReceiver *ReceiverAt(std::uint32_t point) const {
        return points_[point].traced ? &corners_[point] : nullptr;
    }
    CornerReceivers CornersOf(const OctreeCell &cell) const;
    /// Squared displayed error of interpolation between the corners of a cell, with the strongest lights named, at a
    /// receiver in the cell. Bytes^2.
    float SquaredErrorAt(const OctreeCell &cell, const NamedReceiver &receiver) const;
    /// The receivers inside cells.
    std::span<const NamedReceiver> Samples() const { return samples_; }

  private:
    void SetUniformPoints(const LightGridSH &grid, const LightCollector &collector,
                          const std::vector<PointState> &states);
    void TracePoints(std::size_t first, GridStats &work);
    void SampleLeafs(std::span<const std::size_t> leafs, GridStats &work);
    /// A leaf, and the candidates for its next samples: bit i for candidate i.
    struct LeafToSample {
        std::size_t leaf = 0;
        std::uint32_t candidates = 0;
    };
    NamedReceiver Candidate(const OctreeCell &leaf, std::uint32_t number) const;
    LeafToSample FindCandidates(std::size_t leaf);
    void AddSamples(std::span<LeafToSample> leafs, std::size_t wanted, GridStats &work);
    void TraceReceivers(std::span<NamedReceiver> receivers, GridStats &work) const;
    void MeasureError(std::size_t cell) { tree_[cell].error = ErrorOf(tree_[cell], samplesOf_[cell]); }
    float ErrorOf(const OctreeCell &cell, std::span<const std::uint32_t> samples) const;
    bool HasOpenSpace(const OctreeCell &cell) const;
    bool CanSplit(const OctreeCell &cell) const;

    const GridInputs &in_;
    const GridLayout &layout_;
    const LightTable &table_;
    std::size_t mostNames_; ///< lights that a cell names at most
    Boundsf world_;         ///< bounds of model 0
    SparseLattice lattice_;
    GridSHTracer tracer_;
    ProbeIntegrator integrator_;
    std::optional<LightAtPositions> light_; ///< set once the uniform grid is traced
    Octree tree_;
    LatticePoints points_;
    std::vector<NamedReceiver> corners_; ///< by lattice point
    std::vector<NamedReceiver> samples_;
    std::vector<std::vector<std::uint32_t>> samplesOf_; ///< by cell: its samples; after a split leafs get the new ones
    ScreenError screen_;
};

} // namespace q3
