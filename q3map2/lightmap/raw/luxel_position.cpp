// GPL-2.0-or-later. The position at which a luxel is lit: near its surface, clear of solids.
#include "q3map2/lightmap/raw/luxel_position.h"

#include "q3map2/lightmap/raw/luxel_raster.h"

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
constexpr int kTriangleRounds = 3; // moving off one edge may cross another

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

/// Moves p into the triangle.
Vec3f MovedIntoTriangle(Vec3f p, const std::array<SurfaceVertex, 3> &triangle, const Vec3f &normal) {
    for (int round = 0; round < kTriangleRounds; ++round)
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3f &a = triangle[i].xyz, &b = triangle[(i + 1) % 3].xyz, &inner = triangle[(i + 2) % 3].xyz;
            Vec3f out = Normalize(Cross(b - a, normal));
            if (Dot(out, inner - a) > 0)
                out = -out;
            const float beyond = Dot(out, p - a);
            if (beyond > -kEdgeMargin)
                p -= out * (beyond + 1);
        }
    return p;
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

Vec3f LuxelPositionFinder::OnSurface(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane) const {
    Vec3f p = raw_.hasVectors ? OnPlane(float(x), float(y), plane) : sample->xyz;
    if (in_.lightmap.triangleCheck && plane.triangle)
        p = MovedIntoTriangle(p, *plane.triangle, plane.normal);
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

LuxelPosition LuxelPositionFinder::Centered(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane,
                                            float offset, VisibleClusters &filter, PositionCounts &counts) {
    Vec3f p = OnSurface(x, y, sample, plane);
    if (raw_.hasVectors)
        p[axes_.along] += plane.normal[axes_.along] >= 0 ? offset : -offset;
    else
        p += plane.normal * offset;
    const int cluster = ClusterAt(p + ClusterLookupOffset(plane), filter);
    counts.nudges[0] += cluster >= 0;
    return {p, cluster};
}

Vec3f LuxelPositionFinder::Fallback(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane,
                                    float offset) const {
    if (sample)
        return sample->xyz + sample->normal * offset;
    const auto &[a, b, c] = *plane.triangle;
    const auto [across, down] = ClippedCenter({a.luxel, b.luxel, c.luxel}, x, y);
    return OnPlane(across - 0.5f, down - 0.5f, plane) + a.normal * offset;
}

Boundsf LuxelPositionFinder::FallbackBounds(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane,
                                            float offset) const {
    Boundsf box;
    if (sample)
        box.Add(Fallback(x, y, sample, plane, offset));
    else
        for (const float across : {-0.5f, 0.5f})
            for (const float down : {-0.5f, 0.5f})
                box.Add(OnPlane(float(x) + across, float(y) + down, plane) + (*plane.triangle)[0].normal * offset);
    return box;
}

LuxelPosition LuxelPositionFinder::Nudged(int x, int y, const Vec3f &center, const SurfaceVertex *sample,
                                          const LuxelPlane &plane, float offset, bool allowFallback,
                                          VisibleClusters &filter, PositionCounts &counts) {
    const Vec3f lookupOffset = ClusterLookupOffset(plane);
    const auto steps = StepsOfNudges(plane);
    Boundsf box = BoxAround(center + lookupOffset, steps);
    if (allowFallback)
        box.Add(FallbackBounds(x, y, sample, plane, offset));
    if (in_.lightmap.dark || !AnyOpen(box)) {
        ++counts.failed;
        return {};
    }
    for (const LuxelSteps &stepPair : steps)
        for (std::size_t i = 0; i < kNudges.size() && stepPair != LuxelSteps{}; ++i) {
            const Vec3f nudged = center + NudgeOf(i, stepPair);
            if (const int cluster = ClusterAt(nudged + lookupOffset, filter); cluster >= 0) {
                ++counts.nudges[i + 1];
                return {nudged, cluster};
            }
        }
    LuxelPosition position;
    if (allowFallback) {
        position.xyz = Fallback(x, y, sample, plane, offset);
        position.cluster = ClusterAt(position.xyz, filter);
    }
    ++(position.Occluded() ? counts.failed : counts.atVertex);
    return position;
}

} // namespace q3
