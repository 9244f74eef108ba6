// GPL-2.0-or-later. Brush sides whose visible parts lie apart.
#include "q3map2/tree/visible_parts.h"

#include "q3map2/tree/visible_hulls.h"

#include <algorithm>
#include <numeric>

namespace q3 {

namespace {

/// Corners this near to a plane are on it. Game units.
constexpr double kPartEpsilon = 0.1;
/// Polygons this near to each other touch. Game units.
constexpr double kTouching = 0.2;
/// A wall covers the part of a side over which it is at this height. Game units.
constexpr float kCoverHeight = 0.25f;

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

/// Whether an edge of a separates polygons of one plane by more than kTouching.
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

/// Cuts out of the pieces what detail walls cover.
void VisibleParts::CutOutDetail(const Brush &own, const BrushSide &side, std::vector<Polygon> &pieces) const {
    const Boundsf box = WindingBounds(side.winding);
    const Vec3f up = Vec3f(planes_[side.planeNum].normal) * kCoverHeight;
    for (const Brush *wall : walls_) {
        if (wall->bounds.mins.x > box.maxs.x + 1)
            break;
        if (wall == &own || !wall->bounds.Touches(box, 1))
            continue;
        std::vector<Polygon> rest;
        for (Polygon &piece : pieces) {
            for (Vec3f &p : piece)
                p += up;
            for (Polygon &one : OutsideOf(*wall, piece)) {
                for (Vec3f &p : one)
                    p -= up;
                rest.push_back(std::move(one));
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
