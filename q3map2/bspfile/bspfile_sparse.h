// GPL-2.0-or-later. The sparse SH light grid: octrees with quantized SH coefficients at the corners of their cells, and
// its BSPX lump.
#pragma once

#include "q3map2/bspfile/bsp_records.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace q3 {

/// An octree node of the sparse SH light grid. Child c is the octant with bit 0 of c set for the upper half in x, bit 1
/// in y, bit 2 in z. It is an inner node if its bit is set in `inner`, else a cell, that is, a leaf.
///
/// A cell owns the lattice point at its lower corner. With its bit in `stored` the value of that point is stored. With
/// its bit in `hanging` it follows from points of larger cells that touch it, see docs/reference/bsp_format.md. With
/// neither, no value exists there: solid space or void.
struct SparseGridNode {
    std::uint32_t children = 0; ///< index of the first inner child; the others follow
    std::uint32_t points = 0;   ///< index of the value of the first stored cell; the others follow
    std::uint8_t inner = 0, stored = 0, hanging = 0;
    std::uint8_t scale = 0; ///< of bands 1 and 2 of its points: the factor 2^((scale - 128) / 8) of kSparseBandLimits
    bool operator==(const SparseGridNode &) const = default;
};

/// Quantized coefficients of a point.
struct SparseGridPoint {
    std::uint32_t mean = 0;              ///< coefficient 0, as RGB9E5
    std::array<std::int8_t, 24> bands{}; ///< coefficients 1 to 8, red green blue each: see DequantizePoint
    bool operator==(const SparseGridPoint &) const = default;
};
static_assert(kPinned<SparseGridNode, 12> && kPinned<SparseGridPoint, 28>);

/// The sparse SH light grid as it is stored.
///
/// Nodes are in breadth-first order, the roots first, x fastest, then y, then z; children of a node are consecutive,
/// as are the points of its cells, both in the order of octants, so that all indexes are running sums.
///
/// The value at a position: the corners of its cell get trilinear weights. Then, for that cell and for each cube of
/// twice the edge around it: the weight of a stored corner goes to its value, that of a corner without a value, or
/// outside the roots, is dropped, and that of any other corner (hanging, or not the lower corner of the cell that
/// contains it) goes to the corners of the next cube, by trilinear weights. The sum of weighted values is divided by
/// the sum of their weights.
struct SparseGridSH {
    Float3 mins{};           ///< lower corner of root 0, game units
    Float3 cell{};           ///< size of the smallest cells, game units
    Int3 roots{};            ///< number of roots along each axis
    std::int32_t levels = 0; ///< a root's edge is cell * 2^levels
    std::vector<SparseGridNode> nodes;
    std::vector<SparseGridPoint> points;
    bool Empty() const { return nodes.empty(); }
    bool operator==(const SparseGridSH &) const = default;
};

/// The same before quantization, the input of PackSparseGrid. `children`, `points` and `scale` of nodes are not used.
struct SparseGridTree {
    Float3 mins{}, cell{};
    Int3 roots{};
    std::int32_t levels = 0;
    std::vector<SparseGridNode> nodes;
    std::vector<bspGridPointSH_t> values; ///< of stored cells, in the order of SparseGridSH::points
};

inline constexpr std::int32_t kMaxSparseLevels = 12; ///< limit of this program, chosen
/// Most of the smallest cells along an axis, roots * 2^levels: floats hold all whole numbers up to it.
inline constexpr std::int32_t kMaxSparseCells = 1 << 24;
/// Largest |coefficient| of bands 1 and 2 over coefficient 0 of cosine-convolved light that is nowhere negative:
/// 2/sqrt(3) and sqrt(5)/4, which light from a single direction reaches: (A_l / A_0) sqrt(2l + 1) with A = pi, 2 pi /
/// 3, pi / 4 (Ramamoorthi and Hanrahan 2001, An Efficient Representation for Irradiance Environment Maps).
inline constexpr std::array<float, 2> kSparseBandLimits = {1.15470054f, 0.559016994f};

/// The factor that a node's `scale` encodes: 2^((scale - 128) / 8).
float SparseScale(std::uint8_t scale);
/// The code of the smallest SparseScale that is at least `needed`, or of the largest.
std::uint8_t SparseScaleCode(float needed);

/// Quantizes the values. The scale of a node is the smallest that holds its points; light below zero becomes 0 in
/// coefficient 0. Errors: those of CheckSparseGrid, another number of values than of stored cells, values that are not
/// finite.
SparseGridSH PackSparseGrid(const SparseGridTree &tree);
/// The coefficients of a point of a node with that scale: coefficient 0 is `mean`; the others are their step / 127
/// times the limit of their band, SparseScale(scale) and coefficient 0 of the channel.
bspGridPointSH_t DequantizePoint(const SparseGridPoint &point, std::uint8_t scale);
/// The values of all points. Errors: none for a grid that CheckSparseGrid accepts.
std::vector<bspGridPointSH_t> DequantizePoints(const SparseGridSH &grid);

/// Size of the lump of a grid with so many nodes and points, bytes.
constexpr std::size_t SparseGridBytes(std::size_t nodes, std::size_t points) {
    return sizeof(bspSparseGridHeader_t) + nodes * sizeof(SparseGridNode) + points * sizeof(SparseGridPoint);
}
/// The bytes of the lump. Errors: those of CheckSparseGrid.
std::vector<std::byte> EncodeSparseGrid(const SparseGridSH &grid);
/// Errors: a bad head, a length that does not fit it, those of CheckSparseGrid.
SparseGridSH DecodeSparseGrid(std::span<const std::byte> lump);

// ---- The BSPX lump LIGHTGRID_SH_SPARSE ----

class ByteRanges;
struct BspxSource;

/// The head of the lump of a grid.
bspSparseGridHeader_t HeaderOf(const SparseGridSH &grid);
/// Reads the lump from a file. Errors: those of DecodeSparseGrid.
SparseGridSH ReadSparseGrid(const BspxSource &from);
/// The bytes of the lump, without checks.
ByteRanges SparseRanges(const SparseGridSH &grid);
/// Sets `children` and `points` of all nodes: the running sums of inner children and of stored cells.
void NumberSparseNodes(SparseGridSH &grid);
/// Numbers of cells of a level of the tree whose lower corner is stored, is hanging, or has no value.
struct SparseLevelCounts {
    std::size_t stored = 0, hanging = 0, empty = 0;
};
/// For each level that has nodes, the largest cells first. The grid is one that CheckSparseGrid accepts.
std::vector<SparseLevelCounts> CountSparseLevels(const SparseGridSH &grid);
/// Errors: numbers out of range, indexes that are not running sums, a tree that has other nodes or points.
void CheckSparseGrid(const SparseGridSH &grid, std::string_view name);

} // namespace q3
