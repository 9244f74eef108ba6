// GPL-2.0-or-later. Moving boxes against the brushes of a compiled map, as games move players.
#include "tools/measure/collision_compare/collision.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Plane distance expanded by the box, so that tracing a point replaces tracing the box.
double ExpandedDistance(const Boundsd &box, const Vec3d &normal, double dist) {
    const Vec3d corner{normal.x < 0 ? box.maxs.x : box.mins.x, normal.y < 0 ? box.maxs.y : box.mins.y,
                       normal.z < 0 ? box.maxs.z : box.mins.z};
    return dist - Dot(corner, normal);
}

} // namespace

/// Adds the numbers of all brushes in leafs that the box touches, without duplicates.
void CollisionMap::Gather(const Boundsd &swept, std::vector<int> &brushes) const {
    constexpr double kSlack = 1; // around the box, game units
    std::vector<int> stack{bsp_.nodes.empty() ? -1 : 0};
    while (!stack.empty()) {
        const int child = stack.back();
        stack.pop_back();
        if (child < 0) {
            const bspLeaf_t &leaf = bsp_.leafs[std::size_t(-1 - child)];
            const auto first = bsp_.leafBrushes.begin() + leaf.firstBSPLeafBrush;
            brushes.insert(brushes.end(), first, first + leaf.numBSPLeafBrushes);
            continue;
        }
        const bspNode_t &node = bsp_.nodes[std::size_t(child)];
        const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
        const Vec3d normal(plane.normal), half = (swept.maxs - swept.mins) * 0.5;
        const double distance = Dot(normal, swept.Center()) - double(plane.dist);
        const double reach =
            std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z + kSlack;
        if (distance > -reach)
            stack.push_back(node.children[0]);
        if (distance < reach)
            stack.push_back(node.children[1]);
    }
    std::sort(brushes.begin(), brushes.end());
    brushes.erase(std::unique(brushes.begin(), brushes.end()), brushes.end());
}

void CollisionMap::Clip(int number, const Boundsd &box, const Vec3d &start, const Vec3d &end, Hit &hit) const {
    const bspBrush_t &brush = bsp_.brushes[std::size_t(number)];
    double enter = -1, leave = 1; // fractions of the move; enter below 0: it starts behind all planes
    bool startsOut = false;
    Vec3d normal;
    for (int i = 0; i < brush.numSides; ++i) {
        const bspBrushSide_t &side = bsp_.brushSides[std::size_t(brush.firstSide + i)];
        const bspPlane_t &plane = bsp_.planes[std::size_t(side.planeNum)];
        const Vec3d n(plane.normal);
        const double dist = ExpandedDistance(box, n, double(plane.dist));
        const double from = Dot(n, start) - dist, to = Dot(n, end) - dist;
        startsOut = startsOut || from > 0;
        if (from > 0 && to > 0)
            return;
        if (from <= 0 && to <= 0)
            continue;
        if (from > to) {
            if (const double at = from / (from - to); at > enter)
                enter = at, normal = n;
        } else
            leave = std::min(leave, from / (from - to));
    }
    if (!startsOut) {
        hit.startsInside = true;
        hit.brush = number;
    } else if (enter >= 0 && enter < leave && enter < hit.fraction)
        hit.fraction = enter, hit.normal = normal, hit.brush = number;
}

CollisionMap::Hit CollisionMap::Move(const Boundsd &box, const Vec3d &start, const Vec3d &end,
                                     std::uint32_t contents) const {
    Boundsd swept;
    for (const Vec3d &p : {start, end})
        swept.Add({p + box.mins, p + box.maxs});
    std::vector<int> brushes;
    Gather(swept, brushes);
    Hit hit;
    for (const int brush : brushes) {
        const int shader = bsp_.brushes[std::size_t(brush)].shaderNum;
        if ((bsp_.shaders[std::size_t(shader)].contentFlags & contents) != 0)
            Clip(brush, box, start, end, hit);
    }
    return hit;
}

} // namespace q3
