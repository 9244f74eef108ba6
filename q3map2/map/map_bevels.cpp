// GPL-2.0-or-later. Bevel planes of brushes: axial planes, and planes through slanted edges.
#include "q3map2/map/map_bevels.h"

#include <cmath>

namespace q3 {

namespace {

constexpr double kOnPlane = 0.1; ///< game units
constexpr double kHalf = 0.5;

/// Unit vector along `v`, with components rounded to float.
Vec3d StoredUnit(const Vec3d &v) {
    const Vec3d stored{Vec3f(v)};
    return Vec3d(Vec3f(stored * (1 / Length(stored))));
}

BrushSide BevelSide(int planeNum, const BrushSide &first) {
    BrushSide side;
    side.planeNum = planeNum;
    side.contentFlags = first.contentFlags;
    side.bevel = true;
    return side;
}

bool Touches(const BrushSide &side, const Plane &plane) {
    for (const Vec3f &p : side.winding)
        if (std::abs(plane.Distance(Vec3d(p))) < kOnPlane)
            return true;
    return false;
}

int AxialPlane(const Brush &brush, std::size_t axis, int direction, PlaneTable &planes, int snap) {
    Vec3d normal;
    normal[axis] = direction;
    double dist = direction > 0 ? double(brush.bounds.maxs[axis]) : -double(brush.bounds.mins[axis]);
    if (snap > 0)
        dist = direction > 0 ? std::floor(dist / snap) * snap : -std::ceil(-dist / snap) * snap;
    return planes.Find(normal, dist);
}

/// Sides 0 to 5 become -x +x -y +y -z +z.
void AddAxialBevels(Brush &brush, PlaneTable &planes, int snap, std::uint32_t inheritedFlags) {
    std::vector<BrushSide> &sides = brush.sides;
    for (std::size_t order = 0; order < 6; ++order) {
        const std::size_t axis = order / 2;
        const int direction = order % 2 == 0 ? -1 : 1;
        std::size_t found = 0;
        while (found < sides.size() && planes[sides[found].planeNum].normal[axis] != direction)
            ++found;
        if (found == sides.size()) {
            BrushSide bevel = BevelSide(AxialPlane(brush, axis, direction, planes, snap), sides.front());
            for (const BrushSide &side : sides)
                if (Touches(side, planes[bevel.planeNum]))
                    bevel.surfaceFlags |= side.surfaceFlags & inheritedFlags;
            sides.push_back(std::move(bevel));
        }
        if (found != order && order < sides.size())
            std::swap(sides[order], sides[found]);
    }
}

/// Unit vector along the edge; zero if the edge is too short or along an axis.
Vec3d SlantedEdge(const Vec3f &from, const Vec3f &to, const PlaneTable &planes) {
    Vec3d edge = Vec3d(from) - Vec3d(to);
    if (Length(edge) < kHalf)
        return {};
    edge = StoredUnit(edge);
    planes.SnapNormal(edge);
    const int zeros = (edge.x == 0) + (edge.y == 0) + (edge.z == 0);
    const bool axial = std::abs(edge.x) == 1 || std::abs(edge.y) == 1 || std::abs(edge.z) == 1;
    return axial || zeros >= 2 ? Vec3d{} : edge;
}

enum class Fit { New, OnBevel, Rejected };

/// New: the whole brush is behind the plane, and no side has this plane. OnBevel: side `match` is a bevel with it.
Fit FitPlane(const Brush &brush, const Plane &plane, const PlaneTable &planes, std::size_t &match) {
    for (std::size_t i = 0; i < brush.sides.size(); ++i) {
        const BrushSide &side = brush.sides[i];
        if (planes.Equal(side.planeNum, plane.normal, plane.dist)) {
            match = i;
            return side.bevel ? Fit::OnBevel : Fit::Rejected;
        }
        if (side.winding.empty())
            continue;
        double behind = 0;
        for (const Vec3f &p : side.winding) {
            const double distance = plane.Distance(Vec3d(p));
            if (distance > kOnPlane)
                return Fit::Rejected;
            behind = std::min(behind, distance);
        }
        if (behind > -kOnPlane)
            return Fit::Rejected;
    }
    return Fit::New;
}

void TryEdgeBevel(Brush &brush, std::size_t from, const Vec3f &point, const Vec3d &edge, const Vec3d &axis,
                  PlaneTable &planes, std::uint32_t inheritedFlags) {
    Vec3d normal = Cross(edge, axis);
    if (Length(normal) < kHalf)
        return;
    normal = StoredUnit(normal);
    const Vec3d p(point);
    const Plane plane{normal, double(Dot(point, Vec3f(normal)))};
    const std::uint32_t flags = brush.sides[from].surfaceFlags & inheritedFlags;
    std::size_t match = 0;
    const Fit fit = FitPlane(brush, plane, planes, match);
    if (fit == Fit::OnBevel)
        brush.sides[match].surfaceFlags |= flags;
    if (fit != Fit::New)
        return;
    const int number = planes.Find(plane.normal, plane.dist, std::array{p});
    if (number < 0)
        return;
    brush.sides.push_back(BevelSide(number, brush.sides.front()));
    brush.sides.back().surfaceFlags = flags;
}

} // namespace

void AddBrushBevels(Brush &brush, PlaneTable &planes, int snap, std::uint32_t inheritedFlags) {
    AddAxialBevels(brush, planes, snap, inheritedFlags);
    if (brush.sides.size() == 6)
        return;
    for (std::size_t i = 6; i < brush.sides.size(); ++i) {
        const Polygon winding = brush.sides[i].winding;
        for (std::size_t j = 0; j < winding.size(); ++j) {
            const Vec3d edge = SlantedEdge(winding[j], winding[(j + 1) % winding.size()], planes);
            if (edge == Vec3d{})
                continue;
            for (std::size_t axis = 0; axis < 3; ++axis)
                for (const double direction : {-1.0, 1.0}) {
                    Vec3d along;
                    along[axis] = direction;
                    TryEdgeBevel(brush, i, winding[j], edge, along, planes, inheritedFlags);
                }
        }
    }
}

} // namespace q3
