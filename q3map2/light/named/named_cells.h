// GPL-2.0-or-later. The cells of a grid that names lights while it is built: an octree, receivers at its corners and
// inside its cells, and the error that named lights leave there.
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

/// Whether cells are those of the uniform grid, or are split and joined where that pays.
enum class CellSizes { Uniform, Adaptive };

/// The eight corners of a cell, by number of the corner; null: in a solid.
using CornerReceivers = std::array<const NamedReceiver *, 8>;

/// An octree whose corners and samples are traced as it grows. Keeps references.
class NamedCells {
  public:
    NamedCells(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
               const LightTable &table, CellSizes sizes);

    /// Traces the points of the uniform grid, makes its cells the leafs, and samples them. Call it first.
    void Start(GridStats &work);
    /// Splits leafs whose squared error times open volume (bytes^2 times smallest cells) is above `threshold`, unless
    /// their children would be smaller than 8 game units. The error of a cell is what blending between its corners,
    /// with the strongest lights named, leaves at the samples inside. False: there are none.
    bool Split(float threshold, GridStats &work);
    const SparseLattice &Lattice() const { return lattice_; }
    const Octree &Tree() const { return tree_; }
    const LatticePoints &Points() const { return points_; }
    const LightTable &Table() const { return table_; }
    /// Receiver at a lattice point; null: it is in a solid.
    const NamedReceiver *ReceiverAt(std::uint32_t point) const {
        return points_[point].traced ? &corners_[point] : nullptr;
    }
    CornerReceivers CornersOf(const OctreeCell &cell) const;
    /// Squared displayed error of a blend of the corners of a cell at a receiver in it, with the strongest lights
    /// named. Bytes^2.
    float SquaredErrorAt(const OctreeCell &cell, const NamedReceiver &receiver) const;
    /// Receivers inside cells.
    std::span<const NamedReceiver> Samples() const { return samples_; }

  private:
    void SetUniformPoints(const LightGridSH &grid, const LightCollector &collector,
                          const std::vector<PointState> &states);
    void TracePoints(std::size_t first, GridStats &work);
    void SampleLeafs(std::span<const std::size_t> leafs, GridStats &work);
    std::vector<NamedReceiver> DrawSamples(OctreeCell &leaf, std::size_t have) const;
    void TraceReceivers(std::span<NamedReceiver> receivers, GridStats &work) const;
    void TakeSamples(std::size_t first);
    void MeasureErrors(std::size_t firstCell);
    float ErrorOf(const OctreeCell &cell, std::span<const std::uint32_t> samples) const;
    bool HasOpenSpace(const OctreeCell &cell) const;
    bool CanSplit(const OctreeCell &cell) const;

    const GridInputs &in_;
    const GridLayout &layout_;
    const LightTable &table_;
    std::size_t mostNames_; ///< of a cell
    Boundsf world_;         ///< of model 0
    SparseLattice lattice_;
    GridSHTracer tracer_;
    ProbeIntegrator integrator_;
    std::optional<LightAtPositions> light_; ///< after the uniform grid is traced
    Octree tree_;
    LatticePoints points_;
    std::vector<NamedReceiver> corners_; ///< by lattice point
    std::vector<NamedReceiver> samples_;
    std::vector<std::vector<std::uint32_t>> samplesOf_; ///< by cell: those inside when it was a leaf
    ScreenError screen_;
};

} // namespace q3
