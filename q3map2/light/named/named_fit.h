// GPL-2.0-or-later. Chooses the lights that the points of a grid name, and fits their shares and the rest of the light.
#pragma once

#include "q3map2/light/named/named_cells.h"
#include "q3map2/light/sparse/corner_fit.h"
#include "q3map2/light/sparse/sparse_tree.h"

#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace q3 {

/// The value of a point.
struct NamedValue {
    std::vector<std::uint32_t> names; ///< numbers of lights, in ascending order
    std::vector<std::uint8_t> shares; ///< by name: visible share, 0 to 255
    SHFloats rest{};                  ///< all other light, convolved with the cosine
};

/// The rules of corners, by lattice point. A corner in a solid is left out, unless the corners in the open would have
/// little weight at a sample of one of its leafs. A corner that could hang is stored if the light interpolated in the
/// larger leaf is wrong there, because a wall or a shadow edge lies between.
std::vector<CornerWeights::Rule> RulesOfCorners(const Octree &tree, const NamedCells &cells, const JobPool &jobs);

/// Values of the stored corners of a tree, in the order of corners.Stored().
///
/// A cell names up to `mostNames` lights of style 0: those whose naming lowers the squared displayed error at its
/// samples most. All its corners name them. Then the shares are fitted to the samples by least squares, and after them
/// the rest, each with a pull towards what was traced at the corners.
///
/// A cell also names the lights with a style that shine in it. If readers would find too many names at any place, all
/// cells name fewer. dropped: by light with a style, the number of cells that cannot name it.
std::vector<NamedValue> FitNamedCorners(const Octree &tree, const NamedCells &cells, CornerWeights &corners,
                                        std::size_t mostNames, const JobPool &jobs,
                                        std::map<std::uint32_t, std::size_t> &dropped);

} // namespace q3
