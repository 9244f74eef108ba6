// GPL-2.0-or-later. The sparse SH light grid: an octree whose cells share their corners.
#pragma once

#include "q3map2/bspfile/bsp.h"

#include <array>
#include <cstdint>
#include <vector>

namespace q3 {

/// An octree node of the sparse SH light grid. Child c is the octant with bit 0 of c set for the upper half in x, bit 1
/// in y, bit 2 in z. It is an inner node if its bit is set in `inner`, else a cell, that is, a leaf.
///
/// A cell owns the lattice point at its lower corner. With its bit in `stored` the value of that point is stored. With
/// its bit in `hanging` it follows from points of larger cells that touch it, see docs/bsp_format.md. With neither, no
/// value exists there: solid space or void.
struct SparseGridNode {
    std::uint32_t children = 0; ///< index of the first inner child; the others follow
    std::uint32_t points = 0;   ///< index of the value of the first stored cell; the others follow
    std::uint8_t inner = 0, stored = 0, hanging = 0;
    std::uint8_t scale = 0; ///< limit of bands 1 and 2 over band 0 of its points: 2^((scale - 128) / 8) times the usual
    bool operator==(const SparseGridNode &) const = default;
};

/// Quantized coefficients of a point.
struct SparseGridPoint {
    std::uint32_t mean = 0;              ///< coefficient 0, as RGB9E5
    std::array<std::int8_t, 24> bands{}; ///< coefficients 1 to 8, red green blue each, over coefficient 0
    bool operator==(const SparseGridPoint &) const = default;
};

/// Nodes are in breadth-first order, the roots first, x fastest, then y, then z; children of a node are consecutive,
/// as are the points of its cells, both in the order of octants, so that all indexes are running sums.
struct SparseGridSH {
    Float3 mins{};           ///< lower corner of root 0
    Float3 cell{};           ///< size of the smallest cells
    Int3 roots{};            ///< roots by axis
    std::int32_t levels = 0; ///< a root's edge is cell * 2^levels
    std::vector<SparseGridNode> nodes;
    std::vector<SparseGridPoint> points;
    bool Empty() const { return nodes.empty(); }
};

/// The same with plain values: what PackSparseGrid quantizes. `children`, `points` and `scale` of nodes are not used.
struct SparseGridTree {
    Float3 mins{}, cell{};
    Int3 roots{};
    std::int32_t levels = 0;
    std::vector<SparseGridNode> nodes;
    std::vector<bspGridPointSH_t> values; ///< of stored cells, in the order of SparseGridSH::points
};

} // namespace q3
