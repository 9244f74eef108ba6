// GPL-2.0-or-later. The lattice of the sparse SH grid.
#include "q3map2/light/sparse/sparse_lattice.h"

#include "q3map2/light/options/light_options.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// The smallest cells have edges of at least 2^-kMaxFineLevels cells of the uniform grid.
constexpr int kMaxFineLevels = 2;
/// The largest cells have edges of 2^kCoarseLevels cells of the uniform grid.
constexpr int kCoarseLevels = 3;

} // namespace

SparseLattice::SparseLattice(const bspGridSHHeader_t &uniform) : uniform_(uniform) {
    const Vec3f size(uniform.gridSize), least{kMinCell, kMinCell, kMinCell};
    while (baseLevel_ < kMaxFineLevels && Min(size / float(2 << baseLevel_), least) == least)
        ++baseLevel_;
    levels_ = baseLevel_ + kCoarseLevels + 1;
    cell_ = size / float(1 << baseLevel_);
    const Vec3f root = cell_ * float(1 << levels_);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        // One cell of the uniform grid to spare on each side: the world may reach beyond its points.
        const float origin = uniform.gridMins[axis], cell = size[axis];
        const auto rootsBefore = std::int32_t(std::floor((origin - cell) / root[axis]));
        // The first point of a grid need not be at a multiple of its cell: -shift moves grids.
        first_[axis] = (std::int32_t(std::lround(origin / cell)) << baseLevel_) - (rootsBefore << levels_);
        mins_[axis] = origin - cell_[axis] * float(first_[axis]);
        const float end = origin + cell * float(uniform.gridBounds[axis]);
        roots_[axis] = std::int32_t(std::floor((end - mins_[axis]) / root[axis])) + 1;
    }
}

std::size_t SparseLattice::UniformIndex(const LatticePoint &p) const {
    std::size_t index = 0, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int32_t at = (p[axis] - first_[axis]) >> baseLevel_;
        index += stride * std::size_t(std::clamp(at, 0, uniform_.gridBounds[axis] - 1));
        stride *= std::size_t(uniform_.gridBounds[axis]);
    }
    return index;
}

} // namespace q3
