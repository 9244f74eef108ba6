// GPL-2.0-or-later. The closed surface of everything solid, from the BSP tree.
#include "q3map2/light/light_space.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Half edge of the polygon that a node's plane starts from. Game units; engines' worlds end at 131072.
constexpr double kWorldHalfSize = 262144;
/// Corners within this distance of a plane count as on it. Game units; below the 1/8 that editors snap to.
constexpr double kClipEpsilon = 0.01;
/// Polygons grow by this much in their plane, so that rays cannot pass between them. Game units; a quarter of what
/// points of the grid keep clear of solids.
constexpr double kOverlap = 0.03;
/// Smaller polygons are rounding noise. Square units.
constexpr double kMinArea = 0.01;

Plane PlaneOf(const Bsp &bsp, const bspNode_t &node) {
    const bspPlane_t &plane = bsp.planes[std::size_t(node.planeNum)];
    return {Vec3d(plane.normal), double(plane.dist)};
}

struct Fragment {
    int child;
    Winding<double> w;
};

/// Cuts w by the subtree below `child` and calls visit(piece, leaf) for the piece in each leaf.
template <typename Visit>
void ForEachLeaf(const Bsp &bsp, int child, Winding<double> w, double epsilon, const Visit &visit) {
    std::vector<Fragment> stack;
    stack.push_back({child, std::move(w)});
    Winding<double> front, back;
    while (!stack.empty()) {
        Fragment fragment = std::move(stack.back());
        stack.pop_back();
        if (fragment.child < 0) {
            visit(std::move(fragment.w), std::size_t(-1 - fragment.child));
            continue;
        }
        const bspNode_t &node = bsp.nodes[std::size_t(fragment.child)];
        const Plane plane = PlaneOf(bsp, node);
        SplitWinding(fragment.w, plane.normal, plane.dist, epsilon, front, back);
        if (!front.empty())
            stack.push_back({node.children[0], front});
        if (!back.empty())
            stack.push_back({node.children[1], back});
    }
}

/// Cuts w by the tree and calls visit(points, leaf) for the piece in each leaf, until it returns false; so does the
/// function. Pieces in a node's plane go to the child that side(plane) says.
template <typename Side, typename Visit>
bool Walk(const Bsp &bsp, const Winding<double> &w, double epsilon, const Side &side, const Visit &visit) {
    std::vector<Fragment> stack;
    stack.push_back({bsp.nodes.empty() ? -1 : 0, w});
    while (!stack.empty()) {
        Fragment fragment = std::move(stack.back());
        stack.pop_back();
        while (fragment.child >= 0) {
            const bspNode_t &node = bsp.nodes[std::size_t(fragment.child)];
            const Plane plane = PlaneOf(bsp, node);
            bool anyFront = false, anyBack = false;
            for (const Vec3d &p : fragment.w) {
                const double d = plane.Distance(p);
                anyFront |= d > epsilon, anyBack |= d < -epsilon;
            }
            if (!anyFront || !anyBack) {
                fragment.child = node.children[anyFront ? 0 : anyBack ? 1 : side(plane)];
                continue;
            }
            Winding<double> front, back;
            SplitWinding(fragment.w, plane.normal, plane.dist, epsilon, front, back);
            if (!front.empty() && !back.empty())
                stack.push_back({node.children[0], std::move(front)});
            fragment.child = node.children[back.empty() ? 0 : 1];
            fragment.w = std::move(back.empty() ? front : back);
        }
        if (!fragment.w.empty() && !visit(fragment.w.size(), std::size_t(-1 - fragment.child)))
            return false;
    }
    return true;
}

void Grow(Winding<double> &w) {
    const Vec3d normal = Normalize(WindingAreaVector(w));
    Winding<double> grown = w;
    const auto outward = [&](std::size_t i) { return Normalize(Cross(w[(i + 1) % w.size()] - w[i], normal)); };
    for (std::size_t i = 0; i < w.size(); ++i)
        grown[i] += (outward(i) + outward((i + w.size() - 1) % w.size())) * kOverlap;
    w = std::move(grown);
}

} // namespace

std::vector<bool> SolidLeafs(const Bsp &bsp) {
    std::vector<bool> solid(bsp.leafs.size());
    for (std::size_t i = 0; i < solid.size(); ++i)
        solid[i] = bsp.leafs[i].cluster < 0;
    return solid;
}

void CountTriangles(const Bsp &bsp, const Winding<double> &w, double epsilon, std::vector<int> &counts) {
    const Vec3d facing = -WindingAreaVector(w); // clockwise seen from the front
    Walk(
        bsp, w, epsilon, [&](const Plane &plane) { return Dot(facing, plane.normal) > 0 ? 0 : 1; },
        [&](std::size_t points, std::size_t leaf) {
            counts[leaf] += int(points) - 2;
            return true;
        });
}

bool SolidBehind(const Bsp &bsp, const Winding<double> &w, const std::vector<bool> &solidLeafs,
                 const std::vector<bool> &others, bool &othersToo) {
    const Vec3d facing = -WindingAreaVector(w);
    othersToo = true;
    return Walk(
        bsp, w, kClipEpsilon, [&](const Plane &plane) { return Dot(facing, plane.normal) > 0 ? 1 : 0; },
        [&](std::size_t, std::size_t leaf) {
            othersToo = othersToo && others[leaf];
            return bool(solidLeafs[leaf]);
        });
}

void SolidHulls(const Bsp &bsp, std::span<SolidHull> hulls) {
    if (bsp.nodes.empty())
        return;
    std::vector<int> parents(bsp.nodes.size(), -1);
    for (std::size_t i = 0; i < bsp.nodes.size(); ++i)
        for (const int child : bsp.nodes[i].children)
            if (child >= 0)
                parents[std::size_t(child)] = int(i);

    Winding<double> front, back;
    for (std::size_t i = 0; i < bsp.nodes.size(); ++i) {
        Winding<double> w = WindingInPlane(PlaneOf(bsp, bsp.nodes[i]), kWorldHalfSize);
        for (int child = int(i), up = parents[i]; up >= 0 && !w.empty(); child = up, up = parents[std::size_t(up)]) {
            const bspNode_t &node = bsp.nodes[std::size_t(up)];
            const Plane plane = PlaneOf(bsp, node);
            SplitWinding(w, plane.normal, plane.dist, kClipEpsilon, front, back);
            w = node.children[0] == child ? front : back;
        }
        if (w.empty())
            continue;
        const auto keep = [&](Winding<double> &piece, std::size_t frontLeaf, std::size_t backLeaf) {
            const auto between = [&](const SolidHull &hull) {
                return hull.solidLeafs[frontLeaf] != hull.solidLeafs[backLeaf];
            };
            if (std::none_of(hulls.begin(), hulls.end(), between) || WindingArea(piece) < kMinArea)
                return;
            Grow(piece);
            for (SolidHull &hull : hulls)
                if (between(hull))
                    hull.faces.push_back(piece);
        };
        const auto [inFront, inBack] = bsp.nodes[i].children;
        ForEachLeaf(bsp, inFront, std::move(w), kClipEpsilon, [&](Winding<double> piece, std::size_t frontLeaf) {
            ForEachLeaf(bsp, inBack, std::move(piece), kClipEpsilon,
                        [&](Winding<double> small, std::size_t backLeaf) { keep(small, frontLeaf, backLeaf); });
        });
    }
}

} // namespace q3
