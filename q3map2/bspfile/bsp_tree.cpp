// GPL-2.0-or-later. Point queries on the BSP tree.
#include "q3map2/bspfile/bsp_tree.h"

#include <array>
#include <cmath>

namespace q3 {

namespace {

/// Beyond kOnPlane, for rounding. Game units.
constexpr float kRoom = 0.1f;

} // namespace

int LeafAt(const Bsp &bsp, const Vec3f &p, BspChild from) {
    // Back children that wait for their turn: a leaf found through a front child counts unless it is solid.
    std::array<int, 64> pending;
    int depth = 0;
    int child = from, firstLeaf = -1;
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
        const int leaf = LeafOf(child);
        if (firstLeaf < 0)
            firstLeaf = leaf;
        if (bsp.leafs[std::size_t(leaf)].cluster != kSolidCluster)
            return leaf;
        if (depth == 0)
            return firstLeaf;
        child = pending[std::size_t(--depth)];
    }
}

BspChild ChildAround(const Bsp &bsp, const Boundsf &box, BspChild from) {
    const Vec3f center = box.Center(), half = (box.maxs - box.mins) * 0.5f;
    BspChild child = from;
    while (child >= 0) {
        const bspNode_t &node = bsp.nodes[std::size_t(child)];
        const bspPlane_t &plane = bsp.planes[std::size_t(node.planeNum)];
        const Vec3f n(plane.normal);
        const float d = Dot(n, center) - plane.dist;
        const float reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z + kOnPlane + kRoom;
        if (!(std::abs(d) > reach))
            break;
        child = node.children[d > 0 ? 0 : 1];
    }
    return child;
}

} // namespace q3
