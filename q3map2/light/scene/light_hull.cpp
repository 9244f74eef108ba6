// GPL-2.0-or-later. The closed surface of everything solid, from the BSP tree.
#include "q3map2/light/scene/light_hull.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Half the side of the square in a node's plane that clipping starts from. Game units; engines' worlds end at 131072.
constexpr double kWorldHalfSize = 262144;
/// Corners within this distance of a plane count as on it. Game units; below the 1/8 that editors snap to.
constexpr double kClipEpsilon = 0.01;
/// Polygons grow by this much in their plane, so that rays cannot pass between them. Game units; a quarter of what
/// points of the grid keep clear of solids.
constexpr double kOverlap = 0.03;
/// Smaller polygons are rounding noise. Square units.
constexpr double kMinArea = 0.01;

Plane PlaneOf(const Bsp &bsp, const bspNode_t &node) {
    const bspPlane_t &plane = bsp.planes[std::size_t(node.planeNum)];
    return {Vec3d(plane.normal), double(plane.dist)};
}

void Grow(Winding<double> &w) {
    const Vec3d normal = Normalize(WindingAreaVector(w));
    Winding<double> grown = w;
    const auto outward = [&](std::size_t i) { return Normalize(Cross(w[(i + 1) % w.size()] - w[i], normal)); };
    for (std::size_t i = 0; i < w.size(); ++i)
        grown[i] += (outward(i) + outward((i + w.size() - 1) % w.size())) * kOverlap;
    w = std::move(grown);
}

} // namespace

std::vector<bool> SolidLeafs(const Bsp &bsp) {
    std::vector<bool> solid(bsp.leafs.size());
    for (std::size_t i = 0; i < solid.size(); ++i)
        solid[i] = bsp.leafs[i].cluster < 0;
    return solid;
}

void CountTriangles(TreeWalk<double> &tree, const TriangleCorners &triangle, double epsilon, std::vector<int> &counts) {
    const Vec3d facing = -WindingAreaVector(triangle); // clockwise seen from the front
    tree.Walk(
        tree.Root(), triangle, epsilon,
        [&](const bspPlane_t &plane) {
            return Dot(facing, Vec3d(plane.normal)) > 0 ? CoplanarSide::Front : CoplanarSide::Back;
        },
        [&](const Winding<double> &piece, std::size_t leaf) {
            counts[leaf] += int(piece.size()) - 2;
            return true;
        });
}

bool SolidBehind(TreeWalk<double> &tree, const TriangleCorners &triangle, const std::vector<bool> &solidLeafs,
                 const std::vector<bool> &secondSolidLeafs, bool &solidInSecond) {
    const Vec3d facing = -WindingAreaVector(triangle);
    solidInSecond = true;
    return tree.Walk(
        tree.Root(), triangle, kClipEpsilon,
        [&](const bspPlane_t &plane) {
            return Dot(facing, Vec3d(plane.normal)) > 0 ? CoplanarSide::Back : CoplanarSide::Front;
        },
        [&](const Winding<double> &, std::size_t leaf) {
            solidInSecond = solidInSecond && secondSolidLeafs[leaf];
            return bool(solidLeafs[leaf]);
        });
}

namespace {

/// Adds the faces of hulls, node by node: they lie in the planes of nodes.
class HullFaces {
  public:
    HullFaces(const Bsp &bsp, std::span<SolidHull> hulls);
    /// Adds the faces in the plane of one node.
    void Add(int node);

  private:
    bool ClipToNode(int number, Winding<double> &w);
    void Keep(Winding<double> &piece, std::size_t frontLeaf, std::size_t backLeaf);

    const Bsp &bsp_;
    std::span<SolidHull> hulls_;
    std::vector<int> parents_; // by node; -1: none
    TreeWalk<double> front_, back_;
    WindingCutter<double> cutter_;
    Winding<double> part_;
};

HullFaces::HullFaces(const Bsp &bsp, std::span<SolidHull> hulls)
    : bsp_(bsp), hulls_(hulls), parents_(bsp.nodes.size(), -1), front_(bsp), back_(bsp) {
    for (std::size_t i = 0; i < bsp.nodes.size(); ++i)
        for (const int child : bsp.nodes[i].children)
            if (child >= 0)
                parents_[std::size_t(child)] = int(i);
}

/// Clips the polygon by the planes of all ancestors of the node, to the node's region. False when nothing is left.
bool HullFaces::ClipToNode(int number, Winding<double> &w) {
    for (int child = number, up = parents_[std::size_t(number)]; up >= 0; child = up, up = parents_[std::size_t(up)]) {
        const bspNode_t &node = bsp_.nodes[std::size_t(up)];
        const Plane plane = PlaneOf(bsp_, node);
        cutter_.Classify(w, plane.normal, plane.dist, kClipEpsilon);
        const bool inFront = cutter_.AnyFront() || !cutter_.AnyBack(); // in the plane: in front
        if (node.children[0] == child ? !inFront : !cutter_.AnyBack())
            return false;
        if (!cutter_.AnyFront() || !cutter_.AnyBack())
            continue;
        if (node.children[0] == child)
            cutter_.Front(w, part_);
        else
            cutter_.Back(w, part_);
        std::swap(w, part_);
        if (w.empty())
            return false;
    }
    return true;
}

void HullFaces::Keep(Winding<double> &piece, std::size_t frontLeaf, std::size_t backLeaf) {
    const auto between = [&](const SolidHull &hull) { return hull.solidLeafs[frontLeaf] != hull.solidLeafs[backLeaf]; };
    if (std::none_of(hulls_.begin(), hulls_.end(), between) || WindingArea(piece) < kMinArea)
        return;
    Grow(piece);
    for (SolidHull &hull : hulls_)
        if (between(hull))
            hull.faces.push_back(piece);
}

void HullFaces::Add(int node) {
    Winding<double> w = WindingInPlane(PlaneOf(bsp_, bsp_.nodes[std::size_t(node)]), kWorldHalfSize);
    if (!ClipToNode(node, w))
        return;
    const auto toFront = [](const bspPlane_t &) { return CoplanarSide::Front; };
    const auto &children = bsp_.nodes[std::size_t(node)].children;
    front_.Walk(children[0], w, kClipEpsilon, toFront, [&](const Winding<double> &piece, std::size_t frontLeaf) {
        return back_.Walk(children[1], piece, kClipEpsilon, toFront, [&](Winding<double> &small, std::size_t backLeaf) {
            Keep(small, frontLeaf, backLeaf);
            return true;
        });
    });
}

} // namespace

void SolidHulls(const Bsp &bsp, std::span<SolidHull> hulls) {
    HullFaces faces(bsp, hulls);
    for (std::size_t i = 0; i < bsp.nodes.size(); ++i)
        faces.Add(int(i));
}

} // namespace q3
