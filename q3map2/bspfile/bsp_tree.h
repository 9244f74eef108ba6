// GPL-2.0-or-later. Point queries on the BSP tree.
#pragma once

#include "libs/math/vec.h"
#include "q3map2/bspfile/bspfile.h"

namespace q3 {

/// Points within this distance of a node's plane count as on both sides. Game units; spec of cluster lookup.
inline constexpr float kOnPlane = 0.1f;

/// Cluster of solid leafs.
inline constexpr int kSolidCluster = -1;

/// Number of the leaf that holds p in a validated Bsp. A point within kOnPlane of a plane belongs to the front, unless
/// the leaf found there is solid.
int LeafAt(const Bsp &bsp, const Vec3f &p);

} // namespace q3
