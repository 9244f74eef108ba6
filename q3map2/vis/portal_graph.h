// GPL-2.0-or-later. The graph of leafs and directed portals, and its merging where unions are convex.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/bspfile/prtfile.h"
#include "q3map2/vis/vis_winding.h"

#include <string_view>
#include <vector>

namespace q3 {

/// A directed portal. Portal i of the file gives 2 i, from clusters[0] to clusters[1], and its twin 2 i + 1, back.
struct GraphPortal {
    Winding<float> winding;
    VisPlane plane; ///< normal into `leaf`
    Vec3f center;
    float radius = 0;
    int leaf = 0; ///< leaf to which the portal leads
    bool hint = false, sky = false;
    bool removed = false; ///< by MergeLeafs or MergePortals
    bool joined = false;  ///< merged with another portal, so its twin may have another winding

    /// Sets center (mean of the points) and radius from the winding.
    void UpdateBoundingSphere();
};

/// A solid polygon that bounds a leaf; its normal points out of the leaf.
struct GraphFace {
    Winding<float> winding;
    VisPlane plane;
};

/// A leaf of the graph: a cluster of the tree.
struct GraphLeaf {
    std::vector<int> portals; ///< portals out of it, in the order of the file
    std::vector<GraphFace> faces;
    int mergedInto = -1; ///< leaf into which this one was merged; -1: not merged
};

/// Leafs, and the portals that lead from one to another.
struct PortalGraph {
    std::vector<GraphPortal> portals;
    std::vector<GraphLeaf> leafs; ///< by cluster

    /// The leaf at the end of the chain of merges; the leaf itself if it was not merged.
    int Root(int leaf) const;
    /// Number of portals that are not removed, and number of hint portals among these.
    int ActivePortals() const;
    int HintPortals() const;
};

/// Throws Error for a winding without area. `name`: file name for messages.
PortalGraph BuildPortalGraph(const PortalFile &file, std::string_view name);

/// Merges neighboring leafs whose union is convex within 0.2 units until no such pair is left; with `keepHints` not
/// across hint portals. Returns the number of leafs that were merged into another.
int MergeLeafs(PortalGraph &graph, bool keepHints);

/// Numbers of pairs of portals that were merged, and of those that were both hint portals.
struct MergedPortals {
    int pairs = 0, hintPairs = 0;
};
/// Merges portals between the same two leafs whose union is a convex polygon.
MergedPortals MergePortals(PortalGraph &graph);

} // namespace q3
