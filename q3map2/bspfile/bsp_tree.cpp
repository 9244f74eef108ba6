// GPL-2.0-or-later. Point queries on the BSP tree.
#include "q3map2/bspfile/bsp_tree.h"

#include <array>

namespace q3 {

int LeafAt(const Bsp &bsp, const Vec3f &p) {
    if (bsp.nodes.empty())
        return 0;
    // Back children that wait for their turn: a leaf found through a front child counts unless it is solid.
    std::array<int, 64> pending;
    int depth = 0;
    int child = 0, firstLeaf = -1;
    for (;;) {
        while (child >= 0) {
            const bspNode_t &node = bsp.nodes[std::size_t(child)];
            const bspPlane_t &plane = bsp.planes[std::size_t(node.planeNum)];
            const float d = Dot(Vec3f(plane.normal), p) - plane.dist;
            if (d > kOnPlane)
                child = node.children[0];
            else if (d < -kOnPlane)
                child = node.children[1];
            else {
                if (depth < int(pending.size()))
                    pending[std::size_t(depth++)] = node.children[1];
                child = node.children[0];
            }
        }
        const int leaf = -1 - child;
        if (firstLeaf < 0)
            firstLeaf = leaf;
        if (bsp.leafs[std::size_t(leaf)].cluster != kSolidCluster)
            return leaf;
        if (depth == 0)
            return firstLeaf;
        child = pending[std::size_t(--depth)];
    }
}

} // namespace q3
