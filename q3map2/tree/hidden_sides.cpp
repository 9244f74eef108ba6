// GPL-2.0-or-later. Culls brush sides that other brushes cover.
#include "q3map2/tree/hidden_sides.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace q3 {

namespace {

constexpr double kOnPlane = 0.1;     ///< also for further points of coincident sides; game units
constexpr double kSamePoint = 0.001; ///< for the first two points of coincident sides

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
        bool on = true;
        for (const Vec3f &p : side.winding) {
            const double d = plane.Distance(Vec3d(p));
            if (d > kOnPlane)
                return false;
            on = on && d >= -kOnPlane;
        }
        if (on && cover.culled && Dot(normal, plane.normal) > 0)
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
    return (a.planeNum & ~1) == (b.planeNum & ~1) && a.winding.size() == b.winding.size() && !a.winding.empty() &&
           !(a.culled && b.culled) && MayBeCulled(a) && MayBeCulled(b) && SamePoints(a.winding, b.winding);
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
            if (first.planeNum == second.planeNum && first.culled)
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

} // namespace q3
