// GPL-2.0-or-later. T-junction repair: inserts vertices of other surfaces into the edges of faces.
#include "q3map2/geometry/faces/tjunctions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>

namespace q3 {

// ---- Lines along edges of surfaces, looked up in a grid of cells ----

namespace {

constexpr double kNearLine = 0.25, kSamePoint = 0.25; ///< game units
constexpr double kMaxCellsAcross = 64;                ///< along the longest axis of the bounds
constexpr double kMinCell = 16;                       ///< game units
/// Bound on the distance from the line for points within kNearLine of both planes (0.25 * sqrt(2) = 0.36).
constexpr double kReach = 0.5;

void Insert(EdgeLine &line, const Vec3f &p) {
    const double along = Dot(Vec3d(p) - line.origin, line.direction);
    const auto next = std::ranges::upper_bound(line.points, along - kSamePoint, {}, &EdgeLine::Point::along);
    if (next == line.points.end() || next->along - along >= kSamePoint)
        line.points.insert(next, {along, p});
}

bool IsNear(const EdgeLine &line, const Vec3d &p) {
    return std::abs(line.planes[0].Distance(p)) < kNearLine && std::abs(line.planes[1].Distance(p)) < kNearLine;
}

EdgeLine MakeLine(const Vec3d &origin, const Vec3d &direction) {
    std::size_t least = 0;
    for (std::size_t i = 1; i < 3; ++i)
        if (std::abs(direction[i]) < std::abs(direction[least]))
            least = i;
    Vec3d axis;
    axis[least] = 1;
    EdgeLine line{origin, direction, {}, {}};
    line.planes[0].normal = Normalize(Cross(axis, direction));
    line.planes[1].normal = Cross(line.planes[0].normal, direction);
    for (Plane &plane : line.planes)
        plane.dist = Dot(plane.normal, origin);
    return line;
}

} // namespace

EdgeLines::EdgeLines(const Boundsf &bounds, std::size_t edges) : bounds_{Vec3d(bounds.mins), Vec3d(bounds.maxs)} {
    if (bounds_.Empty())
        bounds_ = {Vec3d{}, Vec3d{}};
    const Vec3d extent = bounds_.maxs - bounds_.mins;
    // Eight cells an edge.
    const double across = std::clamp(2 * std::cbrt(double(edges)), 1., kMaxCellsAcross);
    cellSize_ = std::max(kMinCell, MaxComponent(extent) / across);
    for (std::size_t i = 0; i < 3; ++i)
        size_[i] = int(extent[i] / cellSize_) + 1;
    cells_.resize(std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]));
}

std::array<int, 3> EdgeLines::CellOf(const Vec3d &p) const {
    std::array<int, 3> cell{};
    for (std::size_t i = 0; i < 3; ++i)
        cell[i] = int(std::clamp(std::floor((p[i] - bounds_.mins[i]) / cellSize_), 0., double(size_[i] - 1)));
    return cell;
}

void EdgeLines::EnterCells(int number) {
    const EdgeLine &line = lines_[std::size_t(number)];
    // Only the part of the line in the bounds and a margin: no point outside is ever looked up.
    double from = std::numeric_limits<double>::lowest(), to = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < 3; ++i) {
        const double d = line.direction[i];
        constexpr double kParallel = 1e-9; // component of the unit direction
        if (std::abs(d) < kParallel)
            continue;
        const double t0 = (bounds_.mins[i] - kReach - line.origin[i]) / d;
        const double t1 = (bounds_.maxs[i] + kReach - line.origin[i]) / d;
        from = std::max(from, std::min(t0, t1)), to = std::min(to, std::max(t0, t1));
    }
    const Vec3d reach{kReach, kReach, kReach};
    for (double t = from; t < to; t += cellSize_) {
        const Vec3d a = line.origin + line.direction * t;
        const Vec3d b = line.origin + line.direction * std::min(to, t + cellSize_);
        const std::array<int, 3> lo = CellOf(Min(a, b) - reach), hi = CellOf(Max(a, b) + reach);
        for (int z = lo[2]; z <= hi[2]; ++z)
            for (int y = lo[1]; y <= hi[1]; ++y)
                for (int x = lo[0]; x <= hi[0]; ++x) {
                    std::vector<int> &cell = cells_[std::size_t((z * size_[1] + y) * size_[0] + x)];
                    if (cell.empty() || cell.back() != number)
                        cell.push_back(number);
                }
    }
}

int EdgeLines::Find(const Vec3d &a, const Vec3d &b) const {
    const std::array<int, 3> c = CellOf(a);
    for (const int line : cells_[std::size_t((c[2] * size_[1] + c[1]) * size_[0] + c[0])])
        if (IsNear(lines_[std::size_t(line)], a) && IsNear(lines_[std::size_t(line)], b))
            return line;
    return -1;
}

int EdgeLines::Add(const Vec3f &a, const Vec3f &b, const Vec3d &direction) {
    int line = Find(Vec3d(a), Vec3d(b));
    if (line < 0) {
        line = Count();
        lines_.push_back(MakeLine(Vec3d(a), direction));
        EnterCells(line);
    }
    Insert(lines_[std::size_t(line)], a);
    Insert(lines_[std::size_t(line)], b);
    return line;
}

// ---- Edges of surfaces on lines, and vertices of the lines inserted into faces ----

namespace {

constexpr double kDegenerate = 0.1; ///< game units: shorter edges are ignored, closer vertices are welded
constexpr double kStraight = 0.1;   ///< distance of the middle control point of a straight border curve from its chord
constexpr double kNearWhole = 0.01; ///< welded coordinates this close to a whole number are rounded

struct Edge {
    std::size_t surface = 0;
    int vert = 0; ///< first vertex in a face; -1 for a patch
    Vec3f from, to;
    Vec3d direction{};
    double length = 0;
    bool isAxial = false;
    int line = -1; ///< index in EdgeLines; -1: not there yet
};

struct RepairCounts {
    int degenerate = 0, axialLines = 0, lines = 0, added = 0, verts = 0;
    int natural = 0, rotated = 0, impossible = 0; ///< faces whose fan starts at the first vertex, at another, at none
};

bool IsRepaired(const DrawSurface &surface) {
    if (surface.Empty() || surface.shader == nullptr)
        return false;
    if (surface.kind != SurfaceKind::Face && surface.kind != SurfaceKind::Patch)
        return false;
    const ShaderInfo &shader = *surface.shader;
    return (shader.compileFlags & C_NODRAW) == 0 && !shader.autosprite && !shader.geometry.noTJunctions;
}

class EdgeList {
  public:
    void Add(std::size_t surface, int vert, const Vec3f &from, const Vec3f &to) {
        Edge edge{.surface = surface, .vert = vert, .from = from, .to = to};
        edge.length = Length(Vec3d(to) - Vec3d(from));
        if (edge.length < kDegenerate) {
            ++degenerateCount;
            return;
        }
        edge.direction = (Vec3d(to) - Vec3d(from)) / edge.length;
        const Vec3f d(edge.direction);
        // Holds along an axis; also for other unit vectors whose components add up to 1, such as (2/3, 2/3, -1/3).
        edge.isAxial = std::abs(d.x + d.y + d.z) == 1;
        edges.push_back(edge);
    }
    void AddFace(const DrawSurface &surface, std::size_t number) {
        // Begins with the edge from the last vertex. The order matters: an edge joins the first line within the
        // tolerance.
        const std::size_t count = surface.verts.size();
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t from = (i + count - 1) % count;
            Add(number, int(from), surface.verts[from].xyz, surface.verts[i].xyz);
        }
    }
    /// Adds the straight border curves.
    void AddPatch(const DrawSurface &surface, std::size_t number) {
        const int w = surface.width, h = surface.height;
        const auto curve = [&](int start, int step) {
            const auto at = [&](int i) { return surface.verts[std::size_t(start + i * step)].xyz; };
            const Vec3d a(at(0)), b(at(1)), c(at(2));
            const Vec3d direction = Normalize(c - a), offset = b - a;
            if (Length(offset - direction * Dot(offset, direction)) <= kStraight)
                Add(number, -1, at(0), at(2));
        };
        for (int x = 0; x + 2 < w; x += 2)
            curve(x, 1), curve((h - 1) * w + x, 1);
        for (int y = 0; y + 2 < h; y += 2)
            curve(y * w, w), curve(y * w + w - 1, w);
    }
    std::vector<Edge> edges;
    int degenerateCount = 0;
};

EdgeLines MakeLines(EdgeList &list, const Boundsf &bounds, RepairCounts &counts) {
    EdgeLines lines(bounds, list.edges.size());
    std::vector<Edge *> oblique;
    for (Edge &edge : list.edges) {
        if (edge.isAxial)
            edge.line = lines.Add(edge.from, edge.to, edge.direction);
        else
            oblique.push_back(&edge);
    }
    counts.axialLines = lines.Count();
    // Edges of equal length stay in the order of the surfaces.
    std::stable_sort(oblique.begin(), oblique.end(),
                     [](const Edge *a, const Edge *b) { return a->length < b->length; });
    for (Edge *edge : oblique)
        edge->line = lines.Add(edge->from, edge->to, edge->direction);
    counts.lines = lines.Count();
    counts.degenerate = list.degenerateCount;
    return lines;
}

/// The vertex at `xyz`, with attributes interpolated from a (fraction 0) to b (1).
DrawVert InsertedVert(const DrawVert &a, const DrawVert &b, double fraction, const Vec3f &xyz) {
    DrawVert vert = a;
    vert.xyz = xyz;
    vert.inserted = true;
    for (std::size_t i = 0; i < 2; ++i)
        vert.st[i] = float(double(a.st[i]) + fraction * (double(b.st[i]) - double(a.st[i])));
    for (std::size_t i = 0; i < 4; ++i)
        vert.color[i] = std::uint8_t(double(a.color[i]) + fraction * (double(b.color[i]) - double(a.color[i])));
    return vert;
}

/// A vertex, and the edge of the original face that starts at it or on which it lies.
struct FaceVert {
    DrawVert vert;
    std::size_t edge = 0;
};

void AddPointsOn(const EdgeLine &line, const DrawVert &a, const DrawVert &b, std::size_t edge,
                 std::vector<FaceVert> &corners) {
    const double from = Dot(Vec3d(a.xyz) - line.origin, line.direction);
    const double to = Dot(Vec3d(b.xyz) - line.origin, line.direction);
    const double lo = std::min(from, to) + kDegenerate, hi = std::max(from, to) - kDegenerate;
    const auto begin = std::ranges::upper_bound(line.points, lo, {}, &EdgeLine::Point::along);
    const std::size_t before = corners.size();
    for (auto p = begin; p != line.points.end() && p->along < hi; ++p)
        corners.push_back({InsertedVert(a, b, (p->along - from) / (to - from), p->xyz), edge});
    if (to < from)
        std::reverse(corners.begin() + std::ptrdiff_t(before), corners.end());
}

/// Index of a vertex from which a triangle fan has no degenerate triangle: neither its first nor its last triangle has
/// all corners on one edge of the original face. corners.size() if there is none.
std::size_t FanStart(const std::vector<FaceVert> &corners) {
    const std::size_t n = corners.size();
    for (std::size_t i = 0; i < n; ++i) {
        const auto edge = [&](std::size_t offset) { return corners[(i + offset) % n].edge; };
        if (edge(1) != edge(0) && edge(n - 1) != edge(n - 2))
            return i;
    }
    return n;
}

void InsertVerts(DrawSurface &surface, const EdgeLines &lines, std::span<const Edge> edges, RepairCounts &counts) {
    std::vector<int> lineFrom(surface.verts.size(), -1);
    for (const Edge &edge : edges)
        lineFrom[std::size_t(edge.vert)] = edge.line;
    std::vector<FaceVert> corners;
    for (std::size_t i = 0; i < surface.verts.size(); ++i) {
        corners.push_back({surface.verts[i], i});
        if (lineFrom[i] >= 0)
            AddPointsOn(lines[lineFrom[i]], surface.verts[i], surface.verts[(i + 1) % surface.verts.size()], i,
                        corners);
    }
    counts.added += int(corners.size() - surface.verts.size());
    counts.verts += int(corners.size());
    const std::size_t start = FanStart(corners);
    ++(start == 0 ? counts.natural : start == corners.size() ? counts.impossible : counts.rotated);
    // Rotates by one vertex, even if the start is another, as NetRadiant's q3map2 does.
    if (start != 0)
        std::rotate(corners.begin(), corners.begin() + 1, corners.end());
    surface.verts.clear();
    for (const FaceVert &corner : corners)
        surface.verts.push_back(corner.vert);
}

float WeldedCoordinate(double a, double b) {
    const double offA = std::abs(a - std::nearbyint(a)), offB = std::abs(b - std::nearbyint(b));
    const double chosen = offA == 0 ? a : offB == 0 ? b : offA <= offB ? a : b;
    const double whole = std::nearbyint(chosen);
    return float(std::abs(chosen - whole) < kNearWhole ? whole : chosen);
}

DrawVert Welded(const DrawVert &a, const DrawVert &b) {
    DrawVert vert = a;
    for (std::size_t i = 0; i < 3; ++i)
        vert.xyz[i] = WeldedCoordinate(double(a.xyz[i]), double(b.xyz[i]));
    const Vec3f normal = Normalize(a.normal + b.normal);
    vert.normal = normal == Vec3f{} ? a.normal : normal;
    for (std::size_t i = 0; i < 2; ++i)
        vert.st[i] = (a.st[i] + b.st[i]) / 2;
    for (std::size_t i = 0; i < 4; ++i)
        vert.color[i] = std::uint8_t((a.color[i] + b.color[i]) / 2);
    return vert;
}

/// Welds neighboring vertices that are closer than kDegenerate.
void Weld(DrawSurface &surface) {
    std::vector<DrawVert> &verts = surface.verts;
    for (std::size_t i = 0; i < verts.size() && verts.size() > 1;) {
        const std::size_t next = (i + 1) % verts.size();
        if (Length(Vec3d(verts[i].xyz) - Vec3d(verts[next].xyz)) >= kDegenerate) {
            ++i;
            continue;
        }
        verts[i] = Welded(verts[i], verts[next]);
        verts.erase(verts.begin() + std::ptrdiff_t(next));
        // The welded vertex has a new neighbor, so it is tested again.
        if (next < i)
            --i;
    }
    if (verts.size() < 3)
        verts.clear();
}

void Report(const RepairCounts &counts, Log &log) {
    log.VerboseCount(counts.axialLines, "axial edge lines");
    log.VerboseCount(counts.lines - counts.axialLines, "non-axial edge lines");
    log.VerboseCount(counts.degenerate, "degenerate edges");
    log.VerboseCount(counts.added, "verts added for T-junctions");
    log.VerboseCount(counts.verts, "total verts");
    log.VerboseCount(counts.natural, "naturally ordered");
    log.VerboseCount(counts.rotated, "rotated orders");
    log.VerboseCount(counts.impossible, "can't order");
}

} // namespace

void FixTJunctions(Geometry &geometry, std::size_t first, const BspContext &context) {
    if (context.options.noTJunctions)
        return;
    EdgeList list;
    Boundsf bounds;
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i) {
        const DrawSurface &surface = geometry.surfaces[i];
        if (!IsRepaired(surface))
            continue;
        for (const DrawVert &v : surface.verts)
            bounds.Add(v.xyz);
        if (surface.kind == SurfaceKind::Face)
            list.AddFace(surface, i);
        else
            list.AddPatch(surface, i);
    }
    RepairCounts counts;
    const EdgeLines lines = MakeLines(list, bounds, counts);
    std::size_t edge = 0;
    for (std::size_t i = first; i < geometry.surfaces.size(); ++i) {
        const std::size_t begin = edge;
        while (edge < list.edges.size() && list.edges[edge].surface == i)
            ++edge;
        DrawSurface &surface = geometry.surfaces[i];
        if (surface.kind != SurfaceKind::Face || !IsRepaired(surface))
            continue;
        InsertVerts(surface, lines, std::span(list.edges).subspan(begin, edge - begin), counts);
        Weld(surface);
    }
    Report(counts, context.log);
}

} // namespace q3
