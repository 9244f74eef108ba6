// GPL-2.0-or-later. Skies as a few convex polygons.
#include "q3map2/light/sky_faces.h"

#include "libs/math/convex_hull.h"

#include <algorithm>
#include <map>

namespace q3 {

namespace {

/// More take longer than a search for the nearest triangle.
constexpr std::size_t kMostFaces = 8;
/// Surfaces that are nearer to a convex polygon than this are one; faces reach as far over their edges, so that no ray
/// slips through where they meet. Game units.
constexpr double kOverlap = 1.0 / 16;

/// The convex polygon that some triangles of a sky make, three corners each, clockwise; empty when they make none.
Winding<double> ConvexFace(const std::vector<Vec3d> &corners) {
    Vec3d across;
    for (std::size_t i = 0; i < corners.size(); i += 3)
        across += Cross(corners[i + 2] - corners[i], corners[i + 1] - corners[i]);
    const Vec3d normal = Normalize(across);
    for (const Vec3d &p : corners)
        if (std::abs(Dot(normal, p - corners[0])) > kOverlap)
            return {};
    Winding<double> hull = ConvexHull(corners, normal, kOverlap / 2);
    double around = 0;
    for (std::size_t i = 0; i < hull.size(); ++i)
        around += Length(hull[(i + 1) % hull.size()] - hull[i]);
    if (std::abs(WindingArea(hull) - Length(across) / 2) > kOverlap * around)
        return {};
    return hull;
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
    few_ = !bySurface.empty() && bySurface.size() <= kMostFaces;
    for (const auto &[surface, corners] : bySurface) {
        const Winding<double> hull = few_ ? ConvexFace(corners) : Winding<double>();
        few_ = few_ && !hull.empty();
        if (few_)
            AddFace(hull, indexOf[surface]);
    }
}

void SkyFaces::AddFace(const Winding<double> &w, int skyIndex) {
    const Vec3d normal = Normalize(Cross(w[2] - w[0], w[1] - w[0]));
    Face face{{Vec3f(normal), float(Dot(normal, w[0]))}, {}, skyIndex};
    for (std::size_t i = 0; i < w.size(); ++i) {
        const Vec3d &a = w[i], &b = w[(i + 1) % w.size()];
        const Vec3d inward = Normalize(Cross(b - a, normal));
        face.edges.push_back({Vec3f(inward), float(Dot(inward, a) - kOverlap)});
    }
    faces_.push_back(std::move(face));
}

/// Written so that compilers make vector code of it: loops without branches, and every lane loaded and stored.
Q3_VECTOR void SkyFaces::Test(const Face &face, const Lanes3 &origin, const Lanes3 &direction, float nearest,
                              SkyHits &hits) {
    const auto [n, dist] = face.plane;
    Lanes distance, toward;
    Lanes3 at;
    LaneMask between;
    Lanes least; ///< how far inside the nearest edge
    least.fill(0);
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float dx = direction.x[i], dy = direction.y[i], dz = direction.z[i];
        const float ox = origin.x[i], oy = origin.y[i], oz = origin.z[i];
        toward[i] = n.x * dx + n.y * dy + n.z * dz;
        const float d = (dist - (n.x * ox + n.y * oy + n.z * oz)) / toward[i];
        distance[i] = d;
        at.x[i] = ox + d * dx, at.y[i] = oy + d * dy, at.z[i] = oz + d * dz;
        between[i] = -std::int32_t((d >= nearest) & (d <= hits.distance[i]));
    }
    if (!between.Any()) // the face is behind, or behind another
        return;
    for (const Plane3 &edge : face.edges) {
        const Vec3f across = edge.normal;
        const float from = edge.dist;
#pragma GCC unroll 1
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float in = across.x * at.x[i] + across.y * at.y[i] + across.z * at.z[i] - from;
            least[i] = in < least[i] ? in : least[i];
        }
    }
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const std::int32_t met = between[i] & -std::int32_t(least[i] >= 0), behind = -std::int32_t(toward[i] > 0);
        const float before = hits.distance[i], here = distance[i];
        hits.hit[i] |= met;
        hits.behind[i] = (behind & met) | (hits.behind[i] & ~met);
        hits.skyIndex[i] = (face.skyIndex & met) | (hits.skyIndex[i] & ~met);
        hits.distance[i] = met != 0 ? here : before;
    }
}

void SkyFaces::Find(const Lanes3 &origin, const Lanes3 &direction, const Lanes &farthest, const LaneMask &live,
                    float nearest, SkyHits &hits) const {
    hits.hit = hits.behind = {};
    hits.skyIndex = {};
    hits.distance = farthest;
    for (const Face &face : faces_)
        Test(face, origin, direction, nearest, hits);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        hits.hit[i] &= live[i], hits.behind[i] &= live[i];
}

} // namespace q3
