// GPL-2.0-or-later. Adds draw surfaces to the leafs that they reach.
#include "q3map2/geometry/emit/emit_filter.h"

#include <algorithm>
#include <array>

namespace q3 {

namespace {

constexpr double kEpsilon = 0.1; // game units

/// Adds one surface to the leafs that its polygons and points reach.
class SurfaceFilter {
  public:
    SurfaceFilter(Tree &tree, const PlaneTable &planes, int number, bool &inSkyBox)
        : tree_(tree), planes_(planes), number_(number), inSkyBox_(inSkyBox) {}

    int Count() const { return count_; }
    /// `planeNum`: plane of the polygon; -1: unknown.
    void AddPolygon(Polygon polygon, int planeNum);
    void AddPoint(const Vec3f &p) { AddHull({&p, 1}); }
    /// Adds all leafs that the convex hull of the points may reach (conservative).
    void AddHull(std::span<const Vec3f> points);
    void AddEverywhere();

  private:
    void AddLeaf(TreeNode &leaf);
    std::vector<std::pair<int, Polygon>> Split(const TreeNode &node, const Polygon &polygon, int planeNum) const;

    Tree &tree_;
    const PlaneTable &planes_;
    int number_;
    bool &inSkyBox_;
    int count_ = 0;
    std::vector<int> stack_;
};

void SurfaceFilter::AddLeaf(TreeNode &leaf) {
    if (leaf.opaque)
        return;
    inSkyBox_ |= leaf.skyBox;
    ++count_;
    if (leaf.surfaces.empty() || leaf.surfaces.back() != number_)
        leaf.surfaces.push_back(number_);
}

/// Parts of a polygon in front of and behind the plane of a node.
std::vector<std::pair<int, Polygon>> SurfaceFilter::Split(const TreeNode &node, const Polygon &polygon,
                                                          int planeNum) const {
    if (planeNum >= 0 && planeNum == node.planeNum)
        return {{node.children[0], polygon}};
    if (planeNum >= 0 && (planeNum ^ 1) == node.planeNum)
        return {{node.children[1], polygon}};
    Polygon front, back;
    ClipPolygon(polygon, planes_[node.planeNum], kEpsilon, front, back);
    if (front.empty() && back.empty())
        return {{node.children[1], polygon}, {node.children[0], polygon}};
    std::vector<std::pair<int, Polygon>> parts;
    if (!back.empty())
        parts.emplace_back(node.children[1], std::move(back));
    if (!front.empty())
        parts.emplace_back(node.children[0], std::move(front));
    return parts;
}

void SurfaceFilter::AddPolygon(Polygon polygon, int planeNum) {
    std::vector<std::pair<int, Polygon>> stack;
    stack.emplace_back(tree_.head, std::move(polygon));
    while (!stack.empty()) {
        const auto [number, piece] = std::move(stack.back());
        stack.pop_back();
        TreeNode &node = tree_.nodes[std::size_t(number)];
        if (node.IsLeaf()) {
            AddLeaf(node);
            continue;
        }
        for (auto &part : Split(node, piece, planeNum))
            stack.push_back(std::move(part));
    }
}

void SurfaceFilter::AddHull(std::span<const Vec3f> points) {
    stack_.assign(1, tree_.head);
    while (!stack_.empty()) {
        TreeNode &node = tree_.nodes[std::size_t(stack_.back())];
        stack_.pop_back();
        if (node.IsLeaf()) {
            AddLeaf(node);
            continue;
        }
        const Plane &plane = planes_[node.planeNum];
        double least = plane.Distance(Vec3d(points[0])), most = least;
        for (const Vec3f &p : points.subspan(1)) {
            const double d = plane.Distance(Vec3d(p));
            least = std::min(least, d);
            most = std::max(most, d);
        }
        if (least <= kEpsilon)
            stack_.push_back(node.children[1]);
        if (most >= -kEpsilon)
            stack_.push_back(node.children[0]);
    }
}

void SurfaceFilter::AddEverywhere() {
    for (TreeNode &node : tree_.nodes)
        if (node.IsLeaf() && node.cluster >= 0)
            AddLeaf(node);
}

/// Points whose convex hull holds every level of detail of a 3 x 3 cell of a patch: its control points after degree
/// elevation to bicubic, which are nearer to the surface.
std::array<Vec3f, 16> CellHull(const DrawSurface &patch, int column, int row) {
    const auto elevate = [](const Vec3f &a, const Vec3f &b, const Vec3f &c) {
        return std::array<Vec3f, 4>{a, (a + b * 2.0f) / 3.0f, (b * 2.0f + c) / 3.0f, c};
    };
    const auto at = [&](int x, int y) { return patch.verts[std::size_t((row + y) * patch.width + column + x)].xyz; };
    std::array<std::array<Vec3f, 4>, 3> rows;
    for (int y = 0; y < 3; ++y)
        rows[std::size_t(y)] = elevate(at(0, y), at(1, y), at(2, y));
    std::array<Vec3f, 16> hull;
    for (std::size_t x = 0; x < 4; ++x) {
        const auto points = elevate(rows[0][x], rows[1][x], rows[2][x]);
        for (std::size_t y = 0; y < 4; ++y)
            hull[y * 4 + x] = points[y];
    }
    return hull;
}

Polygon PolygonOf(const DrawSurface &surface) {
    Polygon polygon;
    for (const DrawVert &vert : surface.verts)
        polygon.push_back(vert.xyz);
    return polygon;
}

/// Adds the leafs that a polygon may reach when deformVertexes moves it.
void AddMoving(const Polygon &polygon, const std::pair<Vec3f, Vec3f> &move, SurfaceFilter &filter) {
    std::vector<Vec3f> corners;
    for (const Vec3f &p : polygon)
        for (unsigned corner = 0; corner < 8; ++corner) {
            Vec3f moved = p;
            for (std::size_t axis = 0; axis < 3; ++axis)
                moved[axis] += (corner >> axis & 1) != 0 ? move.second[axis] : move.first[axis];
            corners.push_back(moved);
        }
    filter.AddHull(corners);
}

void AddPolygonOf(const DrawSurface &surface, Polygon polygon, int planeNum, SurfaceFilter &filter) {
    if (const auto &move = surface.shader->geometry.move)
        AddMoving(polygon, *move, filter);
    else
        filter.AddPolygon(std::move(polygon), planeNum);
}

void AddTriangles(const DrawSurface &surface, SurfaceFilter &filter) {
    for (std::size_t i = 0; i + 2 < surface.indexes.size(); i += 3) {
        Polygon triangle;
        for (std::size_t j = 0; j < 3; ++j)
            triangle.push_back(surface.verts[std::size_t(surface.indexes[i + j])].xyz);
        AddPolygonOf(surface, std::move(triangle), surface.planar ? surface.planeNum : -1, filter);
    }
    for (const DrawVert &vert : surface.verts)
        filter.AddPoint(vert.xyz);
}

} // namespace

int FilterSurface(const DrawSurface &surface, int number, Tree &tree, const PlaneTable &planes, bool &inSkyBox) {
    SurfaceFilter filter(tree, planes, number, inSkyBox);
    switch (surface.kind) {
    case SurfaceKind::Face:
    case SurfaceKind::Decal:
        AddPolygonOf(surface, PolygonOf(surface), surface.planeNum, filter);
        break;
    case SurfaceKind::Patch:
        for (int row = 0; row + 2 < surface.height; row += 2)
            for (int column = 0; column + 2 < surface.width; column += 2)
                filter.AddHull(CellHull(surface, column, row));
        break;
    case SurfaceKind::FogHull:
    case SurfaceKind::Shader:
        filter.AddEverywhere();
        break;
    case SurfaceKind::Flare:
        filter.AddPoint(surface.lightmapOrigin);
        break;
    case SurfaceKind::Foliage:
        for (std::size_t i = std::size_t(surface.height); i < surface.verts.size(); ++i)
            filter.AddPoint(surface.verts[i].xyz);
        break;
    default:
        AddTriangles(surface, filter);
        break;
    }
    return filter.Count();
}

} // namespace q3
