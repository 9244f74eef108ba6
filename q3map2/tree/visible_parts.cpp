// GPL-2.0-or-later. Brush sides whose visible parts lie apart.
#include "q3map2/tree/visible_parts.h"

#include "q3map2/tree/visible_hulls.h"

#include <algorithm>
#include <numeric>

namespace q3 {

namespace {

constexpr double kPartEpsilon = 0.1;
/// Polygons this near to each other touch. Game units.
constexpr double kTouching = 0.2;
/// A wall covers what it contains this far in front of a side. Game units.
constexpr float kInFront = 0.25f;

/// An opaque solid of which something is drawn, so that it is no hull behind other things.
bool IsWall(const Brush &brush) {
    return brush.detail && brush.opaque && (brush.compileFlags & C_SOLID) != 0 &&
           (brush.compileFlags & (C_FOG | C_LIQUID)) == 0 &&
           std::any_of(brush.sides.begin(), brush.sides.end(), [](const BrushSide &side) {
               return side.shader && !side.winding.empty() && (side.compileFlags & C_NODRAW) == 0;
           });
}

bool MayBeParted(const BrushSide &side) {
    return side.shader && !side.culled && (side.compileFlags & (C_NODRAW | C_FOG | C_SKY | C_TRANSLUCENT)) == 0 &&
           !side.shader->autosprite && !side.shader->geometry.noClip && !side.shader->geometry.indexed;
}

bool BoxesTouch(const Boundsf &a, const Boundsf &b, float reach) {
    for (std::size_t i = 0; i < 3; ++i)
        if (a.mins[i] > b.maxs[i] + reach || b.mins[i] > a.maxs[i] + reach)
            return false;
    return true;
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

/// Points are clockwise seen from the tip of the normal. False if some line parallel to an edge runs between.
bool Touch(const Polygon &a, const Polygon &b, const Vec3d &normal) {
    return BoxesTouch(WindingBounds(a), WindingBounds(b), float(kTouching)) && !EdgeSeparates(a, b, normal) &&
           !EdgeSeparates(b, a, normal);
}

/// The number of its connected part for each polygon.
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

/// Takes what detail walls stand on out of the pieces.
void VisibleParts::CutOutDetail(const Brush &own, const BrushSide &side, std::vector<Polygon> &pieces) const {
    const Boundsf box = WindingBounds(side.winding);
    const Vec3f up = Vec3f(planes_[side.planeNum].normal) * kInFront;
    for (const Brush *wall : walls_) {
        if (wall->bounds.mins.x > box.maxs.x + 1)
            break;
        if (wall == &own || !BoxesTouch(wall->bounds, box, 1))
            continue;
        std::vector<Polygon> rest;
        for (Polygon &piece : pieces) {
            for (Vec3f &p : piece)
                p += up;
            std::vector<Polygon> outside;
            Polygon inside = piece, front, back;
            for (const BrushSide &face : wall->sides) {
                if (inside.empty() || face.bevel || face.winding.empty())
                    continue;
                front.clear(), back.clear();
                ClipPolygon(inside, planes_[face.planeNum], kPartEpsilon, front, back);
                if (!front.empty())
                    outside.push_back(front);
                inside = back;
            }
            if (inside.empty())
                outside.assign(1, piece); // the wall is elsewhere
            for (Polygon &one : outside) {
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
