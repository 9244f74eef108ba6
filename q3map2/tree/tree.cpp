// GPL-2.0-or-later. The BSP tree of the bsp stage: faces, choice of planes, recursion.
#include "q3map2/tree/tree.h"

#include "common/error.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace q3 {

// ---- The tree, split by the planes of the highest score ----

namespace {

constexpr double kClipEpsilon = 0.2;                    ///< game units
constexpr std::size_t kMaxNodes = std::size_t(1) << 20; ///< a million, which bounds time and memory
/// Budget of plane-face tests for a node; reached with tens of thousands of tilted brushes. Once it is spent, only
/// kSampledPlanes of the remaining candidate planes, evenly spaced, are tested.
constexpr std::int64_t kTestBudget = std::int64_t(1) << 20;
constexpr std::size_t kSampledPlanes = 32;
/// Score of a plane: kScorePerFace for each face on it, minus as much for each face that it cuts, plus kAxialBonus if
/// it is axial, plus the highest priority of its faces. With -altsplit: kAltBase minus the number of nodes that it
/// splits already, minus its faces, minus kScorePerFace for each cut, minus the difference of the numbers of faces on
/// both sides, plus the highest sum of priority and kAltAreaBonus times area (square game units) of its faces.
constexpr double kScorePerFace = 5, kAxialBonus = 5, kAltBase = 20000, kAltAreaBonus = 10;

class TreeBuilder {
  public:
    TreeBuilder(std::vector<TreeFace> faces, const std::array<int, 3> &blockSize, PlaneTable &planes,
                const BspOptions &options)
        : faces_(std::move(faces)), blockSize_(blockSize), planes_(planes), options_(options) {}
    Tree Build();

  private:
    struct Choice {
        int planeNum = -1;
        std::uint32_t flags = 0;
    };
    /// A pending node: its faces in order and its box.
    struct Pending {
        int node = 0;
        std::vector<int> faces;
        Boundsf bounds;
    };
    /// Faces of a list that lie on one plane.
    struct PlaneGroup {
        int planeNum = 0;
        int faceCount = 0;
        std::size_t bestFace = 0; ///< position in the list of the face with the highest bonus
        double bonus = 0;         ///< of that face
        double maxScore = 0;      ///< upper bound of the plane's score
    };

    Pending Root();
    Choice BlockSplit(const Boundsf &bounds) const;
    Choice ChooseSplit(const std::vector<int> &list);
    void FillGroups(const std::vector<int> &list);
    double MaxScore(const PlaneGroup &group) const;
    double Score(const PlaneGroup &group, const std::vector<int> &list, double toBeat);
    double BonusOf(const TreeFace &face) const;
    PolygonSide SideOfFace(int face, int planeNum) const;
    void SplitFace(int number, const Plane &plane, std::array<std::vector<int>, 2> &parts);
    void Partition(const Pending &work, int planeNum, std::array<std::vector<int>, 2> &parts);
    std::array<Boundsf, 2> CutBounds(const Boundsf &bounds, int planeNum) const;

    std::vector<TreeFace> faces_;
    std::vector<Boundsf> faceBounds_;
    const std::array<int, 3> &blockSize_;
    PlaneTable &planes_;
    const BspOptions &options_;
    std::vector<PlaneGroup> groups_;
    std::unordered_map<int, std::size_t> groupOf_; ///< index in groups_ by plane
    std::unordered_map<int, int> nodesSplitBy_;    ///< number of nodes split by a plane
    std::int64_t sideTests_ = 0;                   ///< see Tree::sideTests
};

TreeBuilder::Choice TreeBuilder::BlockSplit(const Boundsf &bounds) const {
    for (std::size_t axis = 0; axis < 3; axis++) {
        const double block = blockSize_[axis];
        if (block <= 0)
            continue;
        const double cut = block * (std::floor(double(bounds.mins[axis]) / block) + 1);
        if (double(bounds.maxs[axis]) > cut) {
            Vec3d normal;
            normal[axis] = 1;
            return {planes_.Find(normal, cut), 0};
        }
    }
    return {};
}

double TreeBuilder::BonusOf(const TreeFace &face) const {
    return face.priority + (options_.altSplit ? kAltAreaBonus * WindingArea(face.polygon) : 0);
}

void TreeBuilder::FillGroups(const std::vector<int> &list) {
    groups_.clear(), groupOf_.clear();
    for (std::size_t i = 0; i < list.size(); i++) {
        const TreeFace &face = faces_[std::size_t(list[i])];
        const double bonus = BonusOf(face);
        const auto [it, added] = groupOf_.try_emplace(face.planeNum, groups_.size());
        if (added)
            groups_.push_back({face.planeNum, 0, i, bonus, 0});
        PlaneGroup &group = groups_[it->second];
        group.faceCount++;
        if (bonus > group.bonus)
            group.bestFace = i, group.bonus = bonus;
    }
}

/// SideOf with a test of the bounding box first: most faces are clear of a plane.
PolygonSide TreeBuilder::SideOfFace(int face, int planeNum) const {
    const Plane &plane = planes_[planeNum];
    const Boundsf &box = faceBounds_[std::size_t(face)];
    double low = -plane.dist, high = -plane.dist;
    for (std::size_t axis = 0; axis < 3; axis++) {
        const double n = plane.normal[axis], a = n * double(box.mins[axis]), b = n * double(box.maxs[axis]);
        low += std::min(a, b), high += std::max(a, b);
    }
    constexpr double kSlack = 0.01; ///< far above what rounding does to the sums
    if (low > kSideEpsilon + kSlack)
        return PolygonSide::Front;
    if (high < -kSideEpsilon - kSlack)
        return PolygonSide::Back;
    return SideOf(faces_[std::size_t(face)].polygon, plane);
}

/// Upper bound of the score: as if the plane split no face.
double TreeBuilder::MaxScore(const PlaneGroup &group) const {
    if (!options_.altSplit)
        return kScorePerFace * group.faceCount + (planes_.IsAxial(group.planeNum) ? kAxialBonus : 0) + group.bonus;
    const auto used = nodesSplitBy_.find(group.planeNum);
    return kAltBase - (used == nodesSplitBy_.end() ? 0 : used->second) - group.faceCount + group.bonus;
}

/// Score of the plane, higher is better. Once it falls below `toBeat` counting stops: then only an upper bound.
double TreeBuilder::Score(const PlaneGroup &group, const std::vector<int> &list, double toBeat) {
    double score = group.maxScore;
    int front = 0, back = 0;
    for (const int face : list) {
        if (faces_[std::size_t(face)].planeNum == group.planeNum)
            continue;
        const PolygonSide side = SideOfFace(face, group.planeNum);
        sideTests_++;
        front += side == PolygonSide::Front;
        back += side == PolygonSide::Back;
        if (side == PolygonSide::Cross && (score -= kScorePerFace) < toBeat)
            break;
    }
    return options_.altSplit ? score - std::abs(front - back) : score;
}

TreeBuilder::Choice TreeBuilder::ChooseSplit(const std::vector<int> &list) {
    if (list.empty())
        return {};
    FillGroups(list);
    // By descending upper bound, so that most candidates end early.
    for (PlaneGroup &group : groups_)
        group.maxScore = MaxScore(group);
    std::sort(groups_.begin(), groups_.end(), [](const PlaneGroup &a, const PlaneGroup &b) {
        return a.maxScore != b.maxScore ? a.maxScore > b.maxScore : a.bestFace < b.bestFace;
    });
    const PlaneGroup *best = nullptr;
    double bestScore = std::numeric_limits<double>::lowest();
    const std::int64_t testLimit = sideTests_ + kTestBudget;
    for (std::size_t at = 0, step = 1; at < groups_.size(); at += step) {
        const PlaneGroup &group = groups_[at];
        if (best && group.maxScore < bestScore)
            break;
        if (best && group.maxScore == bestScore && group.bestFace > best->bestFace)
            continue;
        if (step == 1 && sideTests_ > testLimit)
            step = (groups_.size() - at) / kSampledPlanes + 1;
        const double score = Score(group, list, bestScore);
        if (!best || score > bestScore || (score == bestScore && group.bestFace < best->bestFace))
            best = &group, bestScore = score;
    }
    nodesSplitBy_[best->planeNum]++;
    return {best->planeNum, faces_[std::size_t(list[best->bestFace])].compileFlags};
}

/// Splits a face at the plane and appends the parts to the lists.
void TreeBuilder::SplitFace(int number, const Plane &plane, std::array<std::vector<int>, 2> &parts) {
    Polygon front, back;
    ClipPolygon(faces_[std::size_t(number)].polygon, plane, kClipEpsilon, front, back);
    if (!front.empty() && !back.empty()) {
        TreeFace piece = faces_[std::size_t(number)];
        faces_[std::size_t(number)].polygon = front;
        faceBounds_[std::size_t(number)] = WindingBounds(front);
        parts[0].push_back(number);
        parts[1].push_back(int(faces_.size()));
        piece.polygon = back;
        faces_.push_back(std::move(piece));
        faceBounds_.push_back(WindingBounds(back));
    } else if (!front.empty())
        parts[0].push_back(number);
    else if (!back.empty())
        parts[1].push_back(number);
}

void TreeBuilder::Partition(const Pending &work, int planeNum, std::array<std::vector<int>, 2> &parts) {
    const Plane plane = planes_[planeNum];
    for (const int number : work.faces) {
        if (faces_[std::size_t(number)].planeNum == EvenPlane(planeNum))
            continue;
        const PolygonSide side = SideOfFace(number, planeNum);
        if (side == PolygonSide::Front)
            parts[0].push_back(number);
        else if (side == PolygonSide::Back)
            parts[1].push_back(number);
        else if (side == PolygonSide::Cross)
            SplitFace(number, plane, parts);
    }
    // The order of NetRadiant's q3map2, which puts each face in front of a list: of faces with equal scores, the
    // first splits.
    for (auto &part : parts)
        std::reverse(part.begin(), part.end());
}

std::array<Boundsf, 2> TreeBuilder::CutBounds(const Boundsf &bounds, int planeNum) const {
    std::array<Boundsf, 2> cut{bounds, bounds};
    const Plane &plane = planes_[planeNum];
    for (std::size_t axis = 0; axis < 3; axis++)
        if (plane.normal[axis] == 1.0)
            cut[0].mins[axis] = cut[1].maxs[axis] = float(plane.dist);
    return cut;
}

/// All faces, and a box around them; around the origin when there are none.
TreeBuilder::Pending TreeBuilder::Root() {
    Pending root;
    for (std::size_t i = 0; i < faces_.size(); i++) {
        root.faces.push_back(int(i));
        faceBounds_.push_back(WindingBounds(faces_[i].polygon));
        root.bounds.Add(faceBounds_.back());
    }
    if (faces_.empty())
        root.bounds.Add(Vec3f{});
    return root;
}

Tree TreeBuilder::Build() {
    Tree tree;
    std::vector<Pending> pending;
    pending.push_back(Root());
    tree.bounds = pending.back().bounds;
    tree.nodes.emplace_back();
    while (!pending.empty()) {
        const Pending work = std::move(pending.back());
        pending.pop_back();
        Choice choice = BlockSplit(work.bounds);
        if (choice.planeNum < 0)
            choice = ChooseSplit(work.faces);
        if (choice.planeNum < 0)
            continue;
        if (tree.nodes.size() > kMaxNodes)
            throw Error("the tree has more than {} nodes: larger blocks (world key _blocksize) make fewer", kMaxNodes);
        std::array<std::vector<int>, 2> parts;
        Partition(work, choice.planeNum, parts);
        const auto bounds = CutBounds(work.bounds, choice.planeNum);
        const int firstChild = int(tree.nodes.size());
        TreeNode &node = tree.nodes[std::size_t(work.node)];
        node.planeNum = choice.planeNum;
        node.compileFlags = choice.flags;
        node.structural = !(choice.flags & C_DETAIL);
        node.children = {firstChild, firstChild + 1};
        tree.nodes.resize(tree.nodes.size() + 2);
        for (const std::size_t i : {std::size_t(1), std::size_t(0)}) { // the front is taken off the stack first
            tree.nodes[std::size_t(firstChild) + i].parent = work.node;
            pending.push_back({firstChild + int(i), std::move(parts[i]), bounds[i]});
        }
    }
    tree.sideTests = sideTests_;
    // Children come after their parents.
    for (std::size_t i = tree.nodes.size() - 1; i > 0; i--)
        if (tree.nodes[i].structural)
            tree.nodes[std::size_t(tree.nodes[i].parent)].structural = true;
    return tree;
}

} // namespace

int Tree::LeafAt(const Vec3f &p, const PlaneTable &planes) const {
    int node = head;
    while (!nodes[std::size_t(node)].IsLeaf()) {
        const TreeNode &at = nodes[std::size_t(node)];
        node = at.children[planes[at.planeNum].Distance(Vec3d(p)) >= 0 ? 0 : 1];
    }
    return node;
}

Tree BuildTree(std::vector<TreeFace> faces, const std::array<int, 3> &blockSize, PlaneTable &planes,
               const BspContext &context) {
    context.log.VerboseSection("FaceBSP");
    const std::size_t count = faces.size();
    Tree tree = TreeBuilder(std::move(faces), blockSize, planes, context.options).Build();
    context.log.VerboseCount(static_cast<long long>(count), "faces");
    const auto leafs =
        std::count_if(tree.nodes.begin(), tree.nodes.end(), [](const TreeNode &node) { return node.IsLeaf(); });
    context.log.VerboseCount(static_cast<long long>(tree.nodes.size()) - leafs, "nodes");
    context.log.VerboseCount(leafs, "leafs");
    return tree;
}

Tree SingleLeafTree(const Boundsf &bounds) {
    Tree tree;
    tree.nodes.emplace_back();
    tree.nodes[0].bounds = tree.bounds = bounds;
    return tree;
}

// ---- Faces that split the tree ----

namespace {

constexpr long long kMinSides = 4; ///< fewest sides that enclose a volume

/// Faces with higher priority split earlier: hints, other structural faces, area portals and antiportals, detail.
int PriorityOf(std::uint32_t flags) {
    int priority = 0;
    if (flags & C_HINT)
        priority += 1000;
    if (flags & C_ANTIPORTAL)
        priority -= 1000;
    if (flags & C_AREAPORTAL)
        priority -= 1000;
    if (flags & C_DETAIL)
        priority -= 3000;
    return priority;
}

/// The face takes the detail flag of the brush, not of the side.
TreeFace FaceOf(const Brush &brush, const BrushSide &side, const Polygon &polygon) {
    TreeFace face;
    face.polygon = polygon;
    face.planeNum = EvenPlane(side.planeNum);
    face.compileFlags = side.compileFlags & ~std::uint32_t(C_DETAIL);
    if (brush.detail)
        face.compileFlags |= C_DETAIL;
    face.priority = PriorityOf(face.compileFlags);
    return face;
}

/// Warns if the world has many brushes and more than 90 % of them are structural.
void WarnOfStructure(const MapEntity &world, const BspContext &context) {
    constexpr std::size_t kManyBrushes = 500;
    const auto structural = std::size_t(
        std::count_if(world.brushes.begin(), world.brushes.end(), [](const Brush &brush) { return !brush.detail; }));
    if (world.brushes.size() > kManyBrushes && structural * 10 > world.brushes.size() * 9)
        context.log.Warn(
            "structural brushes",
            "{} of {} brushes of the world are structural: detail brushes keep the tree small and vis fast", structural,
            world.brushes.size());
}

long long UsableSides(const Brush &brush) {
    return std::ranges::count_if(brush.sides, [](const BrushSide &side) { return !side.winding.empty(); });
}

} // namespace

bool HasFewSides(const Brush &brush) {
    return UsableSides(brush) < kMinSides;
}

std::vector<TreeFace> StructuralFaces(MapEntity &world, const BspContext &context) {
    std::vector<TreeFace> faces;
    WarnOfStructure(world, context);
    for (Brush &brush : world.brushes) {
        if (brush.detail && !context.options.deep)
            continue;
        if (!brush.detail && HasFewSides(brush)) {
            context.WarnAt("structural brush with few sides", brush.settings.entity, brush.primitive,
                           fmt::format("structural brush with {} usable sides becomes detail", UsableSides(brush)));
            brush.detail = true;
            continue;
        }
        for (const BrushSide &side : brush.sides)
            if (!side.winding.empty() && !(side.compileFlags & C_SKIP))
                faces.push_back(FaceOf(brush, side, side.winding));
    }
    std::reverse(faces.begin(), faces.end());
    return faces;
}

std::vector<TreeFace> VisibleFaces(const MapEntity &world, const BspContext &context) {
    std::vector<TreeFace> faces;
    for (const Brush &brush : world.brushes) {
        if (brush.detail && !context.options.deep)
            continue;
        for (const BrushSide &side : brush.sides)
            if (!side.visibleHull.empty() && !(side.compileFlags & C_SKIP))
                faces.push_back(FaceOf(brush, side, side.visibleHull));
    }
    std::reverse(faces.begin(), faces.end());
    return faces;
}

} // namespace q3
