// GPL-2.0-or-later. Polygons and lines cut by the BSP tree: which parts lie in the open, and which solids are between
// two points.
#include "q3map2/light/scene/open_parts.h"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace q3 {

// ---- Which parts of a polygon, and how much of a segment, lie in the open ----

namespace {

constexpr double kCutMargin = 0.05; ///< corners this near to a plane count as on it. Game units
/// Pieces that were cut this often are not cut again, but go to the side of a plane on which their center is. Trees of
/// real maps need far fewer cuts.
constexpr int kMostCuts = 256;
/// A segment that is blocked is tried again this far aside: rounding may put one along a face into the solid. Game
/// units.
constexpr float kAside = 0.2f;
/// Parts of a segment shorter than this are not in a leaf. Game units.
constexpr float kShortestSegment = 0.01f;

struct BrushPlane {
    Vec3d normal;
    double dist;
};

BrushPlane PlaneOfSide(const Bsp &bsp, const bspBrush_t &brush, int side) {
    const int number = bsp.brushSides[std::size_t(brush.firstSide + side)].planeNum;
    const bspPlane_t &plane = bsp.planes[std::size_t(number)];
    return {Vec3d(plane.normal), double(plane.dist)};
}

/// Cuts a polygon into its parts in the open and in solids, by a walk down the tree.
class PartFinder {
  public:
    explicit PartFinder(const BspSpace &space) : space_(space), bsp_(space.Map()) {}

    PolygonParts Find(const Winding<float> &w) {
        Winding<double> exact;
        for (const Vec3f &p : w)
            exact.emplace_back(p);
        FindBelow(RootOf(bsp_), std::move(exact), 0);
        return {Floats(open_), Floats(covered_)};
    }

  private:
    using Pieces = std::vector<Winding<double>>;
    enum class Kind { Open, Covered, Mixed };

    static std::vector<Winding<float>> Floats(const Pieces &pieces) {
        std::vector<Winding<float>> result;
        for (const Winding<double> &piece : pieces) {
            Winding<float> &w = result.emplace_back();
            for (const Vec3d &p : piece)
                w.emplace_back(p);
        }
        return result;
    }
    /// Adds the pieces of w to open_ and covered_: only one if all of w is open, or all covered.
    Kind FindBelow(BspChild child, Winding<double> w, int cuts);
    Kind FindInLeaf(std::size_t leaf, Winding<double> w);
    void CutByBrush(const Winding<double> &w, const bspBrush_t &brush, Pieces &outside, Pieces &inside);

    const BspSpace &space_;
    const Bsp &bsp_;
    WindingCutter<double> cutter_;
    Pieces open_, covered_;
};

PartFinder::Kind PartFinder::FindBelow(BspChild child, Winding<double> w, int cuts) {
    while (child >= 0) {
        const bspNode_t &node = bsp_.nodes[std::size_t(child)];
        const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
        const Vec3d normal(plane.normal);
        cutter_.Classify(w, normal, double(plane.dist), kCutMargin);
        if (cutter_.AnyFront() != cutter_.AnyBack()) {
            child = node.children[cutter_.AnyFront() ? 0 : 1];
            continue;
        }
        Winding<double> front, back;
        if (cutter_.AnyFront() && cuts < kMostCuts)
            cutter_.Front(w, front), cutter_.Back(w, back);
        if (front.empty() || back.empty()) {
            Vec3d sum;
            for (const Vec3d &p : w)
                sum += p;
            child = node.children[Dot(normal, sum) >= double(plane.dist) * double(w.size()) ? 0 : 1];
            continue;
        }
        const std::size_t open = open_.size(), covered = covered_.size();
        const Kind first = FindBelow(node.children[0], std::move(front), cuts + 1);
        const Kind second = FindBelow(node.children[1], std::move(back), cuts + 1);
        if (first != second || first == Kind::Mixed)
            return Kind::Mixed;
        open_.resize(open), covered_.resize(covered);
        (first == Kind::Open ? open_ : covered_).push_back(std::move(w));
        return first;
    }
    return FindInLeaf(std::size_t(LeafOf(child)), std::move(w));
}

PartFinder::Kind PartFinder::FindInLeaf(std::size_t leaf, Winding<double> w) {
    Pieces outside, inside;
    if (bsp_.leafs[leaf].cluster < 0)
        inside.push_back(std::move(w));
    else {
        outside.push_back(std::move(w));
        for (const std::int32_t number : space_.OpaqueBrushes(leaf)) {
            Pieces left;
            for (const Winding<double> &piece : outside)
                CutByBrush(piece, bsp_.brushes[std::size_t(number)], left, inside);
            outside = std::move(left);
        }
    }
    const Kind kind = inside.empty() ? Kind::Open : outside.empty() && inside.size() == 1 ? Kind::Covered : Kind::Mixed;
    std::move(outside.begin(), outside.end(), std::back_inserter(open_));
    std::move(inside.begin(), inside.end(), std::back_inserter(covered_));
    return kind;
}

/// Adds the parts of w outside the brush, and the one inside, if any. A polygon on a side is outside.
void PartFinder::CutByBrush(const Winding<double> &w, const bspBrush_t &brush, Pieces &outside, Pieces &inside) {
    Pieces around;
    Winding<double> rest = w;
    for (int side = 0; side < brush.numSides && !rest.empty(); ++side) {
        const BrushPlane plane = PlaneOfSide(bsp_, brush, side);
        cutter_.Classify(rest, plane.normal, plane.dist, kCutMargin);
        if (!cutter_.AnyBack())
            rest.clear();
        else if (cutter_.AnyFront()) {
            Winding<double> back;
            cutter_.Front(rest, around.emplace_back());
            cutter_.Back(rest, back);
            rest = std::move(back);
        }
    }
    if (rest.empty()) {
        outside.push_back(w);
        return;
    }
    std::erase_if(around, [](const Winding<double> &piece) { return piece.empty(); });
    std::move(around.begin(), around.end(), std::back_inserter(outside));
    inside.push_back(std::move(rest));
}

/// Walks the tree along the straight segment from a to b. Places on the segment are fractions of its length.
class FirstSolidFinder {
  public:
    FirstSolidFinder(const Vec3f &a, const Vec3f &b, const BspSpace &space)
        : space_(space), bsp_(space.Map()), a_(a), b_(b), shortest_(kShortestSegment / std::max(Length(b - a), 1.0f)) {}

    float FreeFraction() const {
        struct Part {
            BspChild child;
            float from, to;
        };
        std::vector<Part> pending{{RootOf(bsp_), 0, 1}};
        while (!pending.empty()) { // nearest first
            auto [child, from, to] = pending.back();
            pending.pop_back();
            while (child >= 0) {
                const bspNode_t &node = bsp_.nodes[std::size_t(child)];
                const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
                const float start = Dot(Vec3f(plane.normal), At(from)) - plane.dist;
                const float end = Dot(Vec3f(plane.normal), At(to)) - plane.dist;
                const int near = start < 0 ? 1 : 0;
                if ((start < 0) != (end < 0)) {
                    const float middle = std::clamp(from + (to - from) * (start / (start - end)), from, to);
                    pending.push_back({node.children[1 - near], middle, to});
                    to = middle;
                }
                child = node.children[near];
            }
            if (const float met = FirstSolid(std::size_t(LeafOf(child)), from, to); met < to)
                return met;
        }
        return 1;
    }

  private:
    Vec3f At(float fraction) const { return a_ + (b_ - a_) * fraction; }
    /// Where the part between `from` and `to`, which is in the leaf, meets a solid; `to` if it does not.
    float FirstSolid(std::size_t leaf, float from, float to) const {
        if (to - from < shortest_)
            return to;
        if (bsp_.leafs[leaf].cluster < 0)
            return from;
        float first = to;
        for (const std::int32_t number : space_.OpaqueBrushes(leaf))
            first = std::min(first, Entry(bsp_.brushes[std::size_t(number)], from, to));
        return first;
    }
    /// Where the part between `from` and `to` enters the brush; `to` if it does not.
    float Entry(const bspBrush_t &brush, float from, float to) const {
        float enter = from, leave = to;
        for (int side = 0; side < brush.numSides; ++side) {
            const BrushPlane plane = PlaneOfSide(bsp_, brush, side);
            const float start = float(Dot(plane.normal, Vec3d(a_)) - plane.dist);
            const float end = float(Dot(plane.normal, Vec3d(b_)) - plane.dist);
            if (start >= 0 && end >= 0)
                return to;
            if (start >= 0)
                enter = std::max(enter, start / (start - end));
            else if (end >= 0)
                leave = std::min(leave, start / (start - end));
        }
        return leave - enter < shortest_ ? to : enter;
    }

    const BspSpace &space_;
    const Bsp &bsp_;
    Vec3f a_, b_;
    float shortest_; ///< kShortestSegment as a fraction of the segment
};

} // namespace

PolygonParts PartsOf(const Winding<float> &w, const BspSpace &space) {
    return PartFinder(space).Find(w);
}

float FreeFraction(const Vec3f &a, const Vec3f &b, const BspSpace &space) {
    float fraction = FirstSolidFinder(a, b, space).FreeFraction();
    const Vec3f along = b - a;
    if (fraction >= 1 || along == Vec3f{})
        return fraction;
    // An axis that is not nearly parallel to the segment.
    const Vec3f axis = std::abs(along.z) * 2 > Length(along) ? Vec3f{1, 0, 0} : Vec3f{0, 0, 1};
    const Vec3f right = Normalize(Cross(along, axis)) * kAside, up = Normalize(Cross(along, right)) * kAside;
    for (const Vec3f &aside : {right, -right, up, -up})
        fraction = std::max(fraction, FirstSolidFinder(a + aside, b + aside, space).FreeFraction());
    return fraction;
}

// ---- What solids are on the straight segment between two points ----

namespace {

/// Solids with less than this between them count as one: two adjoining brushes, both shrunk by kIgnoredSolid, have
/// twice that between them, and more along an oblique segment. Game units.
constexpr float kLeastGap = 4 * kIgnoredSolid;

/// Where a part of a segment begins and ends, as fractions of its length.
using Span = std::array<float, 2>;

/// Collects the solid parts of a segment, leaf by leaf.
class SegmentWalk {
  public:
    SegmentWalk(const BspSpace &space, const Vec3f &a, const Vec3f &b)
        : space_(space), bsp_(space.Map()), a_(a), b_(b), along_(b - a) {}

    SegmentState Run() {
        Walk();
        if (solids_.empty())
            return SegmentState::Open;
        std::sort(solids_.begin(), solids_.end());
        const float slack = kLeastGap / std::max(kLeastGap, Length(along_));
        float left = 0; // where the segment leaves the solid that it starts in
        for (const auto &[from, to] : solids_) {
            if (from > left + slack)
                return SegmentState::Blocked;
            left = std::max(left, to);
        }
        // Points on the face of a solid are in the open: a segment from there through the solid is blocked.
        return IsSolid(a_) && !IsSolid(b_) ? SegmentState::LeavesSolid : SegmentState::Blocked;
    }

  private:
    struct Part {
        BspChild child;
        Span span;
    };

    bool IsSolid(const Vec3f &p) const { return space_.ClusterAt(p, -kIgnoredSolid) == kSolidCluster; }
    bool IsSolidInTheMiddle(const Span &span) const { return IsSolid(a_ + along_ * ((span[0] + span[1]) * 0.5f)); }

    /// Visits the leafs that the segment passes, in any order.
    void Walk() {
        std::vector<Part> more; // overflow of `pending`
        std::array<Part, 32> pending;
        std::size_t waiting = 0;
        for (Part part{RootOf(bsp_), {0, 1}};;) {
            while (part.child >= 0) {
                const bspNode_t &node = bsp_.nodes[std::size_t(part.child)];
                const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
                const Vec3f normal(plane.normal);
                const float atA = Dot(normal, a_) - plane.dist, slope = Dot(normal, along_);
                const bool first = atA + slope * part.span[0] >= 0, last = atA + slope * part.span[1] >= 0;
                const BspChild near = node.children[first ? 0 : 1];
                if (first != last) {
                    const float middle = std::clamp(-atA / slope, part.span[0], part.span[1]);
                    const Part rest{node.children[last ? 0 : 1], {middle, part.span[1]}};
                    if (waiting < pending.size())
                        pending[waiting++] = rest;
                    else
                        more.push_back(rest);
                    part.span[1] = middle;
                }
                part.child = near;
            }
            AddSolids(std::size_t(LeafOf(part.child)), part.span);
            if (waiting == 0)
                return;
            if (more.empty())
                part = pending[--waiting];
            else {
                part = more.back();
                more.pop_back();
            }
        }
    }

    /// span: the part of the segment in leaf `number`.
    void AddSolids(std::size_t number, const Span &span) {
        if (bsp_.leafs[number].cluster < 0) {
            if ((span[1] - span[0]) * Length(along_) > kIgnoredSolid && IsSolidInTheMiddle(span))
                solids_.push_back(span);
            return;
        }
        for (const std::int32_t brush : space_.OpaqueBrushes(number))
            // The second test leaves out what only rounding makes solid.
            if (const Span inside = SpanIn(bsp_.brushes[std::size_t(brush)]);
                inside[0] < inside[1] && IsSolidInTheMiddle(inside))
                solids_.push_back(inside);
    }

    /// The part of the segment in a brush shrunk by kIgnoredSolid.
    Span SpanIn(const bspBrush_t &brush) const {
        Span inside{0, brush.numSides > 0 ? 1.0f : 0.0f};
        for (int s = 0; s < brush.numSides && inside[0] < inside[1]; ++s) {
            const bspPlane_t &plane =
                bsp_.planes[std::size_t(bsp_.brushSides[std::size_t(brush.firstSide + s)].planeNum)];
            const Vec3f n(plane.normal);
            const float from = Dot(n, a_) - plane.dist + kIgnoredSolid, to = Dot(n, b_) - plane.dist + kIgnoredSolid;
            if (from > 0 && to > 0)
                return {1, 0};
            if (from > 0)
                inside[0] = std::max(inside[0], from / (from - to));
            else if (to > 0)
                inside[1] = std::min(inside[1], from / (from - to));
        }
        return inside;
    }

    const BspSpace &space_;
    const Bsp &bsp_;
    const Vec3f a_, b_, along_;
    std::vector<Span> solids_;
};

} // namespace

SegmentState StateOfSegment(const BspSpace &space, const Vec3f &a, const Vec3f &b) {
    return SegmentWalk(space, a, b).Run();
}

} // namespace q3
