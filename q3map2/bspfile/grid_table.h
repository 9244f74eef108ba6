// GPL-2.0-or-later. The light grid of RBSP and FBSP files: distinct points, and the number of one for each point.
#pragma once

#include "q3map2/bspfile/bsp_records.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace q3 {

/// Most records of a table: a number has 16 bits, and 65535 itself is not used.
inline constexpr std::size_t kMaxGridRecords = 65535;
/// Most points of a grid in engines of these files, and in NetRadiant's q3map2 for all files.
inline constexpr std::size_t kMaxGridPoints = 0x100000;

struct GridTable {
    std::vector<bspGridPoint_t> records;
    std::vector<std::uint16_t> numbers; ///< of the record, by point
};

/// What is lost where a grid has more different points than a table holds records.
struct GridTableLoss {
    std::size_t distinct = 0; ///< number of different points in the grid
    std::size_t changed = 0;  ///< number of points whose record differs from them
    int worst = 0;            ///< largest change of a color byte, over points, styles and channels
    double mean = 0;          ///< mean change of color bytes over the styles and channels of all points
};

/// The table of a grid, in order of first use. Over `most` different points, those nearest to each other are joined:
/// sets of points with the same styles are split where the squared error of colors and directions, weighted by the
/// number of points, is largest, until there are `most`; the record of a set has its mean color and the direction
/// of its point nearest to the mean. Errors: more than `most` different sets of styles.
GridTable MakeGridTable(std::span<const bspGridPoint_t> points, GridTableLoss &loss,
                        std::size_t most = kMaxGridRecords);

} // namespace q3
