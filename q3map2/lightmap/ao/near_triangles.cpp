// GPL-2.0-or-later. Short rays among the few triangles around them.
#include "q3map2/lightmap/ao/near_triangles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

namespace q3 {

namespace {

/// Triangles that are tested one by one; more are left to the scene.
constexpr std::size_t kFew = 96;
/// Bounds are taken this much larger. Game units.
constexpr float kSlack = 0.05f;
/// Triangles reach this share beyond their edges, so that no ray slips through between two.
constexpr float kEdge = 1e-5f;
constexpr float kLeastDeterminant = 1e-12f;

} // namespace

/// A narrow beam: where its rays start, as a box around its middle, and how far along they may meet something.
struct NearTriangles::NarrowBeam {
    Vec3f direction, middle, half;
    float nearest, length;
    NarrowBeam(const RayBeam &beam, float nearestAt)
        : direction(beam.direction), middle((beam.from + beam.to) * 0.5f),
          half((beam.to - beam.from) * 0.5f + Vec3f{kSlack, kSlack, kSlack}), nearest(nearestAt), length(beam.length) {}
};

namespace {

/// Bounds of the starts of live rays and of their ends. False: their directions differ.
Q3_VECTOR bool Extents(const RayPacket &packet, std::array<float, 6> &low, std::array<float, 6> &high) {
    constexpr float kNone = 1e30f;
    const Lanes *const origins[3] = {&packet.origin.x, &packet.origin.y, &packet.origin.z};
    const Lanes *const directions[3] = {&packet.direction.x, &packet.direction.y, &packet.direction.z};
    bool same = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const Lanes &o = *origins[axis], &d = *directions[axis];
        float lowStart = kNone, highStart = -kNone, lowEnd = kNone, highEnd = -kNone;
        float lowWay = kNone, highWay = -kNone;
        for (std::size_t i = 0; i < kPacketSize; ++i) {
            const bool live = packet.live[i] != 0;
            const float end = o[i] + d[i] * packet.distance[i];
            lowStart = std::min(lowStart, live ? o[i] : kNone), highStart = std::max(highStart, live ? o[i] : -kNone);
            lowEnd = std::min(lowEnd, live ? end : kNone), highEnd = std::max(highEnd, live ? end : -kNone);
            lowWay = std::min(lowWay, live ? d[i] : kNone), highWay = std::max(highWay, live ? d[i] : -kNone);
        }
        low[axis] = lowStart, high[axis] = highStart;
        low[axis + 3] = lowEnd, high[axis + 3] = highEnd;
        same &= lowWay == highWay;
    }
    return same;
}

/// Square of the distance between two boxes.
float Gap2(const Boundsf &a, const Boundsf &b) {
    const Vec3f gap = Max(Max(a.mins - b.maxs, b.mins - a.maxs), {});
    return Dot(gap, gap);
}

/// Triangles whose bounds are within `reach` of a box, and not behind a plane.
struct Neighbourhood {
    Boundsf box;
    float reach = 0;
    Vec3f normal; ///< zero: no plane
    float dist = 0;
};

Q3_VECTOR void FindNear(const NearTriangles::Group &group, const Neighbourhood &around, LaneMask &near) {
    const Vec3f from = around.box.mins, to = around.box.maxs, n = around.normal;
    const float most = around.reach * around.reach, least = around.dist - kSlack;
    LaneMask found;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const float x = std::max(std::max(group.mins.x[i] - to.x, from.x - group.maxs.x[i]), 0.0f);
        const float y = std::max(std::max(group.mins.y[i] - to.y, from.y - group.maxs.y[i]), 0.0f);
        const float z = std::max(std::max(group.mins.z[i] - to.z, from.z - group.maxs.z[i]), 0.0f);
        const float corner = Dot(n, group.corner[i]), a = Dot(n, group.a[i]), b = Dot(n, group.b[i]);
        const float highest = corner + std::max(std::max(a, b), 0.0f);
        found[i] = ~(Sign(most - (x * x + y * y + z * z)) | Sign(highest - least)) >> 31;
    }
    near = found;
}

Q3_VECTOR void FindInBox(const NearTriangles::Group &group, const Vec3f &from, const Vec3f &to, LaneMask &met) {
    LaneMask found;
    for (std::size_t i = 0; i < kPacketSize; ++i)
        found[i] = ~(Sign(to.x - group.mins.x[i]) | Sign(group.maxs.x[i] - from.x) | Sign(to.y - group.mins.y[i]) |
                     Sign(group.maxs.y[i] - from.y) | Sign(to.z - group.mins.z[i]) | Sign(group.maxs.z[i] - from.z)) >>
                   31;
    met = found;
}

/// Moeller and Trumbore's test, as far as it is the same for all rays of a beam.
Q3_VECTOR void SetForms(const NearTriangles::Group &group, const NearTriangles::NarrowBeam &beam,
                        NearTriangles::Forms &__restrict forms, LaneMask &__restrict met) {
    const Vec3f d = beam.direction, h = beam.half;
    const auto reach = [&](const Vec3f &v) { return std::abs(v.x) * h.x + std::abs(v.y) * h.y + std::abs(v.z) * h.z; };
    NearTriangles::LinearForm &us = forms.u, &vs = forms.v, &ts = forms.t;
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        const Vec3f a = group.a[i], b = group.b[i], s = beam.middle - group.corner[i], p = Cross(d, b);
        const float determinant = Dot(a, p), size = std::abs(determinant);
        const float inverse = 1 / (size < kLeastDeterminant ? 1 : determinant);
        const Vec3f u = p * inverse, v = Cross(a, d) * inverse, t = group.normal[i] * inverse;
        const float um = Dot(s, u), vm = Dot(s, v), tm = Dot(s, t), tr = reach(t);
        us.slope.x[i] = u.x, us.slope.y[i] = u.y, us.slope.z[i] = u.z, us.middle[i] = um;
        vs.slope.x[i] = v.x, vs.slope.y[i] = v.y, vs.slope.z[i] = v.z, vs.middle[i] = vm;
        ts.slope.x[i] = t.x, ts.slope.y[i] = t.y, ts.slope.z[i] = t.z, ts.middle[i] = tm;
        met[i] = ~(Sign(size - kLeastDeterminant) | Sign(um + reach(u) + kEdge) | Sign(vm + reach(v) + kEdge) |
                   Sign(1 + kEdge - (um + vm) + reach(u + v)) | Sign(tm + tr - beam.nearest) |
                   Sign(beam.length - (tm - tr))) >>
                 31;
    }
}

using Groups = std::span<const NearTriangles::Group>;
using GroupForms = std::span<const NearTriangles::Forms>;

/// The rest of the test, for the triangles that `met` says and all rays: those that meet one before what they have met
/// so far.
Q3_VECTOR void MeetTriangles(Groups groups, GroupForms all, const Lanes3 &starts, const LaneMask &live,
                             const Lanes &nearest, LightScene::Blockers &first) {
    LightScene::Blockers now = first; // out of the way of what is read
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const NearTriangles::Forms &forms = all[g];
        for (unsigned met = forms.met; met != 0; met &= met - 1) {
            const auto k = std::size_t(std::countr_zero(met));
            const Vec3f u = forms.u.slope[k], v = forms.v.slope[k], t = forms.t.slope[k];
            const float um = forms.u.middle[k], vm = forms.v.middle[k], tm = forms.t.middle[k];
            const std::int32_t surface = groups[g].surface[k];
            for (std::size_t i = 0; i < kPacketSize; ++i) {
                const Vec3f start = starts[i];
                const float ui = um + Dot(u, start), vi = vm + Dot(v, start), ti = tm + Dot(t, start);
                const std::int32_t out = Sign(ui + kEdge) | Sign(vi + kEdge) | Sign(1 + kEdge - (ui + vi)) |
                                         Sign(ti - nearest[i]) | Sign(now.distance[i] - ti);
                const std::int32_t meets = (~out >> 31) & live[i];
                now.distance[i] = meets != 0 ? ti : now.distance[i];
                now.surface[i] = meets != 0 ? surface : now.surface[i];
                now.hit[i] |= meets;
            }
        }
    }
    first = now;
}

/// The whole test where directions differ.
Q3_VECTOR void MeetTriangles(Groups groups, GroupForms forms, const RayPacket &packet, const LaneMask &live,
                             const Lanes &nearest, LightScene::Blockers &first) {
    LightScene::Blockers now = first; // out of the way of what is read
    for (std::size_t g = 0; g < groups.size(); ++g) {
        const NearTriangles::Group &group = groups[g];
        for (unsigned met = forms[g].met; met != 0; met &= met - 1) {
            const auto k = std::size_t(std::countr_zero(met));
            const Vec3f corner = group.corner[k], a = group.a[k], b = group.b[k];
            const std::int32_t surface = group.surface[k];
            for (std::size_t i = 0; i < kPacketSize; ++i) {
                const Vec3f d = packet.direction[i], p = Cross(d, b), s = packet.origin[i] - corner, q = Cross(s, a);
                const float determinant = Dot(a, p), size = std::abs(determinant);
                const float inverse = 1 / (size < kLeastDeterminant ? 1 : determinant);
                const float u = Dot(s, p) * inverse, v = Dot(d, q) * inverse, t = Dot(b, q) * inverse;
                const std::int32_t out = Sign(size - kLeastDeterminant) | Sign(u + kEdge) | Sign(v + kEdge) |
                                         Sign(1 + kEdge - (u + v)) | Sign(t - nearest[i]) | Sign(now.distance[i] - t);
                const std::int32_t meets = (~out >> 31) & live[i];
                now.distance[i] = meets != 0 ? t : now.distance[i];
                now.surface[i] = meets != 0 ? surface : now.surface[i];
                now.hit[i] |= meets;
            }
        }
    }
    first = now;
}

Q3_VECTOR void SetStarts(const Lanes3 &origin, const Vec3f &middle, Lanes3 &starts) {
    for (std::size_t i = 0; i < kPacketSize; ++i) {
        starts.x[i] = origin.x[i] - middle.x;
        starts.y[i] = origin.y[i] - middle.y;
        starts.z[i] = origin.z[i] - middle.z;
    }
}

} // namespace

RayBeam BeamOf(const RayPacket &packet) {
    RayBeam beam;
    std::array<float, 6> low, high;
    beam.narrow = Extents(packet, low, high);
    beam.from = {low[0], low[1], low[2]}, beam.to = {high[0], high[1], high[2]};
    if (!beam.narrow) {
        beam.from = Min(beam.from, {low[3], low[4], low[5]});
        beam.to = Max(beam.to, {high[3], high[4], high[5]});
    }
    const auto first = std::size_t(std::find(packet.live.begin(), packet.live.end(), -1) - packet.live.begin());
    if (first < kPacketSize)
        beam.direction = packet.direction[first];
    beam.length = *std::max_element(packet.distance.begin(), packet.distance.end());
    return beam;
}

void NearTriangles::Append(const Group &from, std::size_t lane) {
    const std::size_t to = count_++ % kPacketSize;
    if (to == 0)
        groups_.push_back(from); // its lanes are set one by one from here on
    Group &last = groups_.back();
    for (auto row : {&Group::mins, &Group::maxs, &Group::corner, &Group::a, &Group::b, &Group::normal})
        (last.*row).Set(to, (from.*row)[lane]);
    last.surface[to] = from.surface[lane];
    last.used = (2u << to) - 1;
    last.seeThrough = (to == 0 ? 0 : last.seeThrough) | ((from.seeThrough >> lane & 1u) << to);
}

void NearTriangles::Add(const LightScene::BlockerTriangle &triangle) {
    const auto &[a, b, c] = triangle.corners;
    Group one{};
    one.mins.Set(0, Min(a, Min(b, c))), one.maxs.Set(0, Max(a, Max(b, c)));
    one.corner.Set(0, a), one.a.Set(0, b - a), one.b.Set(0, c - a), one.normal.Set(0, Cross(b - a, c - a));
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
    const Neighbourhood around{starts, reach, normal, dist};
    LaneMask near;
    for (std::size_t group = 0; group < from.groups_.size(); ++group) {
        if (group < from.bounds_.size() && Gap2(from.bounds_[group], starts) > reach * reach)
            continue;
        FindNear(from.groups_[group], around, near);
        for (unsigned lanes = near.Bits() & from.groups_[group].used; lanes != 0; lanes &= lanes - 1)
            Append(from.groups_[group], std::size_t(std::countr_zero(lanes)));
    }
}

NearTriangles::Outcome NearTriangles::FindMet(const RayBeam &beam, const NarrowBeam &narrow) {
    const Vec3f slack{kSlack, kSlack, kSlack};
    bool any = false;
    std::size_t many = 0; // counted where there may be too many
    LaneMask lanes;
    for (std::size_t i = 0; i < groups_.size(); ++i) {
        if (beam.narrow)
            SetForms(groups_[i], narrow, forms_[i], lanes);
        else
            FindInBox(groups_[i], beam.from - slack, beam.to + slack, lanes);
        const unsigned met = lanes.Bits() & groups_[i].used;
        if (count_ > kFew)
            many += std::size_t(std::popcount(met));
        if (many > kFew || (met & groups_[i].seeThrough) != 0)
            return Outcome::Undecided;
        forms_[i].met = met;
        any = any || met != 0;
    }
    return any ? Outcome::Traced : Outcome::Missed;
}

NearTriangles::Outcome NearTriangles::Trace(const RayPacket &packet, const LaneMask &live, const RayBeam &beam,
                                            float nearest, LightScene::Blockers &blockers) {
    if (forms_.size() < groups_.size())
        forms_.resize(groups_.size());
    const NarrowBeam narrow(beam, nearest);
    narrow_ = beam.narrow, middle_ = narrow.middle;
    if (const Outcome outcome = FindMet(beam, narrow); outcome != Outcome::Traced)
        return outcome;
    Lanes nearests;
    nearests.fill(nearest);
    return TraceNextHit(packet, live, nearests, blockers);
}

NearTriangles::Outcome NearTriangles::TraceNextHit(const RayPacket &packet, const LaneMask &live, const Lanes &nearest,
                                                   LightScene::Blockers &blockers) const {
    blockers.hit = {};
    blockers.surface.fill(-1);
    blockers.distance = packet.distance;
    if (narrow_) {
        Lanes3 starts;
        SetStarts(packet.origin, middle_, starts);
        MeetTriangles(groups_, forms_, starts, live, nearest, blockers);
    } else
        MeetTriangles(groups_, forms_, packet, live, nearest, blockers);
    return blockers.hit.Any() ? Outcome::Traced : Outcome::Missed;
}

} // namespace q3
