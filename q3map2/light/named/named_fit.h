// GPL-2.0-or-later. Which lights the points of a grid name, their shares, and the rest of the light.
#pragma once

#include "q3map2/light/named/named_cells.h"
#include "q3map2/light/sparse/corner_fit.h"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace q3 {

/// What is stored at a point.
struct NamedValue {
    std::vector<std::uint32_t> names; ///< numbers of lights, in ascending order
    std::vector<std::uint8_t> shares; ///< by name, of 255
    SHFloats rest{};                  ///< convolved with the cosine
};

/// What becomes of corners, by lattice point. Those in solids are left out, except where the others would have little
/// weight at a sample. Those that could hang are stored where the larger leaf is wrong about their light, since it is
/// on the other side of a wall, or of a shadow edge.
std::vector<CornerWeights::Rule> RulesOfCorners(const Octree &tree, const NamedCells &cells, const JobPool &jobs);

/// Values of the stored corners of a tree, in the order of corners.Stored().
///
/// A cell names up to `mostNames` lights, those whose naming lowers the squared error at its samples most; its corners
/// name them all. Shares, and then what named lights leave of the light, are least-squares fits to the samples, with a
/// pull towards what was traced at the corners.
///
/// A light with a style is named wherever it shines. Where readers would find too many names, cells name fewer;
/// dropped: by light with a style, the cells that cannot name it.
std::vector<NamedValue> FitNamedCorners(const Octree &tree, const NamedCells &cells, CornerWeights &corners,
                                        std::size_t mostNames, const JobPool &jobs,
                                        std::map<std::uint32_t, std::size_t> &dropped);

} // namespace q3
