// GPL-2.0-or-later. Point queries on the BSP tree.
#pragma once

#include "libs/math/bounds.h"
#include "q3map2/bspfile/bspfile.h"

namespace q3 {

/// Points within this distance of a node's plane count as on both sides. Game units; spec of cluster lookup.
inline constexpr float kOnPlane = 0.1f;

/// Cluster of solid leafs.
inline constexpr int kSolidCluster = -1;

/// A child as nodes hold it: the number of a node, or -1 - the number of a leaf.
using BspChild = int;
inline int LeafOf(BspChild child) {
    return -1 - child;
}
/// The whole tree.
inline BspChild RootOf(const Bsp &bsp) {
    return bsp.nodes.empty() ? -1 : 0;
}

/// Number of the leaf that holds p in a validated Bsp. A point within kOnPlane of a plane belongs to the front, unless
/// the leaf found there is solid. `from`: where the search starts, see ChildAround.
int LeafAt(const Bsp &bsp, const Vec3f &p, BspChild from);
inline int LeafAt(const Bsp &bsp, const Vec3f &p) {
    return LeafAt(bsp, p, RootOf(bsp));
}

/// The lowest child under `from` that holds the box with some room: places in the box are found from it as from `from`.
BspChild ChildAround(const Bsp &bsp, const Boundsf &box, BspChild from);

} // namespace q3
