// GPL-2.0-or-later. The lattice of the sparse SH grid.
#include "q3map2/light/sparse/sparse_lattice.h"

#include "q3map2/light/options/light_options.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Cells of the uniform grid are halved at most kMaxFineLevels times; for Cubic at most kMaxCubicLevels times, and
/// along longer edges up to kMaxStretch times more.
constexpr int kMaxFineLevels = 2, kMaxCubicLevels = 4, kMaxStretch = 2;
/// The largest cells have edges of 2^kCoarseLevels cells of the uniform grid.
constexpr int kCoarseLevels = 3;

/// How often all edges of a cell can be halved without one below `least`.
int HalvingsDownTo(float least, const Vec3f &size, int most) {
    const float shortest = std::min({size.x, size.y, size.z});
    int halvings = 0;
    while (halvings < most && shortest / float(2 << halvings) >= least)
        ++halvings;
    return halvings;
}

Int3 AsOftenAlongAllAxes(const bspGridSHHeader_t &uniform) {
    const int halvings = HalvingsDownTo(kMinCell, Vec3f(uniform.gridSize), kMaxFineLevels);
    return {halvings, halvings, halvings};
}

} // namespace

SparseLattice::SparseLattice(const bspGridSHHeader_t &uniform) : SparseLattice(uniform, AsOftenAlongAllAxes(uniform)) {}

SparseLattice SparseLattice::Cubic(const bspGridSHHeader_t &uniform) {
    const Vec3f size(uniform.gridSize);
    const float shortest = std::min({size.x, size.y, size.z});
    const int halvings = HalvingsDownTo(kMinCubicCell, size, kMaxCubicLevels);
    Int3 levels{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        levels[axis] = halvings + std::min(kMaxStretch, int(std::lround(std::log2(size[axis] / shortest))));
    return {uniform, levels};
}

SparseLattice::SparseLattice(const bspGridSHHeader_t &uniform, const Int3 &uniformLevel)
    : uniform_(uniform), uniformLevel_(uniformLevel),
      baseLevel_(std::max({uniformLevel[0], uniformLevel[1], uniformLevel[2]})),
      levels_(baseLevel_ + kCoarseLevels + 1) {
    const Vec3f size(uniform.gridSize);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        cell_[axis] = size[axis] / float(1 << uniformLevel_[axis]);
        // One base cell to spare on each side: the world may reach beyond the points of the uniform grid.
        const float root = cell_[axis] * float(1 << levels_), spare = cell_[axis] * float(1 << baseLevel_);
        const float origin = uniform.gridMins[axis], cell = size[axis];
        const auto rootsBefore = std::int32_t(std::floor((origin - spare) / root));
        // The first point of a grid need not be at a multiple of its cell: -shift moves grids.
        first_[axis] = (std::int32_t(std::lround(origin / cell)) << uniformLevel_[axis]) - (rootsBefore << levels_);
        mins_[axis] = origin - cell_[axis] * float(first_[axis]);
        const float end = origin + cell * float(uniform.gridBounds[axis] - 1) + spare;
        roots_[axis] = std::int32_t(std::floor((end - mins_[axis]) / root)) + 1;
    }
}

std::size_t SparseLattice::UniformIndex(const LatticePoint &p) const {
    std::size_t index = 0, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t at = (p[axis] - first_[axis]) >> uniformLevel_[axis];
        index += stride * std::size_t(std::clamp(at, 0, uniform_.gridBounds[axis] - 1));
        stride *= std::size_t(uniform_.gridBounds[axis]);
    }
    return index;
}

} // namespace q3
