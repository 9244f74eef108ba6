// GPL-2.0-or-later. The graph of leafs and directed portals, and its merging where unions are convex.
#include "q3map2/vis/portal_graph.h"

#include "common/error.h"

#include <algorithm>
#include <optional>

namespace q3 {

// ---- The graph of leafs and portals, from a portal file ----

namespace {

/// The plane of the first three points or, if these are collinear, a plane normal to the area vector of the polygon.
VisPlane PlaneOfWinding(std::span<const Vec3f> points, std::string_view name, int line) {
    VisPlane plane;
    if (PlaneOfPoints(points[0], points[1], points[2], plane))
        return plane;
    const Vec3d area = WindingAreaVector(Winding<float>(points.begin(), points.end()));
    if (!(Length(area) > 0))
        throw Error("{}:{}: a polygon without area, expected points that are not on one line", name, line);
    plane.normal = Vec3f(-Normalize(area));
    plane.dist = Dot(points[0], plane.normal);
    return plane;
}

} // namespace

void GraphPortal::UpdateBoundingSphere() {
    Vec3d sum;
    for (const Vec3f &p : winding)
        sum += Vec3d(p);
    sum = sum / double(winding.size());
    double largest = 0;
    for (const Vec3f &p : winding) {
        const Vec3f away(Vec3d(p) - sum);
        largest = std::max(largest, std::sqrt(double(Dot(away, away))));
    }
    center = Vec3f(sum);
    radius = float(largest);
}

int PortalGraph::Root(int leaf) const {
    while (leafs[std::size_t(leaf)].mergedInto >= 0)
        leaf = leafs[std::size_t(leaf)].mergedInto;
    return leaf;
}

int PortalGraph::ActivePortals() const {
    return int(std::count_if(portals.begin(), portals.end(), [](const GraphPortal &p) { return !p.removed; }));
}

int PortalGraph::HintPortals() const {
    return int(
        std::count_if(portals.begin(), portals.end(), [](const GraphPortal &p) { return !p.removed && p.hint; }));
}

PortalGraph BuildPortalGraph(const PortalFile &file, std::string_view name) {
    PortalGraph graph;
    graph.leafs.resize(std::size_t(file.clusters));
    graph.portals.reserve(2 * file.portals.size());
    for (const PrtWinding &winding : file.portals) {
        const auto points = file.Points(winding);
        const VisPlane plane = PlaneOfWinding(points, name, winding.line);
        GraphPortal forward;
        forward.winding.assign(points.begin(), points.end());
        forward.plane = plane.Flipped();
        forward.leaf = winding.clusters[1];
        forward.hint = winding.isHint;
        forward.sky = winding.isSky;
        forward.UpdateBoundingSphere();
        GraphPortal backward = forward;
        std::reverse(backward.winding.begin(), backward.winding.end());
        backward.plane = plane;
        backward.leaf = winding.clusters[0];
        const int index = int(graph.portals.size());
        graph.leafs[std::size_t(winding.clusters[0])].portals.push_back(index);
        graph.leafs[std::size_t(winding.clusters[1])].portals.push_back(index + 1);
        graph.portals.push_back(std::move(forward));
        graph.portals.push_back(std::move(backward));
    }
    for (const PrtWinding &winding : file.faces) {
        const auto points = file.Points(winding);
        graph.leafs[std::size_t(winding.clusters[0])].faces.push_back(
            {{points.begin(), points.end()}, PlaneOfWinding(points, name, winding.line).Flipped()});
    }
    return graph;
}

// ---- Merges leafs and portals whose union is convex ----

namespace {

constexpr double kConvexTolerance = 0.2; ///< a union with dents up to this depth counts as convex, game units
constexpr float kSamePoint = 0.1f;       ///< corners closer than this on each axis are equal, game units
constexpr float kCollinear = 0.005f;     ///< corners this near to the line of their neighbors are dropped, game units

/// A polygon that bounds a leaf.
struct Border {
    const Winding<float> *winding;
    const VisPlane *plane;
};

/// Faces and portals that bound a leaf, except portals to leaf `other`.
std::vector<Border> BordersOf(const PortalGraph &graph, int leaf, int other) {
    std::vector<Border> borders;
    const GraphLeaf &one = graph.leafs[std::size_t(leaf)];
    for (const GraphFace &face : one.faces)
        borders.push_back({&face.winding, &face.plane});
    for (const int p : one.portals) {
        const GraphPortal &portal = graph.portals[std::size_t(p)];
        if (!portal.removed && portal.leaf != other)
            borders.push_back({&portal.winding, &portal.plane});
    }
    return borders;
}

bool AnyInFront(const Winding<float> &winding, const VisPlane &plane) {
    return std::any_of(winding.begin(), winding.end(), [&](const Vec3f &p) {
        return double(Dot(p, plane.normal)) - double(plane.dist) > kConvexTolerance;
    });
}

/// Whether every border of each leaf has no point of the other leaf in front, up to the tolerance.
bool IsUnionConvex(const PortalGraph &graph, int i, int j) {
    const std::vector<Border> bordersI = BordersOf(graph, i, j), bordersJ = BordersOf(graph, j, i);
    for (const Border &a : bordersI)
        for (const Border &b : bordersJ)
            if (AnyInFront(*a.winding, *b.plane) || AnyInFront(*b.winding, *a.plane))
                return false;
    return true;
}

/// Marks the portals of a leaf that lead to `other` as removed; returns the remaining ones.
std::vector<int> KeptPortals(PortalGraph &graph, int leaf, int other) {
    std::vector<int> kept;
    for (const int p : graph.leafs[std::size_t(leaf)].portals) {
        GraphPortal &portal = graph.portals[std::size_t(p)];
        if (!portal.removed && portal.leaf == other)
            portal.removed = true;
        else if (!portal.removed)
            kept.push_back(p);
    }
    return kept;
}

bool TryMergeLeafs(PortalGraph &graph, int i, int j) {
    if (i == j || !IsUnionConvex(graph, i, j))
        return false;
    GraphLeaf &from = graph.leafs[std::size_t(i)], &into = graph.leafs[std::size_t(j)];
    std::vector<int> portals = KeptPortals(graph, i, j);
    const std::vector<int> rest = KeptPortals(graph, j, i);
    portals.insert(portals.end(), rest.begin(), rest.end());
    into.portals = std::move(portals);
    into.faces.insert(into.faces.begin(), std::make_move_iterator(from.faces.begin()),
                      std::make_move_iterator(from.faces.end()));
    from.portals.clear();
    from.faces.clear();
    from.mergedInto = j;
    for (GraphPortal &portal : graph.portals)
        if (!portal.removed)
            portal.leaf = graph.Root(portal.leaf);
    return true;
}

bool MergeLeafIntoAny(PortalGraph &graph, int leaf, bool keepHints) {
    const GraphLeaf &one = graph.leafs[std::size_t(leaf)];
    for (const int p : one.portals) {
        const GraphPortal &portal = graph.portals[std::size_t(p)];
        if (!portal.removed && !(keepHints && portal.hint) && TryMergeLeafs(graph, leaf, portal.leaf))
            return true;
    }
    return false;
}

bool SameCorner(const Vec3f &a, const Vec3f &b) {
    const Vec3f away = a - b;
    return std::abs(away.x) < kSamePoint && std::abs(away.y) < kSamePoint && std::abs(away.z) < kSamePoint;
}

/// Signed distance of `p` from the line through `origin` in direction `to - from`, in the plane of normal `n`; positive
/// on the outer side.
float DistanceOutside(const Vec3f &n, const Vec3f &from, const Vec3f &to, const Vec3f &p, const Vec3f &origin) {
    const Vec3f outward(Normalize(Vec3d(Cross(n, to - from))));
    return Dot(p - origin, outward);
}

/// The union of two polygons with a common edge, if it is convex within kCollinear. Edge i of `f`, which begins at
/// f[i], is edge j of `g` reversed.
std::optional<Winding<float>> Join(const Winding<float> &f, const Winding<float> &g, const Vec3f &normal) {
    const std::size_t m = f.size(), n = g.size();
    std::size_t i = 0, j = n;
    for (i = 0; i < m; ++i) {
        for (j = 0; j < n; ++j)
            if (SameCorner(f[i], g[(j + 1) % n]) && SameCorner(f[(i + 1) % m], g[j]))
                break;
        if (j < n)
            break;
    }
    if (i == m)
        return std::nullopt;
    // At each end of the common edge, the distance of the next corner of `g` from the next edge of `f`. If it is about
    // 0, the two edges are in line, and the end is no corner of the union.
    const Vec3f &p1 = f[i], &p2 = f[(i + 1) % m];
    const float first = DistanceOutside(normal, f[(i + m - 1) % m], p1, g[(j + 2) % n], p1);
    const float second = DistanceOutside(normal, p2, f[(i + 2) % m], g[(j + n - 1) % n], p2);
    if (first > kCollinear || second > kCollinear)
        return std::nullopt;
    const bool keepFirst = first < -kCollinear, keepSecond = second < -kCollinear;
    Winding<float> joined;
    for (std::size_t k = (i + 1) % m; k != i; k = (k + 1) % m)
        if (k != (i + 1) % m || keepSecond)
            joined.push_back(f[k]);
    for (std::size_t k = (j + 1) % n; k != j; k = (k + 1) % n)
        if (k != (j + 1) % n || keepFirst)
            joined.push_back(g[k]);
    if (joined.size() < 3 || joined.size() > std::size_t(kMaxPortalPoints))
        return std::nullopt;
    return joined;
}

bool JoinFirstPair(PortalGraph &graph, const GraphLeaf &leaf, MergedPortals &merged) {
    for (std::size_t a = 0; a < leaf.portals.size(); ++a) {
        GraphPortal &one = graph.portals[std::size_t(leaf.portals[a])];
        if (one.removed)
            continue;
        for (std::size_t b = a + 1; b < leaf.portals.size(); ++b) {
            GraphPortal &other = graph.portals[std::size_t(leaf.portals[b])];
            if (other.removed || other.leaf != one.leaf)
                continue;
            auto joined = Join(one.winding, other.winding, one.plane.normal);
            if (!joined)
                continue;
            one.winding = std::move(*joined);
            one.UpdateBoundingSphere();
            merged.pairs++;
            merged.hintPairs += one.hint && other.hint;
            one.hint |= other.hint;
            one.sky |= other.sky;
            one.joined = other.removed = true;
            return true;
        }
    }
    return false;
}

} // namespace

int MergeLeafs(PortalGraph &graph, bool keepHints) {
    int total = 0, count = 0;
    do {
        count = 0;
        for (std::size_t leaf = 0; leaf < graph.leafs.size(); ++leaf)
            if (graph.leafs[leaf].mergedInto < 0)
                count += MergeLeafIntoAny(graph, int(leaf), keepHints);
        total += count;
    } while (count > 0);
    return total;
}

MergedPortals MergePortals(PortalGraph &graph) {
    MergedPortals merged;
    for (const GraphLeaf &leaf : graph.leafs)
        if (leaf.mergedInto < 0)
            while (JoinFirstPair(graph, leaf, merged))
                continue;
    return merged;
}

} // namespace q3
