// GPL-2.0-or-later. Which parts of brush sides are drawn: not those that other brushes cover, nor those outside.
#include "q3map2/tree/visible_sides.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace q3 {

// ---- Culls brush sides that other brushes cover ----

namespace {

constexpr double kOnPlane = 0.1;     ///< tolerance of points in a plane, game units
constexpr double kSamePoint = 0.001; ///< tolerance of the first two points of coincident sides; kOnPlane for others

/// Numbers of sides that were culled.
struct Culled {
    int hidden = 0, coincident = 0;
};

/// Whether the side can be culled. Autosprites and polygonOffset surfaces stay visible on coincident sides.
bool MayBeCulled(const BrushSide &side) {
    return side.shader && !side.shader->autosprite && !side.shader->geometry.polygonOffset;
}

/// Whether brush `other` hides the side, which then lies in or on it.
bool IsHidden(const BrushSide &side, const Brush &other, const PlaneTable &planes) {
    const Vec3d normal = planes[side.planeNum].normal;
    for (const BrushSide &cover : other.sides) {
        if (cover.compileFlags & C_NODRAW)
            return false;
        const Plane &plane = planes[cover.planeNum];
        bool isInPlane = true;
        for (const Vec3f &p : side.winding) {
            const double d = plane.Distance(Vec3d(p));
            if (d > kOnPlane)
                return false;
            isInPlane = isInPlane && d >= -kOnPlane;
        }
        // A culled side in the same plane is not drawn in place of this one.
        if (isInPlane && cover.culled && Dot(normal, plane.normal) > 0)
            return false;
    }
    return true;
}

void CullHidden(Brush &brush, const Brush &other, const PlaneTable &planes, Culled &culled) {
    if (other.compileFlags & C_TRANSLUCENT)
        return;
    for (BrushSide &side : brush.sides)
        if (!side.winding.empty() && !side.culled && MayBeCulled(side) && IsHidden(side, other, planes))
            side.culled = true, culled.hidden++;
}

bool Near(const Vec3f &a, const Vec3f &b, double epsilon) {
    for (std::size_t axis = 0; axis < 3; axis++)
        if (std::abs(double(a[axis]) - double(b[axis])) > epsilon)
            return false;
    return true;
}

/// Whether two polygons with the same number of points have the same points, in either order.
bool SamePoints(const Polygon &a, const Polygon &b) {
    const std::size_t count = a.size();
    for (std::size_t k = 0; k < count; k++) {
        if (!Near(a[0], b[k], kSamePoint))
            continue;
        std::size_t step = 0;
        if (Near(a[1], b[(k + 1) % count], kSamePoint))
            step = 1;
        else if (Near(a[1], b[(k + count - 1) % count], kSamePoint))
            step = count - 1;
        else
            return false;
        for (std::size_t i = 2; i < count; i++)
            if (!Near(a[i], b[(k + i * step) % count], kOnPlane))
                return false;
        return true;
    }
    return false;
}

bool Coincide(const BrushSide &a, const BrushSide &b) {
    return EvenPlane(a.planeNum) == EvenPlane(b.planeNum) && a.winding.size() == b.winding.size() &&
           !a.winding.empty() && !(a.culled && b.culled) && MayBeCulled(a) && MayBeCulled(b) &&
           SamePoints(a.winding, b.winding);
}

/// Whether the side hides a side that coincides with it.
bool HidesCoincident(const BrushSide &side) {
    return !side.culled && !(side.compileFlags & (C_TRANSLUCENT | C_NODRAW));
}

void CullCoincident(Brush &a, Brush &b, Culled &culled) {
    for (BrushSide &first : a.sides)
        for (BrushSide &second : b.sides) {
            if (!Coincide(first, second))
                continue;
            if (HidesCoincident(second))
                first.culled = true, culled.coincident++;
            if (first.planeNum == second.planeNum && first.culled) // of two that face the same way one stays
                continue;
            if (HidesCoincident(first))
                second.culled = true, culled.coincident++;
        }
}

/// Pairs (i, j), i < j, of brushes whose boxes touch, in order.
std::vector<std::pair<int, int>> TouchingPairs(const std::deque<Brush> &brushes) {
    std::vector<int> order(brushes.size());
    for (std::size_t i = 0; i < order.size(); i++)
        order[i] = int(i);
    const auto box = [&](int i) -> const Boundsf & { return brushes[std::size_t(i)].bounds; };
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return box(a).mins.x < box(b).mins.x; });
    std::vector<std::pair<int, int>> pairs;
    for (std::size_t i = 0; i < order.size(); i++)
        for (std::size_t j = i + 1; j < order.size() && box(order[j]).mins.x <= box(order[i]).maxs.x; j++) {
            const Boundsf &a = box(order[i]), &b = box(order[j]);
            if (a.mins.y <= b.maxs.y && b.mins.y <= a.maxs.y && a.mins.z <= b.maxs.z && b.mins.z <= a.maxs.z)
                pairs.emplace_back(std::min(order[i], order[j]), std::max(order[i], order[j]));
        }
    std::sort(pairs.begin(), pairs.end());
    return pairs;
}

} // namespace

void CullSides(MapEntity &entity, const PlaneTable &planes, const BspContext &context) {
    context.log.VerboseSection("CullSides");
    Culled culled;
    for (const auto &[first, second] : TouchingPairs(entity.brushes)) {
        Brush &a = entity.brushes[std::size_t(first)], &b = entity.brushes[std::size_t(second)];
        CullHidden(a, b, planes, culled);
        CullHidden(b, a, planes, culled);
        CullCoincident(a, b, culled);
    }
    context.log.VerboseCount(culled.hidden, "hidden faces culled");
    context.log.VerboseCount(culled.coincident, "coincident faces culled");
}

// ---- Visible hulls of brush sides ----

namespace {

constexpr double kHullEpsilon = 0.1; ///< tolerance of points on a plane or an edge, game units

/// Extends the convex hull to hold `p`. Points are clockwise seen from the tip of `normal`.
void AddPoint(Polygon &hull, const Vec3f &p, const Vec3d &normal) {
    const std::size_t count = hull.size();
    std::vector<bool> seen(count);
    bool outside = false;
    for (std::size_t i = 0; i < count; i++) {
        const Vec3d from(hull[i]), edge = Normalize(Vec3d(hull[(i + 1) % count]) - from);
        const double d = Dot(Vec3d(p) - from, Cross(normal, edge));
        outside = outside || d >= kHullEpsilon;
        seen[i] = d >= -kHullEpsilon;
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
        if (EvenPlane(node.planeNum) == EvenPlane(side.planeNum)) {
            pending.emplace_back(node.children[node.planeNum == side.planeNum ? 0 : 1], std::move(piece));
            continue;
        }
        Polygon front, back;
        ClipPolygon(piece, planes[node.planeNum], kHullEpsilon, front, back);
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
    context.log.VerboseCount(parts.size(), "faces in several parts");
    return parts;
}

// ---- Brush sides whose visible parts lie apart ----

namespace {

/// Corners this near to a plane are on it. Game units.
constexpr double kPartEpsilon = 0.1;
/// Polygons this near to each other touch. Game units.
constexpr double kTouching = 0.2;
/// A wall covers the part of a side over which it is at this height. Game units.
constexpr float kCoverHeight = 0.25f;
/// Walls whose boxes are this far from that of a side cannot cover it: more than kCoverHeight and rounding. Game units.
constexpr float kFarFromSide = 1;

/// Whether the brush is an opaque solid with a side that is drawn: undrawn ones only block players or fill models.
bool IsWall(const Brush &brush) {
    return brush.detail && brush.opaque && (brush.compileFlags & C_SOLID) != 0 &&
           (brush.compileFlags & (C_FOG | C_LIQUID)) == 0 &&
           std::any_of(brush.sides.begin(), brush.sides.end(), [](const BrushSide &side) {
               return side.shader && !side.winding.empty() && (side.compileFlags & C_NODRAW) == 0;
           });
}

/// Whether the side can be drawn as several polygons without a change of its look.
bool MayBeParted(const BrushSide &side) {
    return side.shader && !side.culled && (side.compileFlags & (C_NODRAW | C_FOG | C_SKY | C_TRANSLUCENT)) == 0 &&
           !side.shader->autosprite && !side.shader->geometry.noClip && !side.shader->geometry.indexed;
}

/// Whether an edge of `a` separates polygons of one plane by more than kTouching.
bool EdgeSeparates(const Polygon &a, const Polygon &b, const Vec3d &normal) {
    for (std::size_t i = 0; i < a.size(); ++i) {
        const Vec3d from(a[i]), edge = Normalize(Vec3d(a[(i + 1) % a.size()]) - from), out = Cross(normal, edge);
        if (std::all_of(b.begin(), b.end(), [&](const Vec3f &p) { return Dot(Vec3d(p) - from, out) > kTouching; }))
            return true;
    }
    return false;
}

/// Whether two convex polygons of one plane touch: no edge of either separates them. Points are clockwise seen from the
/// tip of the normal.
bool Touch(const Polygon &a, const Polygon &b, const Vec3d &normal) {
    return WindingBounds(a).Touches(WindingBounds(b), float(kTouching)) && !EdgeSeparates(a, b, normal) &&
           !EdgeSeparates(b, a, normal);
}

/// By polygon: the number of the connected part that it belongs to.
std::vector<int> PartNumbers(const std::vector<Polygon> &pieces, const Vec3d &normal) {
    std::vector<int> part(pieces.size(), -1);
    std::vector<std::size_t> pending;
    int count = 0;
    for (std::size_t seed = 0; seed < pieces.size(); ++seed) {
        if (part[seed] >= 0)
            continue;
        part[seed] = count;
        pending.push_back(seed);
        while (!pending.empty()) {
            const std::size_t at = pending.back();
            pending.pop_back();
            for (std::size_t other = 0; other < pieces.size(); ++other)
                if (part[other] < 0 && Touch(pieces[at], pieces[other], normal))
                    part[other] = count, pending.push_back(other);
        }
        ++count;
    }
    return part;
}

} // namespace

VisibleParts::VisibleParts(const std::deque<Brush> &brushes, const PlaneTable &planes) : planes_(planes) {
    for (const Brush &brush : brushes)
        if (IsWall(brush))
            walls_.push_back(&brush);
    std::stable_sort(walls_.begin(), walls_.end(),
                     [](const Brush *a, const Brush *b) { return a->bounds.mins.x < b->bounds.mins.x; });
}

/// The convex parts of a polygon outside a brush; the polygon as it is if no part is inside.
std::vector<Polygon> VisibleParts::OutsideOf(const Brush &wall, const Polygon &polygon) const {
    std::vector<Polygon> outside;
    Polygon inside = polygon, front, back;
    for (const BrushSide &face : wall.sides) {
        if (inside.empty() || face.bevel || face.winding.empty())
            continue;
        front.clear(), back.clear();
        ClipPolygon(inside, planes_[face.planeNum], kPartEpsilon, front, back);
        if (!front.empty())
            outside.push_back(front);
        inside = back;
    }
    if (inside.empty())
        return {polygon};
    return outside;
}

/// Cuts out of the pieces of a side of `brush` what other detail walls cover.
void VisibleParts::CutOutDetail(const Brush &brush, const BrushSide &side, std::vector<Polygon> &pieces) const {
    const Boundsf box = WindingBounds(side.winding);
    const Vec3f up = Vec3f(planes_[side.planeNum].normal) * kCoverHeight;
    for (const Brush *wall : walls_) {
        if (wall->bounds.mins.x > box.maxs.x + kFarFromSide)
            break;
        if (wall == &brush || !wall->bounds.Touches(box, kFarFromSide))
            continue;
        std::vector<Polygon> rest;
        for (Polygon &piece : pieces) {
            for (Vec3f &p : piece)
                p += up;
            for (Polygon &uncovered : OutsideOf(*wall, piece)) {
                for (Vec3f &p : uncovered)
                    p -= up;
                rest.push_back(std::move(uncovered));
            }
        }
        pieces = std::move(rest);
    }
}

std::vector<Polygon> VisibleParts::Of(const Brush &brush, const BrushSide &side, std::vector<Polygon> pieces) const {
    if (pieces.empty() || !MayBeParted(side))
        return {};
    const Vec3d normal = planes_[side.planeNum].normal;
    CutOutDetail(brush, side, pieces);
    if (pieces.size() < 2)
        return {};
    const std::vector<int> numbers = PartNumbers(pieces, normal);
    std::vector<std::vector<Polygon>> groups;
    groups.resize(std::size_t(*std::max_element(numbers.begin(), numbers.end())) + 1);
    for (std::size_t i = 0; i < pieces.size(); ++i)
        groups[std::size_t(numbers[i])].push_back(std::move(pieces[i]));
    std::vector<Polygon> parts;
    for (std::vector<Polygon> &group : groups)
        parts.push_back(ConvexHull(std::move(group), normal));
    for (std::size_t i = 0; i < parts.size(); ++i)
        for (std::size_t j = i + 1; j < parts.size(); ++j)
            if (Touch(parts[i], parts[j], normal))
                return {};
    return parts.size() > 1 ? parts : std::vector<Polygon>{};
}

} // namespace q3
