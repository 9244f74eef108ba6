// GPL-2.0-or-later. The BSPX lumps LIGHTGRID_OCTREE and LIGHTGRIDS: points in boxes, boxes in solids left out.
#pragma once

#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/bspx_lumps.h"
#include "q3map2/gridformats/grid_source.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace q3 {

/// The only style of the points: that of lights which are always on.
inline constexpr std::byte kGridStyle{0};
/// Byte in place of a point's count of styles: nothing is known of its light.
inline constexpr std::byte kOccludedPoint{255};

/// A grid to encode.
struct OctreePoints {
    GridLayout layout;
    std::vector<bool> occluded; ///< by point: without light; engines blend the others
    /// Appends the bytes of a point that is not occluded.
    std::function<void(std::size_t point, std::vector<std::byte> &bytes)> append;
    bool leafHasStyles = false; ///< leafs have their number of styles before their points: LIGHTGRIDS
};

/// Without padding: size of a cell (3 floats), points per axis (3 int32), mins (3 floats), number of styles (1 byte),
/// reference to the root (uint32); number of nodes (uint32), for each its middle (3 int32, in lattice steps) and
/// references to eight parts; number of leafs (uint32), for each mins and size (3 int32 each), with `leafHasStyles` a
/// byte, and its points, x fastest. References: kLeafReference in the source. A box is split in the middle until an
/// axis has fewer than 4 points, fewer than 8 points are occluded or it was split five times; boxes of occluded points
/// alone have no leaf. A point has one style at most. Errors: all points are occluded.
std::vector<std::byte> EncodeGridOctree(const OctreePoints &points);

/// The points of the SH grid, each with the mean of its light over all normals; those that are void are occluded.
/// Errors: all are.
std::vector<std::byte> EncodeOctreeLump(const GridSource &source, const GridTone &tone);

/// One subgrid with the points of the SH grid, each with its light on surfaces that face +x, -x, +y, -y, +z, -z; black
/// sides are left out, and void points are occluded. Errors: all points are void, the lump would pass 2^32 bytes.
std::vector<std::byte> EncodeGridsLump(const GridSource &source, const GridTone &tone);

} // namespace q3
