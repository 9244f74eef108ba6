// GPL-2.0-or-later. What solids are on the straight way between two points.
#include "q3map2/light/scene/light_way.h"

#include <algorithm>
#include <array>
#include <vector>

namespace q3 {

namespace {

/// Solids with less than this between them count as one: two adjoining brushes, both shrunk by kWayTouch, have twice
/// that between them, and more along an oblique segment. Game units.
constexpr float kLeastGap = 4 * kWayTouch;

/// Where a part of a way begins and ends, as fractions of its length.
using Span = std::array<float, 2>;

/// Collects the solid parts of a way, leaf by leaf.
class WayWalk {
  public:
    WayWalk(const BspSpace &space, const Vec3f &a, const Vec3f &b)
        : space_(space), bsp_(space.Map()), a_(a), b_(b), along_(b - a) {}

    Way Run() {
        Walk();
        if (solids_.empty())
            return Way::Open;
        std::sort(solids_.begin(), solids_.end());
        const float slack = kLeastGap / std::max(kLeastGap, Length(along_));
        float left = 0; // where the way leaves the solid that it starts in
        for (const auto &[from, to] : solids_) {
            if (from > left + slack)
                return Way::Blocked;
            left = std::max(left, to);
        }
        // Points on the face of a solid are in the open: a way from there through the solid is blocked.
        return IsSolid(a_) && !IsSolid(b_) ? Way::LeavesSolid : Way::Blocked;
    }

  private:
    struct Part {
        BspChild child;
        Span span;
    };

    bool IsSolid(const Vec3f &p) const { return space_.ClusterAt(p, -kWayTouch) == kSolidCluster; }
    bool IsSolidInTheMiddle(const Span &span) const { return IsSolid(a_ + along_ * ((span[0] + span[1]) * 0.5f)); }

    /// Visits the leafs that the way passes, in any order.
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

    /// span: the part of the way in leaf `number`.
    void AddSolids(std::size_t number, const Span &span) {
        if (bsp_.leafs[number].cluster < 0) {
            if ((span[1] - span[0]) * Length(along_) > kWayTouch && IsSolidInTheMiddle(span))
                solids_.push_back(span);
            return;
        }
        for (const std::int32_t brush : space_.OpaqueBrushes(number))
            // The second test leaves out what only rounding makes solid.
            if (const Span inside = SpanIn(bsp_.brushes[std::size_t(brush)]);
                inside[0] < inside[1] && IsSolidInTheMiddle(inside))
                solids_.push_back(inside);
    }

    /// The part of the way in a brush shrunk by kWayTouch.
    Span SpanIn(const bspBrush_t &brush) const {
        Span inside{0, brush.numSides > 0 ? 1.0f : 0.0f};
        for (int s = 0; s < brush.numSides && inside[0] < inside[1]; ++s) {
            const bspPlane_t &plane =
                bsp_.planes[std::size_t(bsp_.brushSides[std::size_t(brush.firstSide + s)].planeNum)];
            const Vec3f n(plane.normal);
            const float from = Dot(n, a_) - plane.dist + kWayTouch, to = Dot(n, b_) - plane.dist + kWayTouch;
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

Way WayBetween(const BspSpace &space, const Vec3f &a, const Vec3f &b) {
    return WayWalk(space, a, b).Run();
}

} // namespace q3
