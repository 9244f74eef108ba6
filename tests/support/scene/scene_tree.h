// GPL-2.0-or-later. The tree of a scene: space split by the planes of solid boxes. Internal to the folder.
#pragma once

#include "libs/math/vec.h"

#include <array>
#include <cstddef>
#include <vector>

namespace q3 {

struct SceneTreeNode {
    std::size_t axis = 0; ///< the plane is where this coordinate is `dist`; its front is the greater side
    float dist = 0;
    std::array<int, 2> children{}; ///< [0] front, [1] back; >= 0 a node, else leaf -1 - child
    Boundsf region;
};

struct SceneTreeLeaf {
    Boundsf region;
    bool solid = false;
};

/// Numbered depth first, child 0 first; leaf 0 is a dummy that no node refers to.
struct SceneTree {
    std::vector<SceneTreeNode> nodes;
    std::vector<SceneTreeLeaf> leafs;
};

/// Solid is everything outside `interior`, and the boxes inside it. `outer` bounds the whole tree.
SceneTree BuildSceneTree(const Boundsf &interior, const Boundsf &outer, const std::vector<Boundsf> &solids);

/// Whether the interiors of two boxes intersect.
bool Overlap(const Boundsf &a, const Boundsf &b);

} // namespace q3
