// GPL-2.0-or-later. Refinement of the octree where the light is not smooth.
#pragma once

#include "q3map2/light/sparse/display_error.h"
#include "q3map2/light/sparse/lattice.h"
#include "q3map2/light/sparse/octree.h"

namespace q3 {

/// Light at the corners of a cell; null where a corner is not among the points.
CornerLight CornersOf(const LatticePoints &points, const OctreeCell &cell);
/// Trilinear interpolation between the corners of a cell, all known. at: in lattice units.
SHFloats InterpolatedLight(const OctreeCell &cell, const CornerLight &corners, const Vec3f &at);

/// Splits cells whose expected error is above a threshold, and traces the points that this adds. Keeps references.
///
/// The hierarchical surplus of a point is its light minus what the larger cell around it gives there by interpolation.
/// Where light is smooth, surpluses fall to a quarter with each halving of cells; at shadow edges and beside lights
/// they hardly fall. The expected squared error of a cell is the mean squared surplus of its corners times a factor
/// between these two cases. What the noise of bounced light adds to squared differences is subtracted from them:
/// smaller cells would not reduce it.
class OctreeRefiner {
  public:
    OctreeRefiner(const BspSpace &space, const JobPool &jobs, const SparseLattice &lattice, Octree &tree,
                  LatticePoints &points)
        : space_(space), jobs_(jobs), lattice_(lattice), tree_(tree), points_(points) {}
    /// Splits all cells with open space down to the base level and adds the points of the uniform grid. radiance: see
    /// ToDisplayed.
    void Start(const LightGridSH &uniform, bool radiance);
    /// Sets the errors of the cells from these points.
    void EstimateErrors(BounceNoise noise);
    /// Splits these leafs.
    void Split(const std::vector<std::size_t> &cells, const LatticeTracer &tracer, GridStats &stats);
    /// Splits cells, also those of earlier calls, while their squared error times their open volume (bytes^2 times
    /// smallest cells) is above `threshold`.
    void Refine(float threshold, const LatticeTracer &tracer, GridStats &stats);

  private:
    /// Point n of the 3 x 3 x 3 corners of a cell's children, x fastest, then y, then z.
    static LatticePoint ChildCorner(const OctreeCell &cell, std::size_t n);
    bool HasOpenSpace(const OctreeCell &cell) const;
    /// OctreeCell::openFraction of a cell with open space, from its corners.
    float OpenFraction(const OctreeCell &cell) const;
    void AddUniformPoints(const LightGridSH &uniform, bool radiance);
    float SecondDifference(const LatticeSample &point) const;
    float MeasuredError(const OctreeCell &cell) const;
    /// A value for a new point in a solid, from one of the cells that have it.
    struct SolidValue {
        std::uint32_t number = 0; ///< of the point
        SHFloats value{};
    };
    void FillSolids(const std::vector<std::size_t> &cells, std::size_t firstNew);
    void AddSolidValues(const OctreeCell &cell, std::size_t firstNew, std::vector<SolidValue> &values) const;
    void SetErrorsAfterSplit(std::size_t parent);

    const BspSpace &space_;
    const JobPool &jobs_;
    const SparseLattice &lattice_;
    Octree &tree_;
    LatticePoints &points_;
    BounceNoise noise_;
};

} // namespace q3
