// GPL-2.0-or-later. Checks that visibility data hides nothing that can be seen.
#include "tools/measure/vis_check/sight_check.h"

#include "common/error.h"
#include "libs/math/vec.h"

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

namespace q3 {

namespace {

/// The lump of visibility data: number of clusters and bytes of a row as 32-bit integers, then a row of bits for each
/// cluster.
constexpr std::size_t kRowSizeAt = 4, kVisibilityHeader = 8; // bytes

/// What the tree of a map and its visibility data say.
class SightWalker {
  public:
    explicit SightWalker(const Bsp &bsp) : bsp_(bsp) {
        if (bsp.visibility.size() < kVisibilityHeader)
            throw Error("no visibility data, expected a map after the vis stage");
        std::memcpy(&rowBytes_, bsp.visibility.data() + kRowSizeAt, sizeof rowBytes_);
    }

    /// Below 0 in solid leafs.
    int ClusterAt(const Vec3d &p) const {
        int child = bsp_.nodes.empty() ? -1 : 0;
        while (child >= 0) {
            const bspNode_t &node = bsp_.nodes[std::size_t(child)];
            child = node.children[Distance(node, p) >= 0 ? 0 : 1];
        }
        return bsp_.leafs[std::size_t(-1 - child)].cluster;
    }
    /// Whether the segment meets open leafs only.
    bool IsClear(const Vec3d &a, const Vec3d &b) const { return IsClearFrom(bsp_.nodes.empty() ? -1 : 0, a, b); }
    /// Whether the visibility data says that one cluster sees the other.
    bool Sees(int from, int to) const {
        const std::size_t row = kVisibilityHeader + std::size_t(from) * std::size_t(rowBytes_);
        return (bsp_.visibility[row + std::size_t(to / 8)] >> (to % 8) & 1) != 0;
    }

  private:
    double Distance(const bspNode_t &node, const Vec3d &p) const {
        const bspPlane_t &plane = bsp_.planes[std::size_t(node.planeNum)];
        return Dot(Vec3d(plane.normal), p) - double(plane.dist);
    }
    bool IsClearFrom(int child, Vec3d a, const Vec3d &b) const {
        while (child >= 0) {
            const bspNode_t &node = bsp_.nodes[std::size_t(child)];
            const double da = Distance(node, a), db = Distance(node, b);
            const std::size_t side = da >= 0 ? 0 : 1;
            if ((db >= 0 ? 0u : 1u) == side) {
                child = node.children[side];
                continue;
            }
            const Vec3d middle = a + (b - a) * (da / (da - db));
            if (!IsClearFrom(node.children[side], a, middle))
                return false;
            a = middle;
            child = node.children[1 - side];
        }
        return bsp_.leafs[std::size_t(-1 - child)].cluster >= 0;
    }

    const Bsp &bsp_;
    std::int32_t rowBytes_ = 0;
};

/// Points in open leafs, and partners for them.
class PointSource {
  public:
    PointSource(const Bsp &bsp, const SightWalker &walker, std::uint32_t seed) : walker_(walker), random_(seed) {
        if (bsp.models.empty())
            throw Error("no world model");
        mins_ = Vec3d(bsp.models[0].mins), maxs_ = Vec3d(bsp.models[0].maxs);
    }
    /// Uniform, 0 <= x < 1.
    double Unit() { return double(random_()) * 0x1p-32; }

    /// A point in an open leaf, uniform over all of them.
    Vec3d Anywhere() {
        constexpr int kTries = 1000000;
        for (int i = 0; i < kTries; ++i) {
            const Vec3d p = mins_ + (maxs_ - mins_) * Vec3d(Unit(), Unit(), Unit());
            if (walker_.ClusterAt(p) >= 0)
                return p;
        }
        throw Error("no open leaf among {} places of the world", kTries);
    }
    /// In a random direction, at a distance from 2 units up to the diagonal of the world, whose logarithm is uniform.
    Vec3d Around(const Vec3d &p) {
        const double z = 2 * Unit() - 1, turn = 2 * std::numbers::pi * Unit(), r = std::sqrt(1 - z * z);
        const double distance = 2 * std::pow(std::max(2.0, Length(maxs_ - mins_) / 2), Unit());
        return p + Vec3d(r * std::cos(turn), r * std::sin(turn), z) * distance;
    }

  private:
    const SightWalker &walker_;
    std::mt19937 random_;
    Vec3d mins_, maxs_;
};

/// Whether the eight parallels of a segment, `margin` units around it, are clear too.
bool IsBundleClear(const SightWalker &walker, const Vec3d &a, const Vec3d &b, double margin) {
    const Vec3d along = Normalize(b - a);
    const Vec3d right = Normalize(Cross(along, std::abs(along.z) < 0.9 ? Vec3d(0, 0, 1) : Vec3d(1, 0, 0)));
    const Vec3d up = Cross(right, along);
    for (int i = 0; i < 8; ++i) {
        const double turn = i * std::numbers::pi / 4;
        const Vec3d aside = (right * std::cos(turn) + up * std::sin(turn)) * margin;
        if (!walker.IsClear(a + aside, b + aside))
            return false;
    }
    return true;
}

} // namespace

SightCheck CheckSight(const Bsp &bsp, std::int64_t pairs, float margin, std::uint32_t seed) {
    const SightWalker walker(bsp);
    PointSource points(bsp, walker, seed);
    SightCheck check;
    while (check.pairs < pairs) {
        const Vec3d a = points.Anywhere(), b = points.Unit() < 0.5 ? points.Anywhere() : points.Around(a);
        const int from = walker.ClusterAt(a), to = walker.ClusterAt(b);
        if (to < 0)
            continue;
        check.pairs++;
        if (!walker.IsClear(a, b))
            continue;
        check.clear++;
        if (walker.Sees(from, to) && walker.Sees(to, from))
            continue;
        check.hidden++;
        if (!IsBundleClear(walker, a, b, double(margin)))
            continue;
        if (check.missing++ == 0)
            check.from = from, check.to = to;
    }
    return check;
}

} // namespace q3
