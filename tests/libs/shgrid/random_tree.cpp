// GPL-2.0-or-later. Random octrees of the sparse SH grid, and their field by the definition, slowly.
#include "tests/libs/shgrid/random_tree.h"

#include <algorithm>

namespace q3::test {

namespace {

Int3 Octant(const Int3 &low, int child, int half) {
    return {low[0] + (child & 1) * half, low[1] + (child >> 1 & 1) * half, low[2] + (child >> 2) * half};
}

} // namespace

RandomTree::RandomTree(const TreeShape &shape, unsigned seed) : shape_(shape), random_(seed) {
    tree_.roots = shape.roots;
    tree_.levels = shape.levels;
    tree_.mins = {-37, 12.5f, 100};
    tree_.cell = {8, 16, 4};
    for (std::size_t axis = 0; axis < 3; ++axis)
        bounds_[axis] = shape.roots[axis] << shape.levels;
    sizes_.resize(std::size_t(bounds_[0]) * std::size_t(bounds_[1]) * std::size_t(bounds_[2]));
    const int edge = 1 << shape.levels;
    for (int z = 0; z < bounds_[2]; z += edge)
        for (int y = 0; y < bounds_[1]; y += edge)
            for (int x = 0; x < bounds_[0]; x += edge)
                Divide({x, y, z}, 0);
    Number();
}

std::size_t RandomTree::Index(const Int3 &at) const {
    return std::size_t(at[0]) +
           std::size_t(bounds_[0]) * (std::size_t(at[1]) + std::size_t(bounds_[1]) * std::size_t(at[2]));
}

int RandomTree::SizeAt(const Int3 &at) const {
    return sizes_[Index(at)];
}

void RandomTree::Divide(const Int3 &low, int level) {
    const int half = 1 << (shape_.levels - level - 1);
    for (int child = 0; child < 8; ++child) {
        const Int3 from = Octant(low, child, half);
        if (half > 1 && std::uniform_real_distribution<>()(random_) < shape_.split) {
            Divide(from, level + 1);
            continue;
        }
        for (int z = 0; z < half; ++z)
            for (int y = 0; y < half; ++y)
                for (int x = 0; x < half; ++x)
                    sizes_[Index({from[0] + x, from[1] + y, from[2] + z})] = std::int8_t(shape_.levels - level - 1);
    }
}

bool RandomTree::IsHanging(const Int3 &at) const {
    for (int side = 0; side < 8; ++side) {
        const Int3 cell = {at[0] - (side & 1), at[1] - (side >> 1 & 1), at[2] - (side >> 2)};
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis)
            inside = inside && cell[axis] >= 0 && cell[axis] < bounds_[axis];
        if (inside && ((at[0] | at[1] | at[2]) & ((1 << SizeAt(cell)) - 1)) != 0)
            return true;
    }
    return false;
}

/// Level by level, as the lump has them.
void RandomTree::Number() {
    std::vector<Int3> level;
    const int edge = 1 << shape_.levels;
    for (int z = 0; z < bounds_[2]; z += edge)
        for (int y = 0; y < bounds_[1]; y += edge)
            for (int x = 0; x < bounds_[0]; x += edge)
                level.push_back({x, y, z});
    std::uniform_real_distribution<float> unit(0, 1);
    for (int size = shape_.levels - 1; !level.empty(); --size) {
        std::vector<Int3> next;
        for (const Int3 &low : level) {
            SparseGridNode node;
            for (int child = 0; child < 8; ++child) {
                const Int3 at = Octant(low, child, 1 << size);
                const auto bit = std::uint8_t(1 << child);
                if (SizeAt(at) < size) {
                    node.inner |= bit;
                    next.push_back(at);
                } else if (IsHanging(at)) {
                    node.hanging |= bit;
                } else if (unit(random_) >= float(shape_.absent)) {
                    node.stored |= bit;
                    stored_[at] = places_.size();
                    places_.push_back(at);
                    bspGridPointSH_t value{};
                    for (std::size_t channel = 0; channel < 3; ++channel) {
                        value.coeffs[0][channel] = shape_.darkest + (1 - shape_.darkest) * unit(random_);
                        for (std::size_t k = 1; k < 9; ++k)
                            value.coeffs[k][channel] = value.coeffs[0][channel] * (unit(random_) - 0.5f);
                    }
                    tree_.values.push_back(value);
                }
            }
            tree_.nodes.push_back(node);
        }
        level = next;
    }
}

void RandomTree::SetValues(const std::vector<bspGridPointSH_t> &values) {
    tree_.values = values;
}

/// The largest cell that touches a point says what is there: the value of its corner, or a blend of its corners.
SlowValue RandomTree::PointValue(const Int3 &at) const {
    int largest = -1;
    Int3 low{};
    for (int side = 0; side < 8; ++side) {
        const Int3 cell = {at[0] - (side & 1), at[1] - (side >> 1 & 1), at[2] - (side >> 2)};
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis)
            inside = inside && cell[axis] >= 0 && cell[axis] < bounds_[axis];
        if (!inside || SizeAt(cell) <= largest)
            continue;
        largest = SizeAt(cell);
        const int edge = 1 << largest;
        low = {cell[0] / edge * edge, cell[1] / edge * edge, cell[2] / edge * edge};
    }
    if (largest >= 0 && ((at[0] | at[1] | at[2]) & ((1 << largest) - 1)) != 0)
        return BlendIn(low, largest, {double(at[0]), double(at[1]), double(at[2])});
    SlowValue value;
    if (const auto found = stored_.find(at); found != stored_.end()) {
        value.weight = 1;
        for (std::size_t i = 0; i < 27; ++i)
            value.sum[i] = double(tree_.values[found->second].coeffs[i / 3][i % 3]);
    }
    return value;
}

SlowValue RandomTree::BlendIn(const Int3 &low, int size, const std::array<double, 3> &at) const {
    SlowValue blend;
    const int edge = 1 << size;
    for (int corner = 0; corner < 8; ++corner) {
        double weight = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double fraction = (at[axis] - low[axis]) / edge;
            weight *= (corner >> axis & 1) != 0 ? fraction : 1 - fraction;
        }
        if (weight > 0)
            blend.Add(PointValue(Octant(low, corner, edge)), weight);
    }
    return blend;
}

SlowValue RandomTree::Blend(const std::array<double, 3> &at) const {
    Int3 low{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        low[axis] = std::clamp(int(at[axis]), 0, bounds_[axis] - 1);
    const int size = SizeAt(low), edge = 1 << size;
    for (std::int32_t &coordinate : low)
        coordinate = coordinate / edge * edge;
    return BlendIn(low, size, at);
}

} // namespace q3::test
