// GPL-2.0-or-later. Windings, contents and bevel planes of brushes.
#include "q3map2/map/map_brush.h"

#include "common/error.h"

#include <algorithm>
#include <cmath>

namespace q3 {

// ---- Windings and contents of brushes ----

namespace {

constexpr double kWindingEpsilon = 0x1p-24; ///< game units; half the step of floats just above 1
/// Least determinant of the unit normals of three planes that meet in a point.
constexpr double kMinDeterminant = 1e-9;
/// Greatest distance of a corner in front of the other planes. Game units.
constexpr double kCornerMargin = 0.1;
constexpr double kShortEdge = 0.1; ///< game units: the ends of shorter edges are welded
/// Welded coordinates this near to an integer are rounded to it.
constexpr double kNearWhole = 0.01;
/// Triples of planes grow with the cube: brushes of more sides take their box from clipped polygons.
constexpr std::size_t kMaxTripleSides = 40;

const Plane &PlaneOfSide(const BrushSide &side, const PlaneTable &planes) {
    return side.hasPlane ? side.plane : planes[side.planeNum];
}

std::vector<Plane> PlanesWithoutBevels(const Brush &brush, const PlaneTable &planes) {
    std::vector<Plane> solid;
    for (const BrushSide &side : brush.sides)
        if (!side.bevel)
            solid.push_back(PlaneOfSide(side, planes));
    return solid;
}

/// Bounds of the intersections of three planes that no other plane cuts off.
Boundsd CornerBox(const std::vector<Plane> &planes) {
    Boundsd box;
    const std::size_t count = planes.size();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j) {
            const Vec3d cross = Cross(planes[i].normal, planes[j].normal);
            for (std::size_t k = j + 1; k < count; ++k) {
                const double determinant = Dot(cross, planes[k].normal);
                if (!(std::abs(determinant) >= kMinDeterminant))
                    continue;
                // Cramer's rule for n . p = d of the three planes.
                const Vec3d p = (Cross(planes[j].normal, planes[k].normal) * planes[i].dist +
                                 Cross(planes[k].normal, planes[i].normal) * planes[j].dist + cross * planes[k].dist) /
                                determinant;
                const auto keeps = [&](const Plane &plane) { return plane.Distance(p) < kCornerMargin; };
                if (std::ranges::all_of(planes, keeps))
                    box.Add(p);
            }
        }
    return box;
}

/// The plane's polygon over the box, projected along the dominant axis of the normal; clockwise from the front.
Winding<double> PolygonOverBox(const Plane &plane, const Boundsd &box) {
    std::size_t z = 0;
    for (std::size_t axis = 1; axis < 3; ++axis)
        if (std::abs(plane.normal[axis]) > std::abs(plane.normal[z]))
            z = axis;
    const std::size_t x = (z + 1) % 3, y = (z + 2) % 3;
    const auto corner = [&](double px, double py) {
        Vec3d p;
        p[x] = px, p[y] = py;
        p[z] = (plane.dist - plane.normal[x] * px - plane.normal[y] * py) / plane.normal[z];
        return p;
    };
    Winding<double> w{corner(box.maxs[x], box.maxs[y]), corner(box.maxs[x], box.mins[y]),
                      corner(box.mins[x], box.mins[y]), corner(box.mins[x], box.maxs[y])};
    if (plane.normal[z] <= 0)
        std::ranges::reverse(w);
    return w;
}

bool IsOpposite(const Plane &a, const Plane &b) {
    return a.dist == -b.dist && a.normal == -b.normal;
}

/// The part of a plane's polygon that is behind all others.
Winding<double> ChoppedPolygon(const std::vector<Plane> &planes, std::size_t self, const Boundsd &box) {
    Winding<double> w = PolygonOverBox(planes[self], box);
    for (std::size_t i = 0; i < planes.size() && !w.empty(); ++i)
        if (i != self && !IsOpposite(planes[i], planes[self]))
            ChopPolygon(w, {-planes[i].normal, -planes[i].dist}, kWindingEpsilon);
    return w;
}

Boundsd PolygonBox(const std::vector<Plane> &planes) {
    constexpr double kLimit = 4 * kMaxWorldCoord; // game units
    Boundsd world, box;
    world.Add({-kLimit, -kLimit, -kLimit}), world.Add({kLimit, kLimit, kLimit});
    for (std::size_t i = 0; i < planes.size(); ++i)
        for (const Vec3d &p : ChoppedPolygon(planes, i, world))
            box.Add(p);
    return box;
}

bool IsFlat(const Boundsd &box) {
    const Vec3d size = box.maxs - box.mins;
    return box.Empty() || !(size.x > 0 && size.y > 0 && size.z > 0);
}

/// Welds two points: each coordinate is the one nearer to an integer.
Vec3d Weld(const Vec3d &a, const Vec3d &b) {
    Vec3d welded;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double wholeA = std::rint(a[axis]), wholeB = std::rint(b[axis]);
        const double offA = std::abs(wholeA - a[axis]), offB = std::abs(wholeB - b[axis]);
        const double value = offA < offB ? a[axis] : b[axis], whole = offA < offB ? wholeA : wholeB;
        welded[axis] = std::min(offA, offB) < kNearWhole ? whole : value;
    }
    return welded;
}

void WeldShortEdges(Winding<double> &w) {
    for (bool again = true; again && w.size() > 1;) {
        again = false;
        for (std::size_t i = w.size() - 1, j = 0; j < w.size(); i = j++)
            if (Length(w[i] - w[j]) < kShortEdge) {
                w[i] = Weld(w[i], w[j]);
                w.erase(w.begin() + std::ptrdiff_t(j));
                again = true;
                break;
            }
    }
}

/// Rank of a shader, from the highest: liquid, fog, clip, not solid, solid. The content shader of a brush is the one of
/// its sides with the highest rank.
int ContentRank(const ShaderInfo &shader, const Game &game) {
    const SurfaceParm *clip = game.FindParm("playerclip");
    if (shader.compileFlags & C_LIQUID)
        return 4;
    if (shader.compileFlags & C_FOG)
        return 3;
    if (clip && (shader.contentFlags & clip->contentSet))
        return 2;
    return shader.compileFlags & C_SOLID ? 0 : 1;
}

} // namespace

bool MakeBrushWindings(Brush &brush, const PlaneTable &table) {
    brush.bounds = {};
    std::vector<Plane> planes = PlanesWithoutBevels(brush, table);
    Boundsd box = planes.size() <= kMaxTripleSides ? CornerBox(planes) : PolygonBox(planes);
    const Vec3d center = box.Center();
    constexpr double kMaxCenter = 8 * kMaxWorldCoord; // game units: farther out precision is lost
    if (IsFlat(box) || !(Length(center) <= kMaxCenter))
        return false;
    for (Plane &plane : planes)
        plane.dist -= Dot(plane.normal, center);
    box = {box.mins - center, box.maxs - center};
    std::size_t planeIndex = 0;
    for (BrushSide &side : brush.sides) {
        side.winding.clear();
        if (side.bevel)
            continue;
        Winding<double> w = ChoppedPolygon(planes, planeIndex++, box);
        WeldShortEdges(w);
        if (w.size() < 3)
            continue;
        for (const Vec3d &p : w) {
            side.winding.push_back(Vec3f(p + center));
            brush.bounds.Add(side.winding.back());
        }
    }
    if (IsFlat({Vec3d(brush.bounds.mins), Vec3d(brush.bounds.maxs)}))
        return false;
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (!(brush.bounds.mins[axis] >= -kMaxWorldCoord && brush.bounds.maxs[axis] <= kMaxWorldCoord))
            return false;
    return true;
}

bool IsInsideOut(const Brush &brush, const PlaneTable &table) {
    Brush turned;
    for (const BrushSide &side : brush.sides) {
        const Plane &plane = PlaneOfSide(side, table);
        BrushSide &back = turned.sides.emplace_back();
        back.plane = {-plane.normal, -plane.dist};
        back.hasPlane = true;
    }
    return MakeBrushWindings(turned, table);
}

void SetBrushContents(Brush &brush, const BspContext &context) {
    brush.contentShader = nullptr;
    brush.contentFlags = brush.compileFlags = 0;
    int highest = -1;
    for (const BrushSide &side : brush.sides) {
        brush.contentFlags |= side.contentFlags;
        brush.compileFlags |= side.compileFlags;
        if (!side.shader)
            continue;
        const int rank = ContentRank(*side.shader, context.game);
        if (rank > highest)
            brush.contentShader = side.shader, highest = rank;
    }
    if ((brush.compileFlags & C_DETAIL) && (brush.compileFlags & C_STRUCTURAL)) {
        context.WarnAt("mixed detail and structural", brush.settings.entity, brush.primitive,
                       "some sides are detail and others structural; the brush is taken as structural");
        brush.compileFlags &= ~C_DETAIL;
    }
    if (context.options.fullDetail)
        brush.compileFlags &= ~C_DETAIL;
    brush.opaque = !(brush.compileFlags & C_TRANSLUCENT);
    if (!brush.opaque && !(brush.compileFlags & C_STRUCTURAL))
        brush.compileFlags |= C_DETAIL;
    brush.detail = (brush.compileFlags & C_DETAIL) != 0;
}

std::unique_ptr<Brush> BrushFromPlanes(std::span<const Plane> planes, const ShaderInfo *firstShader,
                                       const BspContext &context, PlaneTable &table) {
    auto brush = std::make_unique<Brush>();
    brush->generated = true;
    for (const Plane &plane : planes) {
        BrushSide side;
        side.plane = plane;
        side.hasPlane = true;
        side.planeNum = table.Find(plane.normal, plane.dist);
        const auto sharesPlane = [&](int number) {
            return std::ranges::any_of(brush->sides, [&](const BrushSide &other) { return other.planeNum == number; });
        };
        if (side.planeNum < 0 || sharesPlane(side.planeNum))
            continue;
        if (sharesPlane(OppositePlane(side.planeNum)))
            return nullptr;
        if (brush->sides.empty() && firstShader) {
            side.shader = firstShader;
            side.surfaceFlags = firstShader->surfaceFlags;
            side.contentFlags = firstShader->contentFlags;
            side.compileFlags = firstShader->compileFlags;
        }
        brush->sides.push_back(std::move(side));
    }
    SetBrushContents(*brush, context);
    if (!MakeBrushWindings(*brush, table))
        return nullptr;
    return brush;
}

// ---- Bevel planes of brushes: axial planes, and planes through slanted edges ----

namespace {

constexpr double kOnPlane = 0.1; ///< game units
constexpr double kMinEdge = 0.5; ///< game units: shorter edges get no bevels
constexpr double kMinSine = 0.5; ///< of the angle between an edge and the axis of its bevel
constexpr std::size_t kAxialSides = 6;

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
    if (snap > 0) // towards the inside
        dist = direction > 0 ? std::floor(dist / snap) * snap : -std::ceil(-dist / snap) * snap;
    return planes.Find(normal, dist);
}

/// Sides 0 to 5 become -x +x -y +y -z +z.
void AddAxialBevels(Brush &brush, PlaneTable &planes, int snap, std::uint32_t inheritedFlags) {
    std::vector<BrushSide> &sides = brush.sides;
    for (std::size_t order = 0; order < kAxialSides; ++order) {
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
    if (Length(edge) < kMinEdge)
        return {};
    edge = StoredUnit(edge);
    planes.SnapNormal(edge);
    const int zeros = (edge.x == 0) + (edge.y == 0) + (edge.z == 0);
    const bool axial = std::abs(edge.x) == 1 || std::abs(edge.y) == 1 || std::abs(edge.z) == 1;
    return axial || zeros >= 2 ? Vec3d{} : edge;
}

enum class BevelFit { New, OnBevel, Rejected };

/// New: the whole brush is behind the plane, and no side has this plane. OnBevel: side `match` is a bevel with it.
/// Rejected: neither.
BevelFit FitBevel(const Brush &brush, const Plane &plane, const PlaneTable &planes, std::size_t &match) {
    for (std::size_t i = 0; i < brush.sides.size(); ++i) {
        const BrushSide &side = brush.sides[i];
        if (planes.Equal(side.planeNum, plane.normal, plane.dist)) {
            match = i;
            return side.bevel ? BevelFit::OnBevel : BevelFit::Rejected;
        }
        if (side.winding.empty())
            continue;
        double behind = 0;
        for (const Vec3f &p : side.winding) {
            const double distance = plane.Distance(Vec3d(p));
            if (distance > kOnPlane)
                return BevelFit::Rejected;
            behind = std::min(behind, distance);
        }
        if (behind > -kOnPlane)
            return BevelFit::Rejected;
    }
    return BevelFit::New;
}

void TryEdgeBevel(Brush &brush, std::size_t from, const Vec3f &point, const Vec3d &edge, const Vec3d &axis,
                  PlaneTable &planes, std::uint32_t inheritedFlags) {
    Vec3d normal = Cross(edge, axis);
    if (Length(normal) < kMinSine)
        return;
    normal = StoredUnit(normal);
    const Vec3d p(point);
    const Plane plane{normal, double(Dot(point, Vec3f(normal)))};
    const std::uint32_t flags = brush.sides[from].surfaceFlags & inheritedFlags;
    std::size_t match = 0;
    const BevelFit fit = FitBevel(brush, plane, planes, match);
    if (fit == BevelFit::OnBevel)
        brush.sides[match].surfaceFlags |= flags;
    if (fit != BevelFit::New)
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
    if (brush.sides.size() == kAxialSides)
        return;
    for (std::size_t i = kAxialSides; i < brush.sides.size(); ++i) {
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
