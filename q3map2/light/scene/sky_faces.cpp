// GPL-2.0-or-later. Skies as a few convex polygons.
#include "q3map2/light/scene/sky_faces.h"

#include "libs/math/winding.h"

#include <algorithm>
#include <map>
#include <utility>

namespace q3 {

namespace {

/// Surfaces with more triangles are not cut into convex pieces: the time grows with the square of their number.
constexpr std::size_t kMostTriangles = 256;

/// Area vector of triangles, three clockwise corners each: half the sum of their cross products.
Vec3d AreaVector(const std::vector<Vec3d> &corners) {
    Vec3d across;
    for (std::size_t i = 0; i < corners.size(); i += 3)
        across += Cross(corners[i + 2] - corners[i], corners[i + 1] - corners[i]) * 0.5;
    return across;
}

/// The convex polygon that coplanar triangles cover; empty if what they cover is not convex.
Winding<double> ConvexFace(const std::vector<Vec3d> &corners) {
    const Vec3d area = AreaVector(corners);
    Winding<double> hull = ConvexHull(corners, Normalize(area), kSkyOverlap / 2);
    double perimeter = 0;
    for (std::size_t i = 0; i < hull.size(); ++i)
        perimeter += Length(hull[(i + 1) % hull.size()] - hull[i]);
    if (std::abs(WindingArea(hull) - Length(area)) > kSkyOverlap * perimeter)
        return {};
    return hull;
}

/// Whether two sets of corners have two corners in common.
bool Adjacent(const std::vector<Vec3d> &a, const std::vector<Vec3d> &b) {
    std::vector<Vec3d> common;
    for (const Vec3d &p : a)
        if (std::find(b.begin(), b.end(), p) != b.end() && std::find(common.begin(), common.end(), p) == common.end())
            common.push_back(p);
    return common.size() >= 2;
}

/// Convex polygons that together cover the triangles; empty if they are too many or not coplanar. Greedily joins parts
/// whose union is convex.
std::vector<Winding<double>> ConvexPieces(const std::vector<Vec3d> &corners) {
    const Vec3d normal = Normalize(AreaVector(corners));
    for (const Vec3d &p : corners)
        if (std::abs(Dot(normal, p - corners[0])) > kSkyOverlap)
            return {};
    if (const Winding<double> whole = ConvexFace(corners); !whole.empty())
        return {whole};
    if (corners.size() > 3 * kMostTriangles)
        return {};
    std::vector<std::vector<Vec3d>> parts;
    for (std::size_t i = 0; i < corners.size(); i += 3)
        if (!ConvexFace({corners[i], corners[i + 1], corners[i + 2]}).empty()) // skips triangles without area
            parts.push_back({corners[i], corners[i + 1], corners[i + 2]});
    const auto join = [&] {
        for (std::size_t i = 0; i < parts.size(); ++i)
            for (std::size_t j = i + 1; j < parts.size(); ++j) {
                if (!Adjacent(parts[i], parts[j]))
                    continue;
                std::vector<Vec3d> both = parts[i];
                both.insert(both.end(), parts[j].begin(), parts[j].end());
                if (ConvexFace(both).empty())
                    continue;
                parts[i] = std::move(both);
                parts.erase(parts.begin() + std::ptrdiff_t(j));
                return true;
            }
        return false;
    };
    while (join())
        ;
    std::vector<Winding<double>> pieces;
    for (const std::vector<Vec3d> &part : parts)
        pieces.push_back(ConvexFace(part));
    if (pieces.size() > kMostSkyPieces)
        pieces.clear();
    return pieces;
}

/// Adds to `inside` the points that are on the inside of all edges of a convex piece.
void AddInside(std::span<const SkyLinear> edges, const Lanes3 &points, LaneMask &inside) {
    Vectorize([&]() Q3_INLINE {
        Lanes least; ///< 0, or the negative distance outside the farthest edge
        least.fill(0);
        for (const auto &[across, dist] : edges) {
            const float x = across.x, y = across.y, z = across.z, from = dist;
            Q3_ROLLED
            for (const std::size_t i : kEachLane) {
                const float in = x * points.x[i] + y * points.y[i] + z * points.z[i] - from;
                least[i] = in < least[i] ? in : least[i];
            }
        }
        Q3_ROLLED
        for (const std::size_t i : kEachLane)
            inside[i] |= -std::int32_t(least[i] >= 0);
    });
}

} // namespace

SkyFaces::SkyFaces(const Triangles &skies, std::span<const int> indexes) {
    std::map<int, std::vector<Vec3d>> bySurface;
    std::map<int, int> indexOf;
    for (std::size_t i = 0; i < skies.Count(); ++i) {
        indexOf[skies.surface[i]] = indexes[i];
        for (const float *p = &skies.corners[9 * i]; p < &skies.corners[9 * i] + 9; p += 3)
            bySurface[skies.surface[i]].push_back({p[0], p[1], p[2]});
    }
    few_ = !bySurface.empty() && bySurface.size() <= kMostSkyFaces;
    std::size_t count = 0, edges = 0;
    for (const auto &[surface, corners] : bySurface) {
        const auto pieces = few_ ? ConvexPieces(corners) : std::vector<Winding<double>>();
        count += pieces.size();
        for (const Winding<double> &piece : pieces)
            edges += piece.size();
        few_ = few_ && !pieces.empty() && count <= kMostSkyPieces && edges <= kMostSkyEdges;
        if (few_)
            AddFace(pieces, indexOf[surface]);
    }
    // Large faces first: most rays meet one, which saves testing the edges of faces behind it.
    std::stable_sort(faces_.begin(), faces_.end(), [](const Face &a, const Face &b) { return a.area > b.area; });
}

void SkyFaces::AddFace(std::span<const Winding<double>> pieces, int skyIndex) {
    const Winding<double> &first = pieces.front();
    const Vec3d normal = Normalize(Cross(first[2] - first[0], first[1] - first[0]));
    Face face{{Vec3f(normal), float(Dot(normal, first[0]))}, {}, skyIndex, 0};
    for (const Winding<double> &w : pieces) {
        Piece &piece = face.pieces.emplace_back();
        face.area += WindingArea(w);
        for (std::size_t i = 0; i < w.size(); ++i) {
            const Vec3d &a = w[i], &b = w[(i + 1) % w.size()];
            const Vec3d inward = Normalize(Cross(b - a, normal));
            piece.push_back({Vec3f(inward), float(Dot(inward, a) - kSkyOverlap)});
        }
    }
    faces_.push_back(std::move(face));
}

/// Written so that compilers make vector code of it: loops without branches, and every lane loaded and stored.
void SkyFaces::Test(const Face &face, const Lanes3 &origin, const Lanes3 &direction, float nearest, SkyHits &hits) {
    Vectorize([&, nearest]() Q3_INLINE {
        const auto [n, dist] = face.plane;
        Lanes distance, toward;
        Lanes3 at;
        LaneMask between;           ///< rays that meet the plane before any other face
        std::int32_t undecided = 0; ///< not 0: some of them are not known to meet a piece of the face
        for (const std::size_t i : kEachLane) {
            const float dx = direction.x[i], dy = direction.y[i], dz = direction.z[i];
            const float ox = origin.x[i], oy = origin.y[i], oz = origin.z[i];
            toward[i] = n.x * dx + n.y * dy + n.z * dz;
            const float d = (dist - (n.x * ox + n.y * oy + n.z * oz)) / toward[i];
            distance[i] = d;
            at.x[i] = ox + d * dx, at.y[i] = oy + d * dy, at.z[i] = oz + d * dz;
            between[i] = -std::int32_t((d >= nearest) & (d <= hits.distance[i]));
            undecided |= between[i];
        }
        if (undecided == 0) // so for most faces of a sky box
            return;
        LaneMask inside{};
        for (const Piece &piece : face.pieces) {
            if (undecided == 0)
                break;
            AddInside(piece, at, inside);
            undecided = 0;
            Q3_ROLLED
            for (const std::size_t i : kEachLane)
                undecided |= between[i] & ~inside[i];
        }
        for (const std::size_t i : kEachLane) {
            const std::int32_t met = between[i] & inside[i], behind = -std::int32_t(toward[i] > 0);
            const float before = hits.distance[i], here = distance[i];
            hits.hit[i] |= met;
            hits.behind[i] = (behind & met) | (hits.behind[i] & ~met);
            hits.skyIndex[i] = (face.skyIndex & met) | (hits.skyIndex[i] & ~met);
            hits.distance[i] = met != 0 ? here : before;
        }
    });
}

void SkyFaces::Find(const Lanes3 &origin, const Lanes3 &direction, const Lanes &farthest, const LaneMask &live,
                    float nearest, SkyHits &hits) const {
    Vectorize([&, nearest]() Q3_INLINE {
        for (const std::size_t i : kEachLane) {
            hits.hit[i] = hits.behind[i] = hits.skyIndex[i] = 0;
            hits.distance[i] = farthest[i];
        }
        for (const Face &face : faces_)
            Test(face, origin, direction, nearest, hits);
        for (const std::size_t i : kEachLane)
            hits.hit[i] &= live[i], hits.behind[i] &= live[i];
    });
}

} // namespace q3
