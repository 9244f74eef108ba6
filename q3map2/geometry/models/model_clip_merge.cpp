// GPL-2.0-or-later. Merges triangles of a mesh into convex polygons.
#include "q3map2/geometry/models/model_clip_merge.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <tuple>
#include <unordered_map>

namespace q3 {
namespace {

constexpr double kSameNormal = 0.00001, kSamePlane = 0.01, kStraight = 0.00001;

struct ConvexPolygon {
    std::vector<int> corners; ///< indexes of positions; empty: merged into another
    Plane plane;
};

Plane PlaneOfCorners(const std::vector<Vec3f> &positions, const std::vector<int> &corners) {
    const Vec3d a(positions[std::size_t(corners[0])]), b(positions[std::size_t(corners[1])]),
        c(positions[std::size_t(corners[2])]);
    const Vec3d normal = Normalize(Cross(c - a, b - a));
    return {normal, Dot(normal, a)};
}

class PolygonMerger {
  public:
    PolygonMerger(std::span<const Vec3f> points, std::span<const std::array<int, 3>> triangles) {
        std::map<std::tuple<float, float, float>, int> numbers;
        std::vector<int> numberOf;
        for (const Vec3f &p : points) {
            const auto [at, added] = numbers.try_emplace({p.x, p.y, p.z}, int(positions_.size()));
            if (added)
                positions_.push_back(p);
            numberOf.push_back(at->second);
        }
        for (const auto &[a, b, c] : triangles) {
            ConvexPolygon polygon{{numberOf[std::size_t(a)], numberOf[std::size_t(b)], numberOf[std::size_t(c)]}, {}};
            polygon.plane = PlaneOfCorners(positions_, polygon.corners);
            if (polygon.plane.normal == Vec3d{})
                continue;
            polygons_.push_back(std::move(polygon));
            Register(polygons_.size() - 1);
        }
    }

    std::vector<Polygon> Run() {
        for (std::size_t i = 0; i < polygons_.size(); ++i)
            while (!polygons_[i].corners.empty() && JoinOne(i)) {
            }
        std::vector<Polygon> polygons;
        for (const ConvexPolygon &source : polygons_) {
            Polygon polygon;
            for (const int corner : source.corners)
                polygon.push_back(positions_[std::size_t(corner)]);
            if (!polygon.empty())
                polygons.push_back(std::move(polygon));
        }
        return polygons;
    }

  private:
    static std::uint64_t Edge(int from, int to) { return std::uint64_t(std::uint32_t(from)) << 32 | std::uint32_t(to); }

    void Register(std::size_t polygon) {
        const std::vector<int> &corners = polygons_[polygon].corners;
        for (std::size_t i = 0; i < corners.size(); ++i)
            edges_[Edge(corners[i], corners[(i + 1) % corners.size()])] = polygon;
    }

    bool JoinOne(std::size_t number) {
        const std::vector<int> corners = polygons_[number].corners;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const auto at = edges_.find(Edge(corners[(i + 1) % corners.size()], corners[i]));
            if (at == edges_.end() || at->second == number || polygons_[at->second].corners.empty())
                continue;
            ConvexPolygon &other = polygons_[at->second];
            if (Length(other.plane.normal - polygons_[number].plane.normal) > kSameNormal ||
                std::abs(other.plane.dist - polygons_[number].plane.dist) > kSamePlane)
                continue;
            std::vector<int> joined = Joined(corners, i, other.corners);
            if (!Tidy(joined, polygons_[number].plane.normal))
                continue;
            other.corners.clear();
            polygons_[number].corners = std::move(joined);
            Register(number);
            return true;
        }
        return false;
    }

    /// The union of `a` and `b` across edge number `edge` of `a`. Empty if `b` no longer has that edge.
    static std::vector<int> Joined(const std::vector<int> &a, std::size_t edge, const std::vector<int> &b) {
        const int start = a[edge], end = a[(edge + 1) % a.size()];
        const auto at = std::find(b.begin(), b.end(), end);
        if (at == b.end() || b[std::size_t(at - b.begin() + 1) % b.size()] != start)
            return {};
        std::vector<int> joined;
        for (std::size_t i = 0; i < a.size(); ++i)
            joined.push_back(a[(edge + 1 + i) % a.size()]);
        for (std::size_t i = 2; i < b.size(); ++i)
            joined.push_back(b[(std::size_t(at - b.begin()) + i) % b.size()]);
        return joined;
    }

    /// Removes collinear corners. False if the polygon is not convex.
    bool Tidy(std::vector<int> &corners, const Vec3d &normal) const {
        for (std::size_t i = 0; i < corners.size() && corners.size() > 2;) {
            const Vec3d a(positions_[std::size_t(corners[(i + corners.size() - 1) % corners.size()])]),
                b(positions_[std::size_t(corners[i])]), c(positions_[std::size_t(corners[(i + 1) % corners.size()])]);
            const double turn = Dot(Cross(Normalize(c - b), Normalize(b - a)), normal);
            if (turn < -kStraight)
                return false;
            if (turn <= kStraight) {
                if (Dot(c - b, b - a) < 0)
                    return false;
                corners.erase(corners.begin() + std::ptrdiff_t(i));
                i = 0;
            } else
                ++i;
        }
        return corners.size() > 2;
    }

    std::vector<Vec3f> positions_;
    std::vector<ConvexPolygon> polygons_;
    std::unordered_map<std::uint64_t, std::size_t> edges_;
};

} // namespace

std::vector<Polygon> MergedTriangles(std::span<const Vec3f> points, std::span<const std::array<int, 3>> triangles) {
    return PolygonMerger(points, triangles).Run();
}

} // namespace q3
