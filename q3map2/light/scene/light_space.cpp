// GPL-2.0-or-later. Where a point is in the map.
#include "q3map2/light/scene/light_space.h"

#include "q3map2/light/scene/open_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

namespace q3 {

namespace {

/// The visibility lump begins with the number of clusters and the bytes of a row, both int32; then the rows, by
/// cluster, have a bit for each cluster.
constexpr std::size_t kVisHeaderBytes = 8, kVisRowBytesAt = 4;

} // namespace

BspSpace::BspSpace(const Bsp &bsp, const std::vector<bool> &opaqueBrush) : bsp_(bsp), tree_(bsp) {
    opaqueFirst_.reserve(bsp.leafs.size() + 1);
    opaqueFirst_.push_back(0);
    for (const bspLeaf_t &leaf : bsp.leafs) {
        clusterCount_ = std::max(clusterCount_, leaf.cluster + 1);
        for (int k = 0; k < leaf.numBSPLeafBrushes; ++k) {
            const int brush = bsp.leafBrushes[std::size_t(leaf.firstBSPLeafBrush + k)];
            if (opaqueBrush[std::size_t(brush)] && bsp.brushes[std::size_t(brush)].numSides > 0)
                opaqueBrushes_.push_back(brush);
        }
        opaqueFirst_.push_back(std::uint32_t(opaqueBrushes_.size()));
    }
    if (bsp.visibility.size() > kVisHeaderBytes)
        std::memcpy(&visRowBytes_, bsp.visibility.data() + kVisRowBytesAt, sizeof visRowBytes_);
}

/// Whether a single opaque brush of the leaf, grown by epsilon, contains the box.
bool BspSpace::InsideBrush(std::size_t leaf, const Vec3f &center, const Vec3f &half, float epsilon) const {
    for (std::uint32_t i = opaqueFirst_[leaf]; i < opaqueFirst_[leaf + 1]; ++i) {
        const bspBrush_t &brush = bsp_.brushes[std::size_t(opaqueBrushes_[i])];
        bool inside = true;
        for (int s = 0; s < brush.numSides && inside; ++s) {
            const bspPlane_t &plane =
                bsp_.planes[std::size_t(bsp_.brushSides[std::size_t(brush.firstSide + s)].planeNum)];
            const Vec3f n(plane.normal);
            const float reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
            inside = Dot(n, center) - plane.dist + reach <= epsilon;
        }
        if (inside)
            return true;
    }
    return false;
}

/// Whether an opaque brush fills the part of the box that is in the leaf, by the leaf's bounds.
bool BspSpace::FilledByBrush(std::size_t leafNum, const Boundsf &box, float epsilon) const {
    if (opaqueFirst_[leafNum] == opaqueFirst_[leafNum + 1])
        return false;
    // Points within kOnPlane of a leaf may count as in it.
    const bspLeaf_t &leaf = bsp_.leafs[leafNum];
    const Vec3f onPlane{kOnPlane, kOnPlane, kOnPlane};
    const Vec3f mins = Max(box.mins, Vec3f{float(leaf.mins[0]), float(leaf.mins[1]), float(leaf.mins[2])} - onPlane);
    const Vec3f maxs = Min(box.maxs, Vec3f{float(leaf.maxs[0]), float(leaf.maxs[1]), float(leaf.maxs[2])} + onPlane);
    return InsideBrush(leafNum, (mins + maxs) * 0.5f, (maxs - mins) * 0.5f, epsilon);
}

bool BspSpace::Visible(int a, int b) const {
    if (a < 0 || b < 0)
        return false;
    if (a == b || visRowBytes_ == 0)
        return true;
    const std::size_t at = kVisHeaderBytes + std::size_t(a) * std::size_t(visRowBytes_) + std::size_t(b >> 3);
    return at < bsp_.visibility.size() && (bsp_.visibility[at] & (1 << (b & 7))) != 0;
}

void BspSpace::ClustersOf(const Winding<float> &w, std::vector<int> &clusters) const {
    TreeWalk<float> tree(bsp_);
    tree.Walk(
        RootOf(bsp_), w, kOnPlane, [](const bspPlane_t &) { return CoplanarSide::Both; },
        [&](const Winding<float> &, std::size_t leaf) {
            const int cluster = bsp_.leafs[leaf].cluster;
            if (cluster >= 0 && std::find(clusters.begin(), clusters.end(), cluster) == clusters.end())
                clusters.push_back(cluster);
            return true;
        });
}

int BspSpace::ClusterAt(const Vec3f &p, float epsilon) const {
    const int leaf = tree_.LeafAt(p), cluster = tree_.ClusterOf(leaf);
    return cluster < 0 || InsideBrush(std::size_t(leaf), p, {}, epsilon) ? kSolidCluster : cluster;
}

bool BspSpace::InSolidLeaf(const Vec3f &p) const {
    return tree_.ClusterOf(tree_.LeafAt(p)) < 0;
}

bool BspSpace::AnyOpen(const Vec3f &mins, const Vec3f &maxs, float epsilon) const {
    return Touches(mins, maxs, [&](std::size_t leaf) {
        return tree_.ClusterOf(int(leaf)) >= 0 && !FilledByBrush(leaf, {mins, maxs}, epsilon);
    });
}

bool BspSpace::AnySolid(const Vec3f &mins, const Vec3f &maxs) const {
    return Touches(mins, maxs, [&](std::size_t leaf) { return tree_.ClusterOf(int(leaf)) < 0; });
}

/// Whether the box touches a leaf for which `wanted` is true.
template <typename Leaf> bool BspSpace::Touches(const Vec3f &mins, const Vec3f &maxs, const Leaf &wanted) const {
    const Vec3f center = (mins + maxs) * 0.5f, half = (maxs - mins) * 0.5f;
    std::array<BspChild, 32> pending;
    std::vector<BspChild> more; // overflow of `pending`
    std::size_t waiting = 0;
    BspChild child = tree_.Root();
    for (;;) {
        if (child < 0) {
            if (wanted(std::size_t(LeafOf(child))))
                return true;
            if (waiting == 0)
                return false;
            if (more.empty())
                child = pending[--waiting];
            else {
                child = more.back();
                more.pop_back();
            }
            continue;
        }
        const BspTree::Node &node = tree_.NodeOf(child);
        const Vec3f &n = node.normal;
        const float d = Dot(n, center) - node.dist;
        const float reach = std::abs(n.x) * half.x + std::abs(n.y) * half.y + std::abs(n.z) * half.z;
        // Branches rather than conditional moves, as in BspTree::LeafAt.
        if (d < -reach)
            child = node.children[1];
        else {
            if (!(d > reach)) {
                if (waiting < pending.size())
                    pending[waiting++] = node.children[1];
                else
                    more.push_back(node.children[1]);
            }
            child = node.children[0];
        }
    }
}

Boundsf BspSpace::VisibleBounds(int cluster) const {
    Boundsf bounds;
    for (const bspLeaf_t &leaf : bsp_.leafs) {
        if (!Visible(cluster, leaf.cluster))
            continue;
        bounds.Add({float(leaf.mins[0]), float(leaf.mins[1]), float(leaf.mins[2])});
        bounds.Add({float(leaf.maxs[0]), float(leaf.maxs[1]), float(leaf.maxs[2])});
    }
    return bounds;
}

} // namespace q3
