// GPL-2.0-or-later. Visible hulls of brush sides.
#include "q3map2/tree/visible_hulls.h"

#include "common/error.h"
#include "q3map2/tree/visible_parts.h"

#include <utility>

namespace q3 {

namespace {

constexpr double kEpsilon = 0.1;
constexpr std::size_t kMostPoints = 128;

/// Extends the convex hull to hold `p`. Points are clockwise seen from the tip of `normal`.
void AddPoint(Polygon &hull, const Vec3f &p, const Vec3d &normal) {
    const std::size_t count = hull.size();
    std::vector<bool> seen(count);
    bool outside = false;
    for (std::size_t i = 0; i < count; i++) {
        const Vec3d from(hull[i]), edge = Normalize(Vec3d(hull[(i + 1) % count]) - from);
        const double d = Dot(Vec3d(p) - from, Cross(normal, edge));
        outside = outside || d >= kEpsilon;
        seen[i] = d >= -kEpsilon;
    }
    if (!outside)
        return;
    std::size_t last = 0; // the edge before those that face p
    while (last < count && (seen[last] || !seen[(last + 1) % count]))
        last++;
    if (last == count)
        return;
    Polygon grown{p}; // `p` goes first: fans and T-junction repair depend on the first vertex
    for (std::size_t i = 1; i < count; i++) {
        const std::size_t edge = (last + i) % count, next = (edge + 1) % count;
        if (!(seen[edge] && seen[next]))
            grown.push_back(hull[next]);
    }
    grown.push_back(hull[(last + 1) % count]);
    if (grown.size() > kMostPoints)
        throw Error("the visible part of a brush side has more than {} corners", kMostPoints);
    hull = std::move(grown);
}

void AddPolygon(Polygon &hull, Polygon piece, const Vec3d &normal) {
    if (hull.empty()) {
        hull = std::move(piece);
        return;
    }
    for (const Vec3f &p : piece)
        AddPoint(hull, p, normal);
}

/// The parts of the side in open leafs.
std::vector<Polygon> VisiblePieces(const BrushSide &side, const Tree &tree, const PlaneTable &planes) {
    std::vector<Polygon> pieces;
    std::vector<std::pair<int, Polygon>> pending;
    pending.emplace_back(tree.head, side.winding);
    while (!pending.empty()) {
        auto [at, piece] = std::move(pending.back());
        pending.pop_back();
        const TreeNode &node = tree.nodes[std::size_t(at)];
        if (node.IsLeaf()) {
            if (!node.opaque)
                pieces.push_back(std::move(piece));
            continue;
        }
        if ((node.planeNum & ~1) == (side.planeNum & ~1)) {
            pending.emplace_back(node.children[node.planeNum == side.planeNum ? 0 : 1], std::move(piece));
            continue;
        }
        Polygon front, back;
        ClipPolygon(piece, planes[node.planeNum], kEpsilon, front, back);
        if (front.empty() && back.empty())
            front = back = std::move(piece);
        if (!back.empty())
            pending.emplace_back(node.children[1], std::move(back));
        if (!front.empty())
            pending.emplace_back(node.children[0], std::move(front));
    }
    return pieces;
}

} // namespace

Polygon ConvexHull(std::vector<Polygon> pieces, const Vec3d &normal) {
    Polygon hull;
    for (Polygon &piece : pieces)
        AddPolygon(hull, std::move(piece), normal);
    return hull;
}

SideParts ClipSidesIntoTree(MapEntity &entity, const Tree &tree, const PlaneTable &planes, const BspContext &context) {
    context.log.VerboseSection("ClipSidesIntoTree");
    const VisibleParts finder(entity.brushes, planes);
    SideParts parts;
    for (Brush &brush : entity.brushes)
        for (BrushSide &side : brush.sides) {
            side.visibleHull.clear();
            if (side.winding.empty())
                continue;
            std::vector<Polygon> pieces = VisiblePieces(side, tree, planes);
            side.visibleHull = ConvexHull(pieces, planes[side.planeNum].normal);
            if (auto found = finder.Of(brush, side, std::move(pieces)); !found.empty())
                parts.emplace(&side, std::move(found));
        }
    context.log.VerboseCount((long long)(parts.size()), "faces in several parts");
    return parts;
}

} // namespace q3
