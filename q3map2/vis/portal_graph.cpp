// GPL-2.0-or-later. The graph of leafs and portals, from a portal file.
#include "q3map2/vis/portal_graph.h"

#include "common/error.h"

#include <algorithm>

namespace q3 {

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
        forward.hint = winding.hint;
        forward.sky = winding.sky;
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

} // namespace q3
