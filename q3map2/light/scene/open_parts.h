// GPL-2.0-or-later. Polygons and lines cut by the BSP tree: which parts lie in the open, and which solids are between
// two points.
#pragma once

#include "libs/math/winding.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/light/scene/light_space.h"

#include <utility>
#include <vector>

namespace q3 {

/// Where pieces in the plane of a node go.
enum class CoplanarSide { Front, Back, Both };

/// Cuts convex polygons by the tree of a validated Bsp. Use one object for many polygons in turn: it reuses its memory.
/// Iterative. Keeps a reference.
template <typename T> class TreeWalk {
  public:
    explicit TreeWalk(const Bsp &bsp) : bsp_(bsp) {}

    /// The whole tree.
    BspChild Root() const { return RootOf(bsp_); }

    /// Cuts w, a range of points, by the tree below `from` and calls visit(piece, leaf) for the piece in each leaf,
    /// until it returns false; so does the function. Backs come before fronts. Points within epsilon (game units) of a
    /// node's plane count as on it; coplanarSide(plane) decides where pieces go that lie entirely on it. The visitor
    /// may change its piece.
    template <typename Points, typename ChooseCoplanarSide, typename Visit>
    bool Walk(BspChild from, const Points &w, T epsilon, const ChooseCoplanarSide &coplanarSide, const Visit &visit) {
        stackSize_ = 0;
        Push(from).assign(w.begin(), w.end());
        while (stackSize_ > 0) {
            Piece &piece = stack_[stackSize_ - 1];
            if (piece.child < 0) {
                --stackSize_;
                if (!visit(piece.w, std::size_t(LeafOf(piece.child))))
                    return false;
                continue;
            }
            const bspNode_t &node = bsp_.nodes[std::size_t(piece.child)];
            const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
            cutter_.Classify(piece.w, Vec3<T>(plane.normal), T(plane.dist), epsilon);
            if (cutter_.AnyFront() != cutter_.AnyBack())
                piece.child = node.children[cutter_.AnyFront() ? 0 : 1];
            else if (cutter_.AnyFront())
                Split(node);
            else
                Choose(node, coplanarSide(plane));
        }
        return true;
    }

  private:
    struct Piece {
        BspChild child;
        Winding<T> w;
    };

    Winding<T> &Push(BspChild child) {
        if (stackSize_ == stack_.size())
            stack_.emplace_back();
        Piece &piece = stack_[stackSize_++];
        piece.child = child;
        return piece.w;
    }
    /// Replaces the piece on top by its two parts.
    void Split(const bspNode_t &node) {
        const Winding<T> &whole = stack_[--stackSize_].w;
        cutter_.Front(whole, front_), cutter_.Back(whole, back_);
        if (!front_.empty())
            std::swap(Push(node.children[0]), front_);
        if (!back_.empty())
            std::swap(Push(node.children[1]), back_);
    }
    void Choose(const bspNode_t &node, CoplanarSide where) {
        stack_[stackSize_ - 1].child = node.children[where == CoplanarSide::Back ? 1 : 0];
        if (where != CoplanarSide::Both)
            return;
        Winding<T> &copy = Push(node.children[1]);
        copy = stack_[stackSize_ - 2].w;
    }

    const Bsp &bsp_;
    WindingCutter<T> cutter_;
    std::vector<Piece> stack_; // the first stackSize_ are in use; the rest keep their memory for reuse
    std::size_t stackSize_ = 0;
    Winding<T> front_, back_;
};

/// A convex polygon cut where it enters solid leafs and opaque brushes of the world.
struct PolygonParts {
    std::vector<Winding<float>> open, covered; ///< convex
};

/// Cuts no more than needed: a polygon without covered part stays whole.
PolygonParts PartsOf(const Winding<float> &w, const BspSpace &space);

/// Fraction of the straight segment from a to b that lies before the first solid leaf or opaque brush: 1 if it meets
/// none, 0 if a is in one. A segment along the face of a solid is open.
float FreeFraction(const Vec3f &a, const Vec3f &b, const BspSpace &space);

// ---- What solids are on the straight segment between two points ----

enum class SegmentState {
    Open,        ///< no solid
    LeavesSolid, ///< it starts in a solid, leaves it, and passes no other
    Blocked      ///< it passes a solid, or ends in one
};

/// Less than this of a solid on a segment does not count. Game units.
inline constexpr float kIgnoredSolid = 0.125f;

/// What is on the segment from a to b: solid leafs, and opaque brushes shrunk by kIgnoredSolid. A segment in the plane
/// of a face is outside the solid.
SegmentState StateOfSegment(const BspSpace &space, const Vec3f &a, const Vec3f &b);

} // namespace q3
