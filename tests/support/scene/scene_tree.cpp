// GPL-2.0-or-later. The tree of a scene: space split by the planes of solid boxes.
#include "tests/support/scene/scene_tree.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace q3 {

namespace {

using Solids = std::vector<Boundsf>;

constexpr int kWallPlanes = 6;
constexpr std::ptrdiff_t kSplitCost = 4; ///< of each box cut in two, relative to an imbalance of one box

bool Inside(const Boundsf &region, const Boundsf &box) {
    return box.Contains(region.mins) && box.Contains(region.maxs);
}

Solids Touching(const Solids &solids, const Boundsf &region) {
    Solids kept;
    std::ranges::copy_if(solids, std::back_inserter(kept), [&](const Boundsf &box) { return Overlap(box, region); });
    return kept;
}

struct Plane {
    std::size_t axis = 0;
    float dist = 0;
};

std::ptrdiff_t Cost(const Solids &solids, const Plane &plane) {
    std::ptrdiff_t front = 0, back = 0, split = 0;
    for (const Boundsf &box : solids) {
        const bool ahead = box.maxs[plane.axis] > plane.dist, behind = box.mins[plane.axis] < plane.dist;
        front += ahead, back += behind, split += ahead && behind;
    }
    return std::abs(front - back) + kSplitCost * split;
}

// There always is one: a box that overlaps the region without filling it has a side strictly inside the region.
Plane Choose(const Solids &solids, const Boundsf &region) {
    Plane best;
    std::ptrdiff_t bestCost = -1;
    for (const Boundsf &box : solids)
        for (std::size_t axis = 0; axis < 3; axis++)
            for (const float dist : {box.mins[axis], box.maxs[axis]}) {
                if (dist <= region.mins[axis] || dist >= region.maxs[axis])
                    continue;
                const std::ptrdiff_t cost = Cost(solids, {axis, dist});
                if (bestCost < 0 || cost < bestCost)
                    best = {axis, dist}, bestCost = cost;
            }
    return best;
}

class TreeBuilder {
  public:
    explicit TreeBuilder(const Boundsf &interior) : interior_(interior) { tree_.leafs.emplace_back(); }

    /// Splits by the six planes of the room, then its interior.
    int AddRoom(int wall, const Boundsf &region, const Solids &solids) {
        if (wall == kWallPlanes)
            return AddRegion(region, solids);
        const Plane plane = WallPlane(wall);
        const bool openBehind = wall % 2 != 0;
        const std::size_t node = AddNode(plane, region);
        const auto [front, back] = Halves(region, plane);
        const int first = openBehind ? AddLeaf(front, Content::Solid) : AddRoom(wall + 1, front, solids);
        const int second = openBehind ? AddRoom(wall + 1, back, solids) : AddLeaf(back, Content::Solid);
        tree_.nodes[node].children = {first, second};
        return int(node);
    }

    SceneTree Take() { return std::move(tree_); }

  private:
    Plane WallPlane(int wall) const {
        const auto axis = std::size_t(wall / 2);
        return {axis, wall % 2 == 0 ? interior_.mins[axis] : interior_.maxs[axis]};
    }

    static std::pair<Boundsf, Boundsf> Halves(const Boundsf &region, const Plane &plane) {
        Boundsf front = region, back = region;
        front.mins[plane.axis] = back.maxs[plane.axis] = plane.dist;
        return {front, back};
    }

    int AddRegion(const Boundsf &region, const Solids &solids) {
        if (solids.empty())
            return AddLeaf(region, Content::Open);
        if (std::ranges::any_of(solids, [&](const Boundsf &box) { return Inside(region, box); }))
            return AddLeaf(region, Content::Solid);
        const Plane plane = Choose(solids, region);
        const std::size_t node = AddNode(plane, region);
        const auto [front, back] = Halves(region, plane);
        const int first = AddRegion(front, Touching(solids, front));
        const int second = AddRegion(back, Touching(solids, back));
        tree_.nodes[node].children = {first, second};
        return int(node);
    }

    std::size_t AddNode(const Plane &plane, const Boundsf &region) {
        tree_.nodes.push_back({plane.axis, plane.dist, {}, region});
        return tree_.nodes.size() - 1;
    }

    enum class Content { Open, Solid };
    int AddLeaf(const Boundsf &region, Content content) {
        tree_.leafs.push_back({region, content == Content::Solid});
        return -int(tree_.leafs.size());
    }

    const Boundsf &interior_;
    SceneTree tree_;
};

} // namespace

bool Overlap(const Boundsf &a, const Boundsf &b) {
    for (std::size_t axis = 0; axis < 3; axis++)
        if (a.mins[axis] >= b.maxs[axis] || b.mins[axis] >= a.maxs[axis])
            return false;
    return true;
}

SceneTree BuildSceneTree(const Boundsf &interior, const Boundsf &outer, const std::vector<Boundsf> &solids) {
    TreeBuilder builder(interior);
    builder.AddRoom(0, outer, Touching(solids, interior));
    return builder.Take();
}

} // namespace q3
