// GPL-2.0-or-later. Random octrees of the sparse SH grid, and their field by the definition, slowly.
#pragma once

#include "q3map2/bspfile/bspfile_sparse.h"

#include <array>
#include <map>
#include <random>
#include <vector>

namespace q3::test {

/// What a random tree is like.
struct TreeShape {
    Int3 roots{1, 1, 1};
    int levels = 3;
    double split = 0.6;    ///< probability that a node is inner
    double absent = 0;     ///< of points without a value
    float darkest = 0.25f; ///< coefficient 0 is between this and 1
};

/// Sum and weight of the values at a position: what is left out has no weight.
struct SlowValue {
    std::array<double, 27> sum{};
    double weight = 0;
    void Add(const SlowValue &other, double factor) {
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += factor * other.sum[i];
        weight += factor * other.weight;
    }
};

/// A tree with hanging bits where a larger cell touches a point that is not its corner.
class RandomTree {
  public:
    RandomTree(const TreeShape &shape, unsigned seed);

    const SparseGridTree &Tree() const { return tree_; }
    /// Replaces values, in the order of the tree's.
    void SetValues(const std::vector<bspGridPointSH_t> &values);
    /// Positions of the values, in smallest cells.
    const std::vector<Int3> &Places() const { return places_; }
    Int3 Bounds() const { return bounds_; }
    /// log2 of the edge of the cell that contains a smallest cell.
    int SizeAt(const Int3 &at) const;
    /// The blend at a position in smallest cells, of the cell that contains it, by the definition.
    SlowValue Blend(const std::array<double, 3> &at) const;

  private:
    void Divide(const Int3 &low, int level);
    void Number();
    std::size_t Index(const Int3 &at) const;
    bool IsHanging(const Int3 &at) const;
    SlowValue PointValue(const Int3 &at) const;
    SlowValue BlendIn(const Int3 &low, int size, const std::array<double, 3> &at) const;

    TreeShape shape_;
    std::mt19937 random_;
    Int3 bounds_{};
    std::vector<std::int8_t> sizes_; ///< of the cell that contains each smallest cell
    SparseGridTree tree_;
    std::vector<Int3> places_;
    std::map<Int3, std::size_t> stored_;
};

} // namespace q3::test
