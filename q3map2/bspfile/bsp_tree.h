// GPL-2.0-or-later. Point queries on the BSP tree.
#pragma once

#include "libs/math/bounds.h"
#include "q3map2/bspfile/bsp.h"

#include <array>
#include <vector>

namespace q3 {

/// Points within this distance of a node's plane count as on both sides. Game units.
inline constexpr float kOnPlane = 0.1f;

/// Cluster of solid leafs.
inline constexpr int kSolidCluster = -1;

/// A child of a node: the number of a node, or -1 - the number of a leaf.
using BspChild = int;
inline int LeafOf(BspChild child) {
    return -1 - child;
}
/// The root node, or leaf 0 in a map without nodes.
inline BspChild RootOf(const Bsp &bsp) {
    return bsp.nodes.empty() ? -1 : 0;
}

/// Number of the leaf that holds p in a validated Bsp. A point within kOnPlane of a plane belongs to the front, unless
/// the leaf found there is solid.
int LeafAt(const Bsp &bsp, const Vec3f &p);

/// Compact copy of the tree of a validated Bsp: planes, children and clusters only, to stay in CPU caches.
class BspTree {
  public:
    struct Node {
        Vec3f normal;
        float dist = 0;
        std::array<BspChild, 2> children{};
    };
    explicit BspTree(const Bsp &bsp);

    BspChild Root() const { return nodes_.empty() ? -1 : 0; }
    const Node &NodeOf(BspChild child) const { return nodes_[std::size_t(child)]; }
    int ClusterOf(int leaf) const { return clusters_[std::size_t(leaf)]; }
    /// As the free function LeafAt.
    int LeafAt(const Vec3f &p) const;

  private:
    std::vector<Node> nodes_;
    std::vector<int> clusters_; ///< by leaf
};

} // namespace q3
