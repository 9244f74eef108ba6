// GPL-2.0-or-later. Portals between the leafs of the tree, and the .prt file.
#include "q3map2/tree/portals.h"

#include "common/error.h"
#include "q3map2/bspfile/prtfile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace q3 {

// ---- Portals: polygons between adjacent leafs ----

namespace {

constexpr double kPadding = 8;               ///< around the bounds of the tree, game units
constexpr double kNodeEpsilon = 0.001;       ///< for cuts by planes of nodes, game units
constexpr double kBorderEpsilon = 0.1;       ///< for cuts by portals around the node, game units
constexpr std::size_t kMaxPortals = 1 << 24; ///< bounds memory; chosen

Plane Flipped(const Plane &plane) {
    return {-plane.normal, -plane.dist};
}

/// On which sides of a plane a polygon has points.
struct Reach {
    bool front = false, back = false;
};

/// Sides of the plane on which the polygon has points farther than epsilon from the plane.
template <typename T> Reach ReachOf(const Winding<T> &w, const Plane &plane, double epsilon) {
    Reach reach;
    for (const Vec3<T> &p : w) {
        const double distance = plane.Distance(Vec3d(p));
        reach.front |= distance > epsilon, reach.back |= distance < -epsilon;
    }
    return reach;
}

void Chop(Winding<double> &w, const Plane &plane, double epsilon) {
    const Reach reach = ReachOf(w, plane, epsilon);
    if (!reach.front)
        w.clear();
    else if (reach.back)
        ChopPolygon(w, plane, epsilon);
}

/// Makes the portals of a tree from its head down. Until Make returns, a node's portal list is in order of addition,
/// with -1 for removed portals; loops go from the newest portal to the oldest.
class PortalMaker {
  public:
    PortalMaker(Tree &tree, const PlaneTable &planes, Log &log) : tree_(tree), planes_(planes), log_(log) {}
    void Make();
    int TinyCount() const { return tinyCount_; }

  private:
    TreeNode &Node(int number) { return tree_.nodes[std::size_t(number)]; }
    TreePortal &Portal(int number) { return tree_.portals[std::size_t(number)]; }

    void MakeHeadPortals();
    void SetBounds(int node);
    void MakeNodePortal(int node);
    void SplitNodePortals(int node);
    void SplitPortal(int portal, int node, const Plane &plane);
    int NewPortal(TreePortal portal);
    void Attach(int portal, int front, int back);
    void Detach(int portal);
    /// Clears a tiny polygon and counts it.
    void DropTiny(Polygon &polygon);

    Tree &tree_;
    const PlaneTable &planes_;
    Log &log_;
    std::vector<std::array<std::size_t, 2>> positions_; ///< of each portal in the lists of its two nodes
    int tinyCount_ = 0;
};

int PortalMaker::NewPortal(TreePortal portal) {
    if (tree_.portals.size() >= kMaxPortals)
        throw Error("the tree has more than {} portals: make brushes detail", kMaxPortals);
    tree_.portals.push_back(std::move(portal));
    positions_.emplace_back();
    return int(tree_.portals.size()) - 1;
}

void PortalMaker::Attach(int portal, int front, int back) {
    Portal(portal).nodes = {front, back};
    for (std::size_t side = 0; side < 2; side++) {
        std::vector<int> &list = Node(Portal(portal).nodes[side]).portals;
        positions_[std::size_t(portal)][side] = list.size();
        list.push_back(portal);
    }
}

void PortalMaker::Detach(int portal) {
    for (std::size_t side = 0; side < 2; side++)
        Node(Portal(portal).nodes[side]).portals[positions_[std::size_t(portal)][side]] = -1;
    Portal(portal).nodes = {-1, -1};
}

void PortalMaker::DropTiny(Polygon &polygon) {
    if (!polygon.empty() && IsTiny(polygon))
        polygon.clear(), tinyCount_++;
}

void PortalMaker::MakeHeadPortals() {
    tree_.outside = int(tree_.nodes.size());
    tree_.nodes.emplace_back();
    std::array<Plane, 6> sides; // facing inwards: at the least x, y, z, then at the greatest
    for (std::size_t axis = 0; axis < 3; axis++) {
        sides[axis].normal[axis] = 1;
        sides[axis].dist = double(float(double(tree_.bounds.mins[axis]) - kPadding));
        sides[axis + 3].normal[axis] = -1;
        sides[axis + 3].dist = -double(float(double(tree_.bounds.maxs[axis]) + kPadding));
    }
    for (const std::size_t i : std::array<std::size_t, 6>{0, 3, 1, 4, 2, 5}) {
        TreePortal portal;
        portal.plane = sides[i];
        portal.polygon = BasePolygon(sides[i]);
        for (std::size_t j = 0; j < 6; j++)
            if (j != i)
                ChopPolygon(portal.polygon, sides[j], kBorderEpsilon);
        Attach(NewPortal(std::move(portal)), tree_.head, tree_.outside);
    }
}

void PortalMaker::SetBounds(int node) {
    Boundsf bounds;
    for (const int portal : Node(node).portals)
        if (portal >= 0)
            for (const Vec3f &p : Portal(portal).polygon)
                bounds.Add(p);
    if (bounds.Empty() || bounds.mins.x >= bounds.maxs.x) {
        log_.Warn("node without volume", "a node of the tree has no volume ({} tiny portals so far)", tinyCount_);
        // A node without portals gets an empty box at the corner of its parent's box.
        const int parent = Node(node).parent;
        const Vec3f corner = parent >= 0 ? Node(parent).bounds.mins : Vec3f{};
        if (bounds.Empty())
            bounds.Add(corner);
    }
    for (std::size_t axis = 0; axis < 3; axis++)
        if (double(bounds.mins[axis]) < -kMaxWorldCoord || double(bounds.maxs[axis]) > kMaxWorldCoord) {
            log_.Warn("node outside the world", "a node of the tree reaches out of the world, beyond {}",
                      kMaxWorldCoord);
            break;
        }
    Node(node).bounds = bounds;
}

void PortalMaker::MakeNodePortal(int node) {
    const Plane &plane = planes_[Node(node).planeNum];
    Winding<double> exact = BaseWinding(plane);
    int child = node;
    for (int at = Node(node).parent; at >= 0 && !exact.empty(); child = at, at = Node(at).parent) {
        const Plane &cut = planes_[Node(at).planeNum];
        Chop(exact, Node(at).children[0] == child ? cut : Flipped(cut), kNodeEpsilon);
    }
    const std::vector<int> &list = Node(node).portals;
    for (auto it = list.rbegin(); it != list.rend() && !exact.empty(); ++it)
        if (*it >= 0) {
            const TreePortal &portal = Portal(*it);
            Chop(exact, portal.nodes[0] == node ? portal.plane : Flipped(portal.plane), kBorderEpsilon);
        }
    Polygon polygon;
    for (const Vec3d &p : exact)
        polygon.emplace_back(p);
    DropTiny(polygon);
    if (polygon.empty())
        return;
    TreePortal portal;
    portal.polygon = std::move(polygon);
    portal.plane = plane;
    portal.planeNum = Node(node).planeNum;
    portal.onNode = node;
    portal.compileFlags = Node(node).compileFlags;
    Attach(NewPortal(std::move(portal)), Node(node).children[0], Node(node).children[1]);
}

void PortalMaker::SplitPortal(int number, int node, const Plane &plane) {
    const std::size_t side = Portal(number).nodes[0] == node ? 0 : 1;
    const int other = Portal(number).nodes[1 - side];
    const auto attach = [&](int portal, int child) {
        if (side == 0)
            Attach(portal, child, other);
        else
            Attach(portal, other, child);
    };
    Detach(number);
    const auto children = Node(node).children;
    const Reach reach = ReachOf(Portal(number).polygon, plane, kNodeEpsilon);
    if (!reach.front || !reach.back) {
        attach(number, children[reach.front ? 0 : 1]);
        return;
    }
    Polygon front, back;
    ClipPolygonKeepOn(Portal(number).polygon, plane, kNodeEpsilon, front, back);
    DropTiny(front), DropTiny(back);
    if (front.empty() && back.empty())
        Portal(number).polygon.clear();
    else if (front.empty())
        attach(number, children[1]);
    else if (back.empty())
        attach(number, children[0]);
    else {
        TreePortal piece = Portal(number);
        piece.polygon = std::move(back);
        Portal(number).polygon = std::move(front);
        const int added = NewPortal(std::move(piece));
        attach(number, children[0]);
        attach(added, children[1]);
    }
}

void PortalMaker::SplitNodePortals(int node) {
    const Plane &plane = planes_[Node(node).planeNum];
    // SplitPortal adds to lists of the children and of other nodes. In this node's list it only writes -1.
    for (std::size_t i = Node(node).portals.size(); i-- > 0;)
        if (const int portal = Node(node).portals[i]; portal >= 0)
            SplitPortal(portal, node, plane);
    Node(node).portals = {};
}

void PortalMaker::Make() {
    MakeHeadPortals();
    std::vector<int> pending{tree_.head};
    while (!pending.empty()) {
        const int node = pending.back();
        pending.pop_back();
        SetBounds(node);
        if (Node(node).IsLeaf())
            continue;
        MakeNodePortal(node);
        SplitNodePortals(node);
        pending.push_back(Node(node).children[1]);
        pending.push_back(Node(node).children[0]);
    }
    for (TreeNode &node : tree_.nodes) {
        std::erase(node.portals, -1);
        std::reverse(node.portals.begin(), node.portals.end());
    }
}

} // namespace

void MakePortals(Tree &tree, const PlaneTable &planes, const BspContext &context) {
    context.log.VerboseSection("MakeTreePortals");
    PortalMaker maker(tree, planes, context.log);
    maker.Make();
    context.log.VerboseCount(maker.TinyCount(), "tiny portals");
}

bool IsPassable(const Tree &tree, const TreePortal &portal) {
    if (portal.onNode < 0 || (portal.compileFlags & C_ANTIPORTAL))
        return false;
    return !tree.nodes[std::size_t(portal.nodes[0])].opaque && !tree.nodes[std::size_t(portal.nodes[1])].opaque;
}

// ---- The .prt file, input of the vis stage ----

namespace {

class PortalFileWriter {
  public:
    explicit PortalFileWriter(const Tree &tree) : tree_(tree) {}
    std::string Text(int clusters);

  private:
    void AddLeaf(int leaf);
    void AddPortal(const TreePortal &portal);
    void AddSolidFace(const TreePortal &portal, int leaf);
    static void AppendPoints(std::string &text, const Polygon &polygon);

    const Tree &tree_;
    std::string portals_, faces_;
    int portalCount_ = 0, faceCount_ = 0;
};

/// Coordinates this near to a whole number are written as that number. Game units.
constexpr double kWholeTolerance = 0.001;

void PortalFileWriter::AppendPoints(std::string &text, const Polygon &polygon) {
    for (const Vec3f &p : polygon) {
        text += '(';
        for (std::size_t axis = 0; axis < 3; axis++) {
            const double value = double(p[axis]), whole = std::rint(value);
            if (std::abs(value - whole) < kWholeTolerance)
                fmt::format_to(std::back_inserter(text), "{} ", static_cast<long long>(whole));
            else
                fmt::format_to(std::back_inserter(text), "{:f} ", value);
        }
        text += ") ";
    }
    text += '\n';
}

void PortalFileWriter::AddPortal(const TreePortal &portal) {
    constexpr double kSameFacing = 0.99; // cosine of the angle between the two normals
    // Readers compute the plane from the first three points. If these give a flipped plane, swaps the clusters.
    int front = tree_.nodes[std::size_t(portal.nodes[0])].cluster;
    int back = tree_.nodes[std::size_t(portal.nodes[1])].cluster;
    const Polygon &w = portal.polygon;
    const Vec3d normal = Normalize(Cross(Vec3d(w[2]) - Vec3d(w[0]), Vec3d(w[1]) - Vec3d(w[0])));
    if (Dot(portal.plane.normal, normal) < kSameFacing)
        std::swap(front, back);
    const int flags =
        (portal.compileFlags & C_HINT ? kPrtHintFlag : 0) | (portal.compileFlags & C_SKY ? kPrtSkyFlag : 0);
    fmt::format_to(std::back_inserter(portals_), "{} {} {} {} ", w.size(), front, back, flags);
    AppendPoints(portals_, w);
    portalCount_++;
}

void PortalFileWriter::AddSolidFace(const TreePortal &portal, int leaf) {
    fmt::format_to(std::back_inserter(faces_), "{} {} ", portal.polygon.size(), tree_.nodes[std::size_t(leaf)].cluster);
    AppendPoints(faces_, portal.nodes[0] == leaf ? portal.polygon : Reversed(portal.polygon));
    faceCount_++;
}

void PortalFileWriter::AddLeaf(int leaf) {
    const TreeNode &node = tree_.nodes[std::size_t(leaf)];
    if (node.opaque)
        return;
    for (const int number : node.portals) {
        const TreePortal &portal = tree_.portals[std::size_t(number)];
        if (tree_.nodes[std::size_t(portal.nodes[0])].cluster == tree_.nodes[std::size_t(portal.nodes[1])].cluster)
            continue;
        if (!IsPassable(tree_, portal))
            AddSolidFace(portal, leaf);
        else if (portal.nodes[0] == leaf)
            AddPortal(portal);
    }
}

std::string PortalFileWriter::Text(int clusters) {
    std::vector<int> pending{tree_.head};
    while (!pending.empty()) {
        const int at = pending.back();
        pending.pop_back();
        const TreeNode &node = tree_.nodes[std::size_t(at)];
        if (node.IsLeaf()) {
            AddLeaf(at);
            continue;
        }
        pending.push_back(node.children[1]);
        pending.push_back(node.children[0]);
    }
    return fmt::format("PRT1\n{}\n{}\n{}\n", clusters, portalCount_, faceCount_) + portals_ + faces_;
}

} // namespace

std::string PortalFileText(const Tree &tree, int clusters) {
    return PortalFileWriter(tree).Text(clusters);
}

} // namespace q3
