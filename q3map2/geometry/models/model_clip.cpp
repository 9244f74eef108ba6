// GPL-2.0-or-later. Clip brushes of models: solids behind their polygons.
#include "q3map2/geometry/models/model_clip.h"

#include "q3map2/map/map_brush.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <tuple>
#include <unordered_map>

namespace q3 {

// ---- Merges triangles of a mesh into convex polygons ----

namespace {

constexpr double kSameNormal = 0.00001; ///< length of the difference of unit normals
constexpr double kSamePlane = 0.01;     ///< difference of plane distances, game units
constexpr double kStraight = 0.00001;   ///< sine of the angle between edges in line

struct ConvexPolygon {
    std::vector<int> corners; ///< indexes of positions; empty: merged into another
    Plane plane;
};

Plane PlaneOfCorners(const std::vector<Vec3f> &positions, const std::vector<int> &corners) {
    const Vec3d a(positions[std::size_t(corners[0])]), b(positions[std::size_t(corners[1])]),
        c(positions[std::size_t(corners[2])]);
    const Vec3d normal = Normalize(Cross(c - a, b - a));
    return {normal, Dot(normal, a)};
}

class PolygonMerger {
  public:
    PolygonMerger(std::span<const Vec3f> points, std::span<const std::array<int, 3>> triangles) {
        std::map<std::tuple<float, float, float>, int> numbers;
        std::vector<int> numberOf;
        for (const Vec3f &p : points) {
            const auto [at, added] = numbers.try_emplace({p.x, p.y, p.z}, int(positions_.size()));
            if (added)
                positions_.push_back(p);
            numberOf.push_back(at->second);
        }
        for (const auto &[a, b, c] : triangles) {
            ConvexPolygon polygon{{numberOf[std::size_t(a)], numberOf[std::size_t(b)], numberOf[std::size_t(c)]}, {}};
            polygon.plane = PlaneOfCorners(positions_, polygon.corners);
            if (polygon.plane.normal == Vec3d{})
                continue;
            polygons_.push_back(std::move(polygon));
            Register(polygons_.size() - 1);
        }
    }

    std::vector<Polygon> Run() {
        for (std::size_t i = 0; i < polygons_.size(); ++i)
            while (!polygons_[i].corners.empty() && JoinNeighbor(i)) {
            }
        std::vector<Polygon> polygons;
        for (const ConvexPolygon &source : polygons_) {
            Polygon polygon;
            for (const int corner : source.corners)
                polygon.push_back(positions_[std::size_t(corner)]);
            if (!polygon.empty())
                polygons.push_back(std::move(polygon));
        }
        return polygons;
    }

  private:
    static std::uint64_t Edge(int from, int to) { return std::uint64_t(std::uint32_t(from)) << 32 | std::uint32_t(to); }

    void Register(std::size_t polygon) {
        const std::vector<int> &corners = polygons_[polygon].corners;
        for (std::size_t i = 0; i < corners.size(); ++i)
            edges_[Edge(corners[i], corners[(i + 1) % corners.size()])] = polygon;
    }

    /// Joins one neighbor to the polygon. False: there is none that it can be joined to.
    bool JoinNeighbor(std::size_t number) {
        const std::vector<int> corners = polygons_[number].corners;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto at = edges_.find(Edge(corners[(i + 1) % corners.size()], corners[i]));
            if (at == edges_.end() || at->second == number || polygons_[at->second].corners.empty())
                continue;
            ConvexPolygon &other = polygons_[at->second];
            if (Length(other.plane.normal - polygons_[number].plane.normal) > kSameNormal ||
                std::abs(other.plane.dist - polygons_[number].plane.dist) > kSamePlane)
                continue;
            std::vector<int> joined = Joined(corners, i, other.corners);
            if (!RemoveCollinear(joined, polygons_[number].plane.normal))
                continue;
            other.corners.clear();
            polygons_[number].corners = std::move(joined);
            Register(number);
            return true;
        }
        return false;
    }

    /// The union of `a` and `b` across edge number `edge` of `a`. Empty if `b` no longer has that edge.
    static std::vector<int> Joined(const std::vector<int> &a, std::size_t edge, const std::vector<int> &b) {
        const int start = a[edge], end = a[(edge + 1) % a.size()];
        const auto at = std::find(b.begin(), b.end(), end);
        if (at == b.end() || b[std::size_t(at - b.begin() + 1) % b.size()] != start)
            return {};
        std::vector<int> joined;
        for (std::size_t i = 0; i < a.size(); ++i)
            joined.push_back(a[(edge + 1 + i) % a.size()]);
        for (std::size_t i = 2; i < b.size(); ++i)
            joined.push_back(b[(std::size_t(at - b.begin()) + i) % b.size()]);
        return joined;
    }

    /// Removes collinear corners. False if the polygon is not convex.
    bool RemoveCollinear(std::vector<int> &corners, const Vec3d &normal) const {
        for (std::size_t i = 0; i < corners.size() && corners.size() > 2;) {
            const Vec3d a(positions_[std::size_t(corners[(i + corners.size() - 1) % corners.size()])]),
                b(positions_[std::size_t(corners[i])]), c(positions_[std::size_t(corners[(i + 1) % corners.size()])]);
            const double turn = Dot(Cross(Normalize(c - b), Normalize(b - a)), normal);
            if (turn < -kStraight)
                return false;
            if (turn <= kStraight) {
                if (Dot(c - b, b - a) < 0)
                    return false;
                corners.erase(corners.begin() + std::ptrdiff_t(i));
                i = 0;
            } else
                ++i;
        }
        return corners.size() > 2;
    }

    std::vector<Vec3f> positions_;
    std::vector<ConvexPolygon> polygons_;
    std::unordered_map<std::uint64_t, std::size_t> edges_; ///< by directed Edge: the polygon that it bounds
};

} // namespace

std::vector<Polygon> MergedTriangles(std::span<const Vec3f> points, std::span<const std::array<int, 3>> triangles) {
    return PolygonMerger(points, triangles).Run();
}

// ---- Solids extruded from the polygons of a mesh ----

namespace {

constexpr double kMinFacing = 0.01; ///< least absolute cosine of the angle between extrusion direction and normal

/// Parameters of the extrusion.
struct Extrusion {
    unsigned mode = 0; ///< ModelFlags within kModelClipShapes
    double depth = 2;  ///< game units
    Vec3d terrainAxis; ///< unit axis most opposite to the average normal
    Boundsd bounds;    ///< of the model
};

/// Whether the flags combine to one shape; with other combinations no clip brushes are made.
bool IsKnownMode(unsigned mode) {
    constexpr unsigned up = kModelClipUp, down = kModelClipDown, terrain = kModelClipTerrain;
    constexpr std::array<unsigned, 8> plain{0,
                                            kModelClipPyramid,
                                            kModelClipPyramid | kModelClipAxialBack,
                                            kModelClipFaceNormals,
                                            kModelClipFaceNormals | kModelClipPyramid,
                                            kModelClipAxialBack,
                                            kModelClipVertexNormals,
                                            kModelClipVertexNormals | kModelClipPyramid};
    if (std::ranges::find(plain, mode) != plain.end())
        return true;
    const unsigned direction = mode & (up | down | terrain), rest = mode & ~(up | down | terrain);
    return (direction == terrain || direction == up || direction == down || direction == (up | down)) &&
           (rest == 0 || rest == kModelClipAxialBack || rest == kModelClipFull);
}

/// Signed unit vector along the axis of the largest component.
Vec3d LargestAxis(const Vec3d &v) {
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (std::abs(v[i]) > std::abs(v[axis]))
            axis = i;
    Vec3d result;
    result[axis] = v[axis] < 0 ? -1 : 1;
    return result;
}

/// Direction of extrusion, a unit vector.
Vec3d ExtrusionDirection(const Extrusion &extrusion, const Vec3d &normal) {
    const unsigned mode = extrusion.mode;
    if (mode & (kModelClipFaceNormals | kModelClipVertexNormals))
        return -normal;
    if (mode & kModelClipTerrain)
        return extrusion.terrainAxis;
    const bool up = mode & kModelClipUp, down = mode & kModelClipDown;
    if (up && down)
        return {0, 0, normal.z > 0 ? -1. : 1.};
    if (up || down)
        return {0, 0, up ? 1. : -1.};
    return -LargestAxis(normal);
}

Vec3d CentroidOf(const Polygon &polygon) {
    Vec3d sum;
    for (const Vec3f &p : polygon)
        sum += Vec3d(p);
    return sum / double(polygon.size());
}

/// The plane through the points that faces away from `inside`.
Plane PlaneAway(const Vec3d &a, const Vec3d &b, const Vec3d &c, const Vec3d &inside) {
    Vec3d normal = Normalize(Cross(b - a, c - a));
    if (Dot(normal, inside - a) > 0)
        normal = -normal;
    return {normal, Dot(normal, a)};
}

/// The axis-aligned back plane, whose normal is the axis nearest to the extrusion direction.
Plane FlatBack(const Extrusion &extrusion, const Polygon &polygon, const Vec3d &direction) {
    const Vec3d axis = LargestAxis(direction);
    double nearest = std::numeric_limits<double>::max(), farthest = std::numeric_limits<double>::lowest();
    for (const Vec3f &p : polygon) {
        nearest = std::min(nearest, Dot(Vec3d(p), axis));
        farthest = std::max(farthest, Dot(Vec3d(p), axis));
    }
    if (extrusion.mode & kModelClipFull) {
        const double extreme = std::max(Dot(extrusion.bounds.mins, axis), Dot(extrusion.bounds.maxs, axis));
        return {axis, extreme};
    }
    // Negative depth: -depth behind the nearest corner, but no more than 1 game unit behind the farthest.
    if (extrusion.depth < 0)
        return {axis, std::min(farthest + 1, nearest - extrusion.depth)};
    return {axis, farthest + extrusion.depth};
}

Plane BackPlane(const Extrusion &extrusion, const Polygon &polygon, const Plane &front, const Vec3d &direction) {
    if (extrusion.mode & (kModelClipAxialBack | kModelClipFull))
        return FlatBack(extrusion, polygon, direction);
    const double depth = std::abs(extrusion.depth);
    return {-front.normal, -(front.dist + Dot(front.normal, direction) * depth)};
}

/// Planes of the solid extruded from a clockwise polygon, the polygon's plane first. Empty if the extrusion is parallel
/// to the polygon.
std::vector<Plane> SolidPlanes(const Extrusion &extrusion, Polygon polygon, Plane front) {
    const Vec3d direction = ExtrusionDirection(extrusion, front.normal);
    if (std::abs(Dot(direction, front.normal)) < kMinFacing)
        return {};
    if (Dot(direction, front.normal) > 0) { // extruded to the front, so the polygon becomes the back
        polygon = Reversed(polygon);
        front = {-front.normal, -front.dist};
    }
    const bool isPyramid = extrusion.mode & kModelClipPyramid, hasSlopes = extrusion.mode & kModelClipFaceNormals;
    const Vec3d center = CentroidOf(polygon), inside = center + direction * 0.5; // 0.5 game units behind the polygon
    const Vec3d apex = center + direction * std::abs(extrusion.depth);
    std::vector<Plane> planes{front};
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vec3d a(polygon[i]), b(polygon[(i + 1) % polygon.size()]);
        if (!isPyramid)
            planes.push_back(PlaneAway(a, b, a + direction, center));
        else if (!hasSlopes)
            planes.push_back(PlaneAway(a, b, apex, inside));
        else { // sides that lean inwards by 45 degrees
            const Vec3d outward = PlaneAway(a, b, a + direction, center).normal;
            const Vec3d normal = Normalize(outward + direction);
            planes.push_back({normal, Dot(normal, a)});
        }
    }
    if (!isPyramid || hasSlopes || (extrusion.mode & kModelClipAxialBack))
        planes.push_back(BackPlane(extrusion, polygon, front, direction));
    return planes;
}

/// Planes of the prism of a triangle whose corners are extruded against their vertex normals.
std::vector<Plane> VertexNormalPlanes(const Extrusion &extrusion, const ClipMesh &mesh,
                                      const std::array<int, 3> &triangle) {
    std::array<Vec3d, 3> front, back;
    Vec3d center, backCenter;
    for (std::size_t i = 0; i < 3; ++i) {
        front[i] = Vec3d(mesh.points[std::size_t(triangle[i])]);
        back[i] = front[i] - Vec3d(mesh.normals[std::size_t(triangle[i])]) * std::abs(extrusion.depth);
        center += front[i] / 3., backCenter += back[i] / 3.;
    }
    const Vec3d inside = (center + backCenter) * 0.5;
    const bool isPyramid = extrusion.mode & kModelClipPyramid;
    std::vector<Plane> planes{PlaneAway(front[0], front[1], front[2], inside)};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        planes.push_back(PlaneAway(front[i], front[j], isPyramid ? backCenter : (back[i] + back[j]) * 0.5, inside));
    }
    if (!isPyramid)
        planes.push_back(PlaneAway(back[0], back[1], back[2], inside));
    return planes;
}

class ClipBrushBuilder {
  public:
    ClipBrushBuilder(const ModelPlacement &placement, MapEntity &target, PlaneTable &planes, const BspContext &context)
        : placement_(placement), target_(target), planes_(planes), context_(context) {}

    void Add(const std::vector<Plane> &planes, const ShaderInfo *shader, const Vec3d &where) {
        auto brush = planes.size() < 4 ? nullptr : BrushFromPlanes(planes, shader, context_, planes_);
        if (!brush) {
            context_.log.Warn("triangle not autoclipped",
                              "{}: the model {} has no clip brush at ({:.0f} {:.0f} {:.0f})", placement_.messagePrefix,
                              placement_.name, where.x, where.y, where.z);
            return;
        }
        brush->settings = placement_.settings;
        brush->primitive = -1; // the map source has no such brush
        brush->generated = brush->detail = true;
        brush->compileFlags |= C_DETAIL;
        AddBrushBevels(*brush, planes_, context_.options.bevelSnap, context_.game.bevelSurfaceFlags);
        target_.brushes.push_back(std::move(*brush));
    }

  private:
    const ModelPlacement &placement_;
    MapEntity &target_;
    PlaneTable &planes_;
    const BspContext &context_;
};

Extrusion ExtrusionOf(const std::vector<ClipMesh> &meshes, const ModelPlacement &placement) {
    Extrusion extrusion;
    extrusion.mode = placement.flags & kModelClipShapes;
    extrusion.depth = placement.clipDepth;
    Vec3d facing;
    for (const ClipMesh &mesh : meshes) {
        for (const Vec3f &p : mesh.points)
            extrusion.bounds.Add(Vec3d(p));
        for (const auto &[a, b, c] : mesh.triangles) {
            const Vec3d p(mesh.points[std::size_t(a)]);
            facing += Normalize(Cross(Vec3d(mesh.points[std::size_t(c)]) - p, Vec3d(mesh.points[std::size_t(b)]) - p));
        }
    }
    extrusion.terrainAxis = -LargestAxis(facing);
    return extrusion;
}

} // namespace

void MakeClipBrushes(const std::vector<ClipMesh> &meshes, const ModelPlacement &placement, MapEntity &target,
                     PlaneTable &planes, const BspContext &context) {
    const Extrusion extrusion = ExtrusionOf(meshes, placement);
    if (!IsKnownMode(extrusion.mode)) {
        context.log.Warn("unknown clip mode",
                         "{}: the spawnflags {} of the model {} select no known clip mode; no clip brushes are made",
                         placement.messagePrefix, placement.flags, placement.name);
        return;
    }
    ClipBrushBuilder clipper(placement, target, planes, context);
    for (const ClipMesh &mesh : meshes) {
        if (extrusion.mode & kModelClipVertexNormals) {
            for (const auto &triangle : mesh.triangles)
                clipper.Add(VertexNormalPlanes(extrusion, mesh, triangle), mesh.shader,
                            Vec3d(mesh.points[std::size_t(triangle[0])]));
            continue;
        }
        for (const Polygon &polygon : MergedTriangles(mesh.points, mesh.triangles))
            clipper.Add(SolidPlanes(extrusion, polygon, PlaneOf(polygon)), mesh.shader, Vec3d(polygon.front()));
    }
}

} // namespace q3
