// GPL-2.0-or-later. Short rays among the few triangles around them.
#include "q3map2/lightmap/near_triangles.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace q3 {

namespace {

/// Triangles that are tested one by one; more are left to the scene.
constexpr std::size_t kFew = 96;
/// Bounds are taken this much larger. Game units.
constexpr float kSlack = 0.05f;
/// Triangles reach this share beyond their edges, so that no ray slips through between two.
constexpr float kEdge = 1e-5f;
constexpr float kLeastDeterminant = 1e-12f;

/// By value, since bytes that are written might be anything the compiler knows only by reference.
struct BoxRows {
    const float *minX, *minY, *minZ, *maxX, *maxY, *maxZ;
};

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

/// keep[i]: box i meets the box from..to.
Q3_VECTOR void MeetBox(const BoxRows b, std::size_t count, const Vec3f &from, const Vec3f &to,
                       std::uint8_t *__restrict keep) {
    const float x0 = from.x, y0 = from.y, z0 = from.z, x1 = to.x, y1 = to.y, z1 = to.z;
    for (std::size_t i = 0; i < count; ++i)
        keep[i] = (b.minX[i] <= x1) & (b.maxX[i] >= x0) & (b.minY[i] <= y1) & (b.maxY[i] >= y0) & (b.minZ[i] <= z1) &
                  (b.maxZ[i] >= z0);
}

/// Takes out of keep boxes that are farther than `reach` from the box from..to.
Q3_VECTOR void DropFar(const BoxRows b, std::size_t count, const Vec3f &from, const Vec3f &to, float reach,
                       std::uint8_t *__restrict keep) {
    const float x0 = from.x, y0 = from.y, z0 = from.z, x1 = to.x, y1 = to.y, z1 = to.z, most = reach * reach;
    for (std::size_t i = 0; i < count; ++i) {
        const float x = std::max(std::max(b.minX[i] - x1, x0 - b.maxX[i]), 0.0f);
        const float y = std::max(std::max(b.minY[i] - y1, y0 - b.maxY[i]), 0.0f);
        const float z = std::max(std::max(b.minZ[i] - z1, z0 - b.maxZ[i]), 0.0f);
        keep[i] = keep[i] & (x * x + y * y + z * z <= most);
    }
}

/// keep[i]: box i is met by the beam's start as it moves along.
Q3_VECTOR void MeetBeam(const BoxRows b, std::size_t count, const RayBeam &beam, std::uint8_t *__restrict keep) {
    constexpr float kNever = 1e30f; // of an axis along which the beam does not move
    const auto inverse = [](float d) { return d == 0 ? kNever : 1 / d; };
    const float ix = inverse(beam.direction.x), iy = inverse(beam.direction.y), iz = inverse(beam.direction.z);
    const float x0 = beam.from.x, y0 = beam.from.y, z0 = beam.from.z;
    const float x1 = beam.to.x, y1 = beam.to.y, z1 = beam.to.z, length = beam.length;
    for (std::size_t i = 0; i < count; ++i) {
        const float xa = (b.minX[i] - x1) * ix, xb = (b.maxX[i] - x0) * ix;
        const float ya = (b.minY[i] - y1) * iy, yb = (b.maxY[i] - y0) * iy;
        const float za = (b.minZ[i] - z1) * iz, zb = (b.maxZ[i] - z0) * iz;
        const float enter = std::max(std::max(std::min(xa, xb), std::min(ya, yb)), std::max(std::min(za, zb), 0.0f));
        const float leave = std::min(std::min(std::max(xa, xb), std::max(ya, yb)), std::min(std::max(za, zb), length));
        keep[i] = enter <= leave;
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

void NearTriangles::Add(const LightScene::BlockerTriangle &triangle) {
    const auto &[a, b, c] = triangle.corners;
    const Vec3f low = Min(a, Min(b, c)), high = Max(a, Max(b, c)), ab = b - a, ac = c - a;
    std::size_t row = 0;
    for (const Vec3f &v : {low, high, a, ab, ac})
        for (const float number : {v.x, v.y, v.z})
            rows_[row++].push_back(number);
    surface_.push_back(triangle.surface);
    seeThrough_.push_back(triangle.seeThrough ? 1 : 0);
}

/// Those of `from` that keep_ says.
void NearTriangles::Copy(const NearTriangles &from) {
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < from.Count(); ++i)
        if (keep_[i] != 0)
            kept.push_back(i);
    const auto copy = [&](const auto &source, auto &target) {
        target.resize(kept.size());
        for (std::size_t i = 0; i < kept.size(); ++i)
            target[i] = source[kept[i]];
    };
    for (std::size_t row = 0; row < kRows; ++row)
        copy(from.rows_[row], rows_[row]);
    copy(from.surface_, surface_);
    copy(from.seeThrough_, seeThrough_);
}

void NearTriangles::KeepNear(const NearTriangles &from, const Boundsf &starts, float reach) {
    keep_.resize(from.Count());
    const auto &r = from.rows_;
    const BoxRows boxes{r[kMinX].data(), r[kMinY].data(), r[kMinZ].data(),
                        r[kMaxX].data(), r[kMaxY].data(), r[kMaxZ].data()};
    const Vec3f all{reach, reach, reach};
    MeetBox(boxes, from.Count(), starts.mins - all, starts.maxs + all, keep_.data());
    DropFar(boxes, from.Count(), starts.mins, starts.maxs, reach, keep_.data());
}

void NearTriangles::Select(const NearTriangles &from, const Boundsf &starts, float reach) {
    KeepNear(from, starts, reach);
    Copy(from);
}

void NearTriangles::Select(const NearTriangles &from, const Boundsf &starts, float reach, const Vec3f &normal,
                           float dist) {
    KeepNear(from, starts, reach);
    const auto &r = from.rows_;
    for (std::size_t i = 0; i < keep_.size(); ++i) {
        if (keep_[i] == 0)
            continue;
        const float corner = Dot(normal, {r[kX][i], r[kY][i], r[kZ][i]});
        const float b = Dot(normal, {r[kAx][i], r[kAy][i], r[kAz][i]});
        const float c = Dot(normal, {r[kBx][i], r[kBy][i], r[kBz][i]});
        keep_[i] = corner + std::max({b, c, 0.0f}) >= dist - kSlack ? 1 : 0;
    }
    Copy(from);
}

NearTriangles::Outcome NearTriangles::Trace(const RayPacket &packet, const LaneMask &live, const RayBeam &exact,
                                            float nearest, LightScene::Blockers &blockers) {
    if (Count() == 0)
        return Outcome::Missed;
    RayBeam beam = exact;
    const Vec3f slack{kSlack, kSlack, kSlack};
    beam.from -= slack, beam.to += slack;
    const BoxRows boxes{rows_[kMinX].data(), rows_[kMinY].data(), rows_[kMinZ].data(),
                        rows_[kMaxX].data(), rows_[kMaxY].data(), rows_[kMaxZ].data()};
    constexpr std::size_t kWord = sizeof(std::uint64_t);
    keep_.assign((Count() + kWord - 1) / kWord * kWord, 0);
    if (beam.narrow)
        MeetBeam(boxes, Count(), beam, keep_.data());
    else
        MeetBox(boxes, Count(), beam.from, beam.to, keep_.data());
    std::array<std::size_t, kFew> met;
    std::size_t count = 0;
    for (std::size_t word = 0; word < keep_.size(); word += kWord) {
        std::uint64_t any; // a byte of 0 or 1 each
        std::memcpy(&any, keep_.data() + word, kWord);
        for (; any != 0; any &= any - 1) {
            const std::size_t i = word + std::size_t(std::countr_zero(any)) / 8;
            if (count == kFew || seeThrough_[i] != 0)
                return Outcome::NotKnown;
            met[count++] = i;
        }
    }
    if (count == 0)
        return Outcome::Missed;
    blockers.hit = {};
    blockers.surface.fill(-1);
    blockers.distance = packet.distance;
    for (std::size_t i = 0; i < count; ++i)
        Test(met[i], packet, live, beam, nearest, blockers);
    return blockers.hit.Any() ? Outcome::Traced : Outcome::Missed;
}

namespace {

/// What Moeller and Trumbore's test of a triangle needs of the direction of a ray.
struct Slope {
    Vec3f direction, p;
    float inverse;
    bool flat; ///< the ray goes along the triangle
    Slope(const Vec3f &d, const Vec3f &a, const Vec3f &b) : direction(d), p(Cross(d, b)) {
        const float determinant = Dot(a, p);
        flat = std::abs(determinant) < kLeastDeterminant;
        inverse = 1 / (flat ? 1 : determinant);
    }
};

/// A triangle: its first corner and the edges from there.
struct Seen {
    Vec3f corner, a, b;
    std::int32_t surface;
};

/// The rest of the test, for ray i.
inline void TestRay(std::size_t i, const Seen &triangle, const Slope &slope, const RayPacket &packet,
                    const LaneMask &live, float nearest, LightScene::Blockers &blockers) {
    const Vec3f s = packet.origin[i] - triangle.corner, q = Cross(s, triangle.a);
    const float u = Dot(s, slope.p) * slope.inverse, v = Dot(slope.direction, q) * slope.inverse;
    const float t = Dot(triangle.b, q) * slope.inverse;
    const bool hit = !slope.flat & (live[i] != 0) & (u >= -kEdge) & (v >= -kEdge) & (u + v <= 1 + kEdge) &
                     (t >= nearest) & (t <= blockers.distance[i]);
    blockers.distance[i] = hit ? t : blockers.distance[i];
    blockers.surface[i] = hit ? triangle.surface : blockers.surface[i];
    blockers.hit[i] = hit ? -1 : blockers.hit[i];
}

Q3_VECTOR void TestPacket(const Seen triangle, const RayPacket &packet, const LaneMask &live, float nearest,
                          LightScene::Blockers &blockers) {
    for (std::size_t i = 0; i < kPacketSize; ++i)
        TestRay(i, triangle, Slope(packet.direction[i], triangle.a, triangle.b), packet, live, nearest, blockers);
}

/// The same values where all rays have one direction.
Q3_VECTOR void TestBeam(const Seen triangle, const Vec3f &direction, const RayPacket &packet, const LaneMask &live,
                        float nearest, LightScene::Blockers &blockers) {
    const Slope slope(direction, triangle.a, triangle.b);
    for (std::size_t i = 0; i < kPacketSize; ++i)
        TestRay(i, triangle, slope, packet, live, nearest, blockers);
}

} // namespace

void NearTriangles::Test(std::size_t triangle, const RayPacket &packet, const LaneMask &live, const RayBeam &beam,
                         float nearest, LightScene::Blockers &blockers) const {
    const auto row = [&](Row first) {
        return Vec3f{rows_[first][triangle], rows_[first + 1][triangle], rows_[first + 2][triangle]};
    };
    const Seen seen{row(kX), row(kAx), row(kBx), surface_[triangle]};
    if (beam.narrow)
        TestBeam(seen, beam.direction, packet, live, nearest, blockers);
    else
        TestPacket(seen, packet, live, nearest, blockers);
}

} // namespace q3
