// GPL-2.0-or-later. Leafs and the portals between them, each way a portal of its own.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/bspfile/prtfile.h"
#include "q3map2/vis/vis_winding.h"

#include <string_view>
#include <vector>

namespace q3 {

/// A way from one leaf to another. Portal i of the file gives 2 i, from clusters[0] to clusters[1], and 2 i + 1 back.
struct GraphPortal {
    Winding<float> winding;
    VisPlane plane; ///< normal into `leaf`
    Vec3f centre;
    float radius = 0;
    int leaf = 0; ///< where it leads
    bool hint = false, sky = false;
    bool removed = false;
    bool joined = false; ///< has taken up another portal, so its twin may differ from it

    /// Centre and radius from the winding.
    void MakeSphere();
};

/// A polygon that bounds a leaf and cannot be passed. Normal out of its leaf.
struct GraphFace {
    Winding<float> winding;
    VisPlane plane;
};

struct GraphLeaf {
    std::vector<int> portals; ///< that lead out of it, in the order of the file
    std::vector<GraphFace> faces;
    int mergedInto = -1; ///< leaf; -1: still one of its own
};

struct PortalGraph {
    std::vector<GraphPortal> portals;
    std::vector<GraphLeaf> leafs; ///< by cluster

    /// The leaf that a leaf has become part of in the end.
    int Root(int leaf) const;
    /// Portals not removed, and those of them with the hint flag.
    int ActivePortals() const;
    int HintPortals() const;
};

/// Error: a winding without area. `name` is for messages.
PortalGraph BuildPortalGraph(const PortalFile &file, std::string_view name);

/// Merges leafs whose union is convex within 0.2 units, until none is left; with `keepHints` not through hint portals.
/// Returns how many leafs became part of another.
int MergeLeafs(PortalGraph &graph, bool keepHints);

struct MergedPortals {
    int pairs = 0, hintPairs = 0;
};
/// Joins portals that lead from one leaf to one other and make a convex polygon together.
MergedPortals MergePortals(PortalGraph &graph);

} // namespace q3
