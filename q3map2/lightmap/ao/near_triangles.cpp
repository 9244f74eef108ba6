// GPL-2.0-or-later. Brute-force intersection of short rays with the few triangles around them.
#include "q3map2/lightmap/ao/near_triangles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

namespace q3 {

namespace {

/// With more triangles in the bounds of a packet, tracing the scene is faster.
constexpr std::size_t kMaxTested = 96;
/// Margin added to the bounds of rays. Game units.
constexpr float kSlack = 0.05f;
/// Barycentric slack at edges, so that no ray slips through between two triangles.
constexpr float kEdgeSlack = 1e-5f;
/// Rays with a smaller determinant are parallel to the triangle.
constexpr float kLeastDeterminant = 1e-12f;

/// Bounds along one axis of the origins and ends of live rays.
void AxisBounds(const Lanes &origin, const Lanes &direction, const Lanes &length, const LaneMask &live, float &low,
                float &high) {
    Vectorize([&]() Q3_INLINE {
        constexpr float kInfinity = 1e30f; // beyond any coordinate
        float least = kInfinity, most = -kInfinity;
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float start = origin[i], end = start + direction[i] * length[i];
            least = std::min(least, live[i] != 0 ? std::min(start, end) : kInfinity);
            most = std::max(most, live[i] != 0 ? std::max(start, end) : -kInfinity);
        }
        low = least, high = most;
    });
}

/// Square of the distance between two boxes.
float SquaredGap(const Boundsf &a, const Boundsf &b) {
    const Vec3f gap = Max(Max(a.mins - b.maxs, b.mins - a.maxs), {});
    return Dot(gap, gap);
}

/// Triangles whose bounds are within `reach` of a box, and not behind a plane.
struct SearchRegion {
    Boundsf box;
    float reach = 0;
    Vec3f normal; ///< zero: no plane
    float dist = 0;
};

void FindNear(const NearTriangles::Group &group, const SearchRegion &region, LaneMask &near) {
    Vectorize([&]() Q3_INLINE {
        const Vec3f from = region.box.mins, to = region.box.maxs, n = region.normal;
        const float most = region.reach * region.reach, least = region.dist - kSlack;
        LaneMask found;
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const float x = std::max(std::max(group.mins.x[i] - to.x, from.x - group.maxs.x[i]), 0.0f);
            const float y = std::max(std::max(group.mins.y[i] - to.y, from.y - group.maxs.y[i]), 0.0f);
            const float z = std::max(std::max(group.mins.z[i] - to.z, from.z - group.maxs.z[i]), 0.0f);
            const float corner = Dot(n, group.corner[i]), rise1 = Dot(n, group.edge1[i]),
                        rise2 = Dot(n, group.edge2[i]);
            const float highest = corner + std::max(std::max(rise1, rise2), 0.0f);
            found[i] = ~(SignBits(most - (x * x + y * y + z * z)) | SignBits(highest - least)) >> 31;
        }
        near = found;
    });
}

void FindInBox(const NearTriangles::Group &group, const Vec3f &from, const Vec3f &to, LaneMask &inBox) {
    Vectorize([&]() Q3_INLINE {
        LaneMask found;
        for (std::size_t i = 0; i < kPacketSize; ++i)
            found[i] = ~(SignBits(to.x - group.mins.x[i]) | SignBits(group.maxs.x[i] - from.x) |
                         SignBits(to.y - group.mins.y[i]) | SignBits(group.maxs.y[i] - from.y) |
                         SignBits(to.z - group.mins.z[i]) | SignBits(group.maxs.z[i] - from.z)) >>
                       31;
        inBox = found;
    });
}

using Groups = std::span<const NearTriangles::Group>;

/// Intersects the rays with the triangles of `tested`, a bit for each by group, and sets the first hit of each ray
/// beyond `tnear`. Variables are named as in Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle Intersection,
/// 1997.
void IntersectTriangles(Groups groups, std::span<const unsigned> tested, const RayPacket &packet, const LaneMask &live,
                        const Lanes &tnear, LightScene::Blockers &first) {
    Vectorize([&, groups]() Q3_INLINE {
        LightScene::Blockers now = first; // a copy that aliases nothing
        for (std::size_t g = 0; g < groups.size(); ++g) {
            const NearTriangles::Group &group = groups[g];
            for (unsigned bits = tested[g]; bits != 0; bits &= bits - 1) {
                const auto k = std::size_t(std::countr_zero(bits));
                const Vec3f corner = group.corner[k], edge1 = group.edge1[k], edge2 = group.edge2[k];
                const std::int32_t surface = group.surface[k];
                for (std::size_t i = 0; i < kPacketSize; ++i) {
                    const Vec3f direction = packet.direction[i], pvec = Cross(direction, edge2),
                                tvec = packet.origin[i] - corner, qvec = Cross(tvec, edge1);
                    const float determinant = Dot(edge1, pvec), magnitude = std::abs(determinant);
                    const float inverse = 1 / (magnitude < kLeastDeterminant ? 1 : determinant);
                    const float u = Dot(tvec, pvec) * inverse, v = Dot(direction, qvec) * inverse,
                                t = Dot(edge2, qvec) * inverse;
                    // The sign bit is set if one of the conditions for a hit fails.
                    const std::int32_t misses = SignBits(magnitude - kLeastDeterminant) | SignBits(u + kEdgeSlack) |
                                                SignBits(v + kEdgeSlack) | SignBits(1 + kEdgeSlack - (u + v)) |
                                                SignBits(t - tnear[i]) | SignBits(now.distance[i] - t);
                    const std::int32_t hits = (~misses >> 31) & live[i];
                    now.distance[i] = hits != 0 ? t : now.distance[i];
                    now.surface[i] = hits != 0 ? surface : now.surface[i];
                    now.hit[i] |= hits;
                }
            }
        }
        first = now;
    });
}

} // namespace

Boundsf RayBounds(const RayPacket &packet) {
    Boundsf box;
    AxisBounds(packet.origin.x, packet.direction.x, packet.distance, packet.live, box.mins.x, box.maxs.x);
    AxisBounds(packet.origin.y, packet.direction.y, packet.distance, packet.live, box.mins.y, box.maxs.y);
    AxisBounds(packet.origin.z, packet.direction.z, packet.distance, packet.live, box.mins.z, box.maxs.z);
    return box;
}

void NearTriangles::Append(const Group &from, std::size_t lane) {
    const std::size_t to = count_++ % kPacketSize;
    if (to == 0)
        groups_.push_back(from); // later calls set its other lanes
    Group &last = groups_.back();
    for (auto row : {&Group::mins, &Group::maxs, &Group::corner, &Group::edge1, &Group::edge2})
        (last.*row).Set(to, (from.*row)[lane]);
    last.surface[to] = from.surface[lane];
    last.used = (2u << to) - 1;
    last.seeThrough = (to == 0 ? 0 : last.seeThrough) | ((from.seeThrough >> lane & 1u) << to);
}

void NearTriangles::Add(const LightScene::BlockerTriangle &triangle) {
    const auto &[a, b, c] = triangle.corners;
    Group one{};
    one.mins.Set(0, Min(a, Min(b, c))), one.maxs.Set(0, Max(a, Max(b, c)));
    one.corner.Set(0, a), one.edge1.Set(0, b - a), one.edge2.Set(0, c - a);
    one.surface[0] = triangle.surface;
    one.seeThrough = triangle.seeThrough ? 1 : 0;
    Append(one, 0);
    bounds_.resize(groups_.size());
    bounds_.back().Add(Boundsf{one.mins[0], one.maxs[0]});
}

void NearTriangles::Select(const NearTriangles &from, const Boundsf &starts, float reach) {
    Select(from, starts, reach, {}, 0);
}

void NearTriangles::Select(const NearTriangles &from, const Boundsf &starts, float reach, const Vec3f &normal,
                           float dist) {
    groups_.clear(), bounds_.clear();
    count_ = 0;
    const SearchRegion region{starts, reach, normal, dist};
    LaneMask near;
    for (std::size_t group = 0; group < from.groups_.size(); ++group) {
        if (group < from.bounds_.size() && SquaredGap(from.bounds_[group], starts) > reach * reach)
            continue;
        FindNear(from.groups_[group], region, near);
        for (unsigned lanes = near.Bits() & from.groups_[group].used; lanes != 0; lanes &= lanes - 1)
            Append(from.groups_[group], std::size_t(std::countr_zero(lanes)));
    }
}

NearTriangles::Outcome NearTriangles::FindInBounds(const Boundsf &bounds) {
    const Vec3f slack{kSlack, kSlack, kSlack};
    bool any = false;
    std::size_t found = 0; // triangles in the bounds; counted only if count_ is over the limit
    LaneMask lanes;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
        FindInBox(groups_[i], bounds.mins - slack, bounds.maxs + slack, lanes);
        const unsigned inBounds = lanes.Bits() & groups_[i].used;
        if (count_ > kMaxTested)
            found += std::size_t(std::popcount(inBounds));
        if (found > kMaxTested || (inBounds & groups_[i].seeThrough) != 0)
            return Outcome::Undecided;
        inBounds_[i] = inBounds;
        any = any || inBounds != 0;
    }
    return any ? Outcome::Traced : Outcome::Missed;
}

NearTriangles::Outcome NearTriangles::Trace(const RayPacket &packet, const LaneMask &live, const Boundsf &bounds,
                                            float tnear, LightScene::Blockers &blockers) {
    inBounds_.resize(groups_.size());
    if (const Outcome outcome = FindInBounds(bounds); outcome != Outcome::Traced)
        return outcome;
    Lanes tnears;
    tnears.fill(tnear);
    return TraceNextHit(packet, live, tnears, blockers);
}

NearTriangles::Outcome NearTriangles::TraceNextHit(const RayPacket &packet, const LaneMask &live, const Lanes &tnear,
                                                   LightScene::Blockers &blockers) const {
    blockers.hit = {};
    blockers.surface.fill(-1);
    blockers.distance = packet.distance;
    IntersectTriangles(groups_, inBounds_, packet, live, tnear, blockers);
    return blockers.hit.Any() ? Outcome::Traced : Outcome::Missed;
}

} // namespace q3
