// GPL-2.0-or-later. The position at which a luxel is lit: near its surface, clear of solids.
#include "q3map2/lightmap/raw/luxel_position.h"

#include "q3map2/light/scene/light_way.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

/// Positions this near to an opaque brush count as inside it. Game units.
constexpr float kBrushEpsilon = 0.125f;
/// -trianglecheck: positions closer than this to an edge are moved to 1 unit inside of it. Game units.
constexpr float kEdgeMargin = 0.125f;
/// Triangles with less than half this area in the lightmap give no luxel steps. Square luxels.
constexpr float kLeastTwiceArea = 1e-4f;
/// Spacing of luxels on a curve, as a share of the nominal luxel size, below which a nudge of half a luxel leaves the
/// curve.
constexpr float kDense = 0.5f;
/// Distance from an edge of a triangle, in game units, at which a point over it is certainly not on the face of the
/// wall that the edge may run along.
constexpr float kInward = 0.25f;
/// A position is moved off all edges of a triangle this often, since a move off one may cross another.
constexpr int kTriangleRounds = 3;

/// Offsets in half luxels, in the order in which they are tried.
constexpr std::array<std::array<float, 2>, 8> kNudges{
    {{-1, 0}, {1, 0}, {0, 1}, {0, -1}, {-1, 1}, {1, -1}, {1, 1}, {-1, -1}}};

Vec3f NudgeOf(std::size_t i, const LuxelSteps &steps) {
    return steps[0] * (kNudges[i][0] * 0.5f) + steps[1] * (kNudges[i][1] * 0.5f);
}

/// Bounds of p and its nudged positions.
Boundsf BoxAround(const Vec3f &p, const std::array<LuxelSteps, 2> &steps) {
    Boundsf box;
    box.Add(p);
    for (const LuxelSteps &stepPair : steps)
        for (std::size_t i = 0; i < kNudges.size(); ++i)
            box.Add(p + NudgeOf(i, stepPair));
    return box;
}

/// Unit tangent vectors of a surface with normal n, perpendicular to each other.
std::array<Vec3f, 2> Tangents(const Vec3f &n) {
    const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const Vec3f smallest = x <= y && x <= z ? Vec3f{1, 0, 0} : y <= z ? Vec3f{0, 1, 0} : Vec3f{0, 0, 1};
    const Vec3f right = Normalize(Cross(smallest, n));
    return {right, Cross(right, n)};
}

/// Moves p to the inside of edges of the triangle that are nearer than `margin` to it, or that it is beyond: as far as
/// `inset` from each. Game units.
Vec3f MovedIntoTriangle(Vec3f p, const std::array<SurfaceVertex, 3> &triangle, const Vec3f &normal, float margin,
                        float inset) {
    for (int round = 0; round < kTriangleRounds; ++round)
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3f &a = triangle[i].xyz, &b = triangle[(i + 1) % 3].xyz, &inner = triangle[(i + 2) % 3].xyz;
            Vec3f out = Normalize(Cross(b - a, normal));
            if (Dot(out, inner - a) > 0)
                out = -out;
            const float beyond = Dot(out, p - a);
            if (beyond > -margin)
                p -= out * (beyond + inset);
        }
    return p;
}

LuxelTriangle LuxelsOf(const std::array<SurfaceVertex, 3> &triangle) {
    return {triangle[0].luxel, triangle[1].luxel, triangle[2].luxel};
}

} // namespace

LuxelSteps LuxelStepsOf(const SurfaceVertex &a, const SurfaceVertex &b, const SurfaceVertex &c) {
    const Vec3f p = b.xyz - a.xyz, q = c.xyz - a.xyz;
    const float pu = b.luxel[0] - a.luxel[0], pv = b.luxel[1] - a.luxel[1];
    const float qu = c.luxel[0] - a.luxel[0], qv = c.luxel[1] - a.luxel[1], twiceArea = pu * qv - qu * pv;
    if (std::abs(twiceArea) < kLeastTwiceArea)
        return {};
    return {(p * qv - q * pv) / twiceArea, (q * pu - p * qu) / twiceArea};
}

int LuxelPositionFinder::ClusterAt(const Vec3f &p, VisibleClusters &filter) const {
    return filter.ClusterIfAllowed(in_.space.ClusterAt(p, kBrushEpsilon));
}

bool LuxelPositionFinder::AnyOpen(const Boundsf &box) const {
    const Vec3f margin{kAtLeaf, kAtLeaf, kAtLeaf};
    return in_.space.AnyOpen(box.mins - margin, box.maxs + margin, kBrushEpsilon);
}

Vec3f LuxelPositionFinder::OnPlane(float x, float y, const LuxelPlane &plane) const {
    return OntoPlane(raw_.origin + raw_.step[0] * x + raw_.step[1] * y, axes_.along, plane.normal, plane.dist);
}

Vec3f LuxelPositionFinder::OnSurface(const Request &luxel) const {
    const LuxelPlane &plane = luxel.plane;
    Vec3f p = raw_.hasVectors ? OnPlane(float(luxel.x), float(luxel.y), plane) : luxel.sample->xyz;
    if (in_.lightmap.triangleCheck && plane.triangle)
        p = MovedIntoTriangle(p, *plane.triangle, plane.normal, kEdgeMargin, 1);
    return p;
}

std::array<LuxelSteps, 2> LuxelPositionFinder::StepsOfNudges(const LuxelPlane &plane) const {
    if (raw_.planar)
        return {raw_.step};
    const float size = raw_.actualSampleSize / float(raw_.super);
    auto whole = Tangents(plane.normal);
    for (Vec3f &step : whole)
        step *= size;
    LuxelSteps own = plane.steps;
    const float spacing = std::min(Length(own[0]), Length(own[1]));
    if (spacing == 0 || spacing >= kDense * size)
        return {whole};
    for (Vec3f &step : own)
        if (const float length = Length(step); length > size)
            step *= size / length;
    return {own, whole};
}

Vec3f LuxelPositionFinder::Lifted(Vec3f p, const LuxelPlane &plane, float offset) const {
    if (!raw_.hasVectors)
        return p + plane.normal * offset;
    p[axes_.along] += plane.normal[axes_.along] >= 0 ? offset : -offset;
    return p;
}

std::array<float, 2> LuxelPositionFinder::LuxelCoordinates(const Vec3f &p) const {
    const Vec3f from = p - raw_.origin;
    return {from[axes_.u] / raw_.step[0][axes_.u] + 0.5f, from[axes_.v] / raw_.step[1][axes_.v] + 0.5f};
}

bool LuxelPositionFinder::CoversCenter(const Request &luxel) const {
    if (!raw_.hasVectors)
        return true; // the center is the sample
    return luxel.plane.triangle && ContainsCenter(LuxelsOf(*luxel.plane.triangle), luxel.x, luxel.y);
}

Vec3f LuxelPositionFinder::Anchor(const Request &luxel) const {
    if (!luxel.plane.triangle)
        return luxel.sample->xyz + luxel.sample->normal * luxel.offset;
    const std::array<SurfaceVertex, 3> &triangle = *luxel.plane.triangle;
    Vec3f p;
    if (raw_.hasVectors) {
        const std::array<float, 2> center{float(luxel.x) + 0.5f, float(luxel.y) + 0.5f};
        const auto [across, down] = NearestInside(LuxelsOf(triangle), center);
        p = Lifted(OnPlane(across - 0.5f, down - 0.5f, luxel.plane), luxel.plane, luxel.offset);
    } else {
        p = luxel.sample->xyz + luxel.sample->normal * luxel.offset;
    }
    return MovedIntoTriangle(p, triangle, luxel.plane.normal, kInward, kInward);
}

bool LuxelPositionFinder::IsOnItsSide(const Request &luxel, const Vec3f &p) const {
    if (luxel.IsBeside())
        return std::any_of(luxel.neighbors.begin(), luxel.neighbors.end(),
                           [&](const Vec3f &from) { return WayBetween(in_.space, from, p) == Way::Open; });
    return WayBetween(in_.space, Anchor(luxel), p) != Way::Blocked;
}

bool LuxelPositionFinder::IsOverTriangle(const LuxelPlane &plane, const Vec3f &p) const {
    return raw_.planar || !raw_.hasVectors || !plane.triangle ||
           Contains(LuxelsOf(*plane.triangle), LuxelCoordinates(p));
}

LuxelPosition LuxelPositionFinder::Centered(const Request &luxel, VisibleClusters &filter, PositionCounts &counts) {
    const Vec3f p = Lifted(OnSurface(luxel), luxel.plane, luxel.offset);
    int cluster = ClusterAt(p + ClusterLookupOffset(luxel.plane), filter);
    if (cluster >= 0 && !CoversCenter(luxel) && !IsOnItsSide(luxel, p))
        cluster = kSolidCluster;
    counts.nudges[0] += cluster >= 0;
    return {p, cluster};
}

Vec3f LuxelPositionFinder::Fallback(const Request &luxel) const {
    if (luxel.sample)
        return luxel.sample->xyz + luxel.sample->normal * luxel.offset;
    const auto [across, down] = ClippedCenter(LuxelsOf(*luxel.plane.triangle), luxel.x, luxel.y);
    return OnPlane(across - 0.5f, down - 0.5f, luxel.plane) + (*luxel.plane.triangle)[0].normal * luxel.offset;
}

Boundsf LuxelPositionFinder::FallbackBounds(const Request &luxel) const {
    Boundsf box;
    if (luxel.sample)
        box.Add(Fallback(luxel));
    else
        for (const float across : {-0.5f, 0.5f})
            for (const float down : {-0.5f, 0.5f})
                box.Add(OnPlane(float(luxel.x) + across, float(luxel.y) + down, luxel.plane) +
                        (*luxel.plane.triangle)[0].normal * luxel.offset);
    return box;
}

LuxelPosition LuxelPositionFinder::Nudged(const Request &luxel, const Vec3f &center, VisibleClusters &filter,
                                          PositionCounts &counts) {
    const Vec3f lookupOffset = ClusterLookupOffset(luxel.plane);
    const auto steps = StepsOfNudges(luxel.plane);
    Boundsf box = BoxAround(center + lookupOffset, steps);
    if (!luxel.IsBeside())
        box.Add(FallbackBounds(luxel));
    if (in_.lightmap.dark || !AnyOpen(box)) {
        ++counts.failed;
        return {};
    }
    for (const LuxelSteps &stepPair : steps)
        for (std::size_t i = 0; i < kNudges.size() && stepPair != LuxelSteps{}; ++i) {
            const Vec3f nudged = center + NudgeOf(i, stepPair);
            const int cluster = ClusterAt(nudged + lookupOffset, filter);
            if (cluster >= 0 && IsOverTriangle(luxel.plane, nudged) && IsOnItsSide(luxel, nudged)) {
                ++counts.nudges[i + 1];
                return {nudged, cluster};
            }
        }
    LuxelPosition position;
    if (!luxel.IsBeside()) {
        position.xyz = Fallback(luxel);
        position.cluster = ClusterAt(position.xyz, filter);
    }
    ++(position.Occluded() ? counts.failed : counts.atVertex);
    return position;
}

} // namespace q3
