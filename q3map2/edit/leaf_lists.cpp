// GPL-2.0-or-later. Lists of surfaces and brushes in leafs, to which more are added.
#include "q3map2/edit/leaf_lists.h"

#include "q3map2/bspfile/bsp_tree.h"

#include <cmath>

namespace q3 {

namespace {

/// How far a box reaches beyond itself; game units.
constexpr double kRoom = 1;

} // namespace

LeafLists::LeafLists(const Bsp &bsp) : bsp_(bsp), surfaces_(bsp.leafs.size()), brushes_(bsp.leafs.size()) {
    for (std::size_t i = 0; i < bsp.leafs.size(); ++i) {
        const bspLeaf_t &leaf = bsp.leafs[i];
        const auto surfaces = bsp.leafSurfaces.begin() + leaf.firstBSPLeafSurface;
        const auto brushes = bsp.leafBrushes.begin() + leaf.firstBSPLeafBrush;
        surfaces_[i].assign(surfaces, surfaces + leaf.numBSPLeafSurfaces);
        brushes_[i].assign(brushes, brushes + leaf.numBSPLeafBrushes);
    }
}

std::vector<std::size_t> LeafLists::LeafsIn(const Boundsf &box) const {
    const Vec3d center = (Vec3d(box.mins) + Vec3d(box.maxs)) * 0.5, half = (Vec3d(box.maxs) - Vec3d(box.mins)) * 0.5;
    std::vector<std::size_t> leafs;
    std::vector<BspChild> open{RootOf(bsp_)};
    while (!open.empty()) {
        const BspChild child = open.back();
        open.pop_back();
        if (child < 0) {
            leafs.push_back(std::size_t(LeafOf(child)));
            continue;
        }
        const bspNode_t &node = bsp_.nodes[std::size_t(child)];
        const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
        const Vec3d normal(plane.normal);
        const double distance = Dot(normal, center) - double(plane.dist);
        const double reach =
            std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z + kRoom;
        if (distance > -reach)
            open.push_back(node.children[0]);
        if (distance < reach)
            open.push_back(node.children[1]);
    }
    return leafs;
}

void LeafLists::AddSurface(int number, const Boundsf &box) {
    if (box.Empty())
        return;
    for (const std::size_t leaf : LeafsIn(box))
        if (bsp_.leafs[leaf].cluster != kSolidCluster)
            surfaces_[leaf].push_back(number);
}

void LeafLists::AddBrush(int number, const Boundsf &box) {
    for (const std::size_t leaf : LeafsIn(box))
        brushes_[leaf].push_back(number);
}

void LeafLists::Store(Bsp &bsp) const {
    bsp.leafSurfaces.clear();
    bsp.leafBrushes.clear();
    for (std::size_t i = 0; i < bsp.leafs.size(); ++i) {
        bspLeaf_t &leaf = bsp.leafs[i];
        leaf.firstBSPLeafSurface = int(bsp.leafSurfaces.size());
        leaf.numBSPLeafSurfaces = int(surfaces_[i].size());
        leaf.firstBSPLeafBrush = int(bsp.leafBrushes.size());
        leaf.numBSPLeafBrushes = int(brushes_[i].size());
        bsp.leafSurfaces.insert(bsp.leafSurfaces.end(), surfaces_[i].begin(), surfaces_[i].end());
        bsp.leafBrushes.insert(bsp.leafBrushes.end(), brushes_[i].begin(), brushes_[i].end());
    }
}

} // namespace q3
