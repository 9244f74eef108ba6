// GPL-2.0-or-later. Adds brushes to the leafs that they reach.
#include "q3map2/tree/brush_filter.h"

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

namespace q3 {

namespace {

constexpr double kMinVolume = 1;  ///< smaller fragments are dropped, cubic units
constexpr double kMinOverlap = 1; ///< least overlap of an area portal side and a portal, game units

/// Part of a brush, cut by planes of tree nodes.
struct BrushFragment {
    struct Side {
        int planeNum = -1;
        Polygon polygon;
    };
    std::vector<Side> sides;
};

BrushFragment WholeBrush(const Brush &brush) {
    BrushFragment whole;
    for (const BrushSide &side : brush.sides)
        if (!side.winding.empty())
            whole.sides.push_back({side.planeNum, side.winding});
    return whole;
}

/// Cubic units: the sum over sides of (distance of the side from a corner) (area of the side) / 3.
double VolumeOf(const BrushFragment &piece, const PlaneTable &planes) {
    if (piece.sides.empty())
        return 0;
    const Vec3d corner(piece.sides[0].polygon[0]);
    double sum = 0;
    for (std::size_t i = 1; i < piece.sides.size(); i++)
        sum -= planes[piece.sides[i].planeNum].Distance(corner) * WindingArea(piece.sides[i].polygon);
    return sum / 3;
}

/// Whether the piece has at least three sides (its section is added later), and bounds with a volume inside the world.
bool IsSolid(const BrushFragment &piece) {
    if (piece.sides.size() < 3)
        return false;
    Boundsf bounds;
    for (const BrushFragment::Side &side : piece.sides)
        bounds.Add(WindingBounds(side.polygon));
    for (std::size_t axis = 0; axis < 3; axis++)
        if (double(bounds.mins[axis]) < -kMaxWorldCoord || double(bounds.maxs[axis]) > kMaxWorldCoord ||
            bounds.mins[axis] >= bounds.maxs[axis])
            return false;
    return true;
}

/// Least and greatest signed distance of the piece from the plane; the range always includes 0.
std::pair<double, double> DistanceRange(const BrushFragment &piece, const Plane &plane) {
    double low = 0, high = 0;
    for (const BrushFragment::Side &side : piece.sides)
        for (const Vec3f &p : side.polygon) {
            const double d = plane.Distance(Vec3d(p));
            low = std::min(low, d), high = std::max(high, d);
        }
    return {low, high};
}

/// The polygon in which the plane cuts the piece.
Polygon SectionOf(const BrushFragment &piece, const Plane &plane, const PlaneTable &planes) {
    Winding<double> section = BaseWinding(plane);
    for (const BrushFragment::Side &side : piece.sides) {
        if (section.empty())
            break;
        ChopPolygon(section, planes[OppositePlane(side.planeNum)], 0.0);
    }
    Polygon rounded;
    for (const Vec3d &p : section)
        rounded.emplace_back(p);
    return rounded;
}

/// Splits the fragment into front and back part; empty where there is none.
std::array<std::optional<BrushFragment>, 2> SplitPiece(BrushFragment piece, int planeNum, const PlaneTable &planes) {
    std::array<std::optional<BrushFragment>, 2> halves;
    const Plane &plane = planes[planeNum];
    const auto [low, high] = DistanceRange(piece, plane);
    if (high < kSideEpsilon || low > -kSideEpsilon) {
        halves[high < kSideEpsilon ? 1 : 0] = std::move(piece);
        return halves;
    }
    const Polygon section = SectionOf(piece, plane, planes);
    if (section.empty() || IsTiny(section)) {
        halves[high >= -low ? 0 : 1] = std::move(piece);
        return halves;
    }
    std::array<BrushFragment, 2> parts;
    for (const BrushFragment::Side &side : piece.sides) {
        std::array<Polygon, 2> cut;
        ClipPolygon(side.polygon, plane, 0.0, cut[0], cut[1]);
        for (std::size_t i = 0; i < 2; i++)
            if (!cut[i].empty())
                parts[i].sides.push_back({side.planeNum, std::move(cut[i])});
    }
    const bool hasFront = IsSolid(parts[0]), hasBack = IsSolid(parts[1]);
    if (!hasFront && !hasBack)
        return halves;
    if (!hasFront || !hasBack) {
        halves[hasFront ? 0 : 1] = std::move(piece);
        return halves;
    }
    parts[0].sides.push_back({OppositePlane(planeNum), Reversed(section)});
    parts[1].sides.push_back({planeNum, section});
    for (std::size_t i = 0; i < 2; i++)
        if (VolumeOf(parts[i], planes) >= kMinVolume)
            halves[i] = std::move(parts[i]);
    return halves;
}

/// Least and greatest coordinate of the points along the axis.
std::pair<double, double> ExtentAlong(const Polygon &polygon, const Vec3d &axis) {
    std::pair<double, double> extent{Dot(axis, Vec3d(polygon[0])), Dot(axis, Vec3d(polygon[0]))};
    for (const Vec3f &p : polygon) {
        const double d = Dot(axis, Vec3d(p));
        extent = {std::min(extent.first, d), std::max(extent.second, d)};
    }
    return extent;
}

/// Whether along the normal of an edge of `edges` the two coplanar polygons overlap by less than kMinOverlap.
bool EdgeAxisSeparates(const Polygon &edges, const Polygon &other, const Vec3d &normal) {
    for (std::size_t i = 0; i < edges.size(); i++) {
        const Vec3d along = Vec3d(edges[(i + 1) % edges.size()]) - Vec3d(edges[i]);
        const Vec3d axis = Normalize(Cross(normal, along));
        const auto [low, high] = ExtentAlong(edges, axis);
        const auto [otherLow, otherHigh] = ExtentAlong(other, axis);
        if (axis != Vec3d{} && (low > otherHigh - kMinOverlap || otherLow > high - kMinOverlap))
            return true;
    }
    return false;
}

/// Marks the portals of a leaf that lie in area portal sides of the brush. Their own flag may be missing: another face
/// in the same plane may have made the split.
void MarkAreaPortals(const Brush &brush, Tree &tree, int leaf, const PlaneTable &planes) {
    for (const BrushSide &side : brush.sides) {
        if (!(side.compileFlags & C_AREAPORTAL) || side.winding.empty())
            continue;
        for (const int number : tree.nodes[std::size_t(leaf)].portals) {
            TreePortal &portal = tree.portals[std::size_t(number)];
            if (portal.onNode >= 0 && EvenPlane(portal.planeNum) == EvenPlane(side.planeNum) &&
                !EdgeAxisSeparates(side.winding, portal.polygon, planes[side.planeNum].normal) &&
                !EdgeAxisSeparates(portal.polygon, side.winding, planes[side.planeNum].normal))
                portal.compileFlags |= C_AREAPORTAL;
        }
    }
}

/// Descends the tree with brushes.
class BrushFilter {
  public:
    BrushFilter(const Tree &tree, const PlaneTable &planes) : tree_(tree), planes_(planes) {}
    /// Calls `reached` with every leaf that the brush reaches.
    template <typename Reached> void Add(const Brush &brush, const Reached &reached);
    void Report(Log &log, std::string_view name) const;

  private:
    const Tree &tree_;
    const PlaneTable &planes_;
    long long brushCount_ = 0, referenceCount_ = 0, lostCount_ = 0;
};

template <typename Reached> void BrushFilter::Add(const Brush &brush, const Reached &reached) {
    brushCount_++;
    std::vector<std::pair<int, BrushFragment>> pending;
    pending.emplace_back(tree_.head, WholeBrush(brush));
    while (!pending.empty()) {
        auto [at, piece] = std::move(pending.back());
        pending.pop_back();
        const TreeNode &node = tree_.nodes[std::size_t(at)];
        if (node.IsLeaf()) {
            reached(at);
            referenceCount_++;
            continue;
        }
        auto halves = SplitPiece(std::move(piece), node.planeNum, planes_);
        for (const std::size_t i : {std::size_t(1), std::size_t(0)})
            if (halves[i])
                pending.emplace_back(node.children[i], std::move(*halves[i]));
        if (!halves[0] && !halves[1])
            lostCount_++;
    }
}

void BrushFilter::Report(Log &log, std::string_view name) const {
    log.VerboseCount(brushCount_, name);
    log.VerboseCount(referenceCount_, "cluster references");
    if (lostCount_ > 0)
        log.VerboseCount(lostCount_, "pieces of brushes too thin to split");
}

/// Inserts at the front: leafs list their newest brush first, and engines test it first.
void PushBrush(TreeNode &leaf, std::size_t brush) {
    leaf.brushes.insert(leaf.brushes.begin(), int(brush));
}

} // namespace

void FilterStructuralBrushes(const MapEntity &entity, Tree &tree, PlaneTable &planes, const BspContext &context) {
    context.log.VerboseSection("FilterStructuralBrushesIntoTree");
    BrushFilter filter(tree, planes);
    for (std::size_t i = 0; i < entity.brushes.size(); i++) {
        const Brush &brush = entity.brushes[i];
        if (brush.detail)
            continue;
        filter.Add(brush, [&](int leaf) {
            TreeNode &node = tree.nodes[std::size_t(leaf)];
            PushBrush(node, i);
            if (brush.opaque)
                node.opaque = true;
            else if (brush.compileFlags & C_AREAPORTAL)
                MarkAreaPortals(brush, tree, leaf, planes);
        });
    }
    filter.Report(context.log, "structural brushes");
}

void FilterDetailBrushes(const MapEntity &entity, Tree &tree, PlaneTable &planes, const BspContext &context) {
    context.log.VerboseSection("FilterDetailBrushesIntoTree");
    BrushFilter filter(tree, planes);
    for (std::size_t i = 0; i < entity.brushes.size(); i++)
        if (entity.brushes[i].detail)
            filter.Add(entity.brushes[i], [&](int leaf) { PushBrush(tree.nodes[std::size_t(leaf)], i); });
    filter.Report(context.log, "detail brushes");
}

} // namespace q3
