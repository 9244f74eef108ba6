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
constexpr int kTriangleRounds = 3; // moving off one edge may cross another
/// Side of the tiles of luxels that share a BspRegion, and how far off its plane the positions of a planar lightmap may
/// be to be looked up there, game units.
constexpr int kTile = 4;
constexpr float kTileDepth = 0.5f;

/// Offsets in half luxels, in the order in which they are tried.
constexpr std::array<std::array<float, 2>, 8> kNudges{
    {{-1, 0}, {1, 0}, {0, 1}, {0, -1}, {-1, 1}, {1, -1}, {1, 1}, {-1, -1}}};

/// Bounds of p and its nudged positions.
Boundsf BoxAround(const Vec3f &p, const std::array<Vec3f, 2> &steps) {
    Boundsf box;
    box.Add(p);
    for (const auto &[across, down] : kNudges)
        box.Add(p + steps[0] * (across * 0.5f) + steps[1] * (down * 0.5f));
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

LuxelPositionFinder::LuxelPositionFinder(const SurfaceInputs &in, const RawLightmap &raw, const Boundsf &bounds)
    : in_(in), raw_(raw), axes_(AxesOf(raw.axis)), box_(bounds), region_(in.space.Whole().Around(bounds)),
      tilesAcross_((raw.SuperWidth() + kTile - 1) / kTile),
      tiles_(std::size_t(tilesAcross_) * std::size_t((raw.SuperHeight() + kTile - 1) / kTile)) {
    SetTileReach();
}

/// Half size of a tile's box around the tile center; around any position in the tile where the center is not known. A
/// position outside of the box is looked up in a larger region, which only takes longer.
void LuxelPositionFinder::SetTileReach() {
    tileCentersKnown_ = raw_.planar && raw_.hasVectors;
    const float luxels = tileCentersKnown_ ? kTile / 2 + 0.25f : kTile + 0.5f;
    const float size = luxels * raw_.actualSampleSize / float(raw_.super);
    tileReach_ = {size, size, size};
    if (!tileCentersKnown_)
        return;
    float depth = kTileDepth;
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (axis != axes_.along) {
            tileReach_[axis] = (std::abs(raw_.step[0][axis]) + std::abs(raw_.step[1][axis])) * luxels;
            depth += std::abs(raw_.planeNormal[axis] / raw_.planeNormal[axes_.along]) * tileReach_[axis];
        }
    if (std::isfinite(depth))
        tileReach_[axes_.along] = depth;
}

/// Bounds of the positions in the tile of luxel (x, y), whose own is p, `lift` off its plane along the projection axis.
Boundsf LuxelPositionFinder::TileBox(int x, int y, const Vec3f &p, float lift) const {
    Vec3f center = p;
    if (tileCentersKnown_) {
        constexpr float kHalf = (kTile - 1) * 0.5f;
        center = OntoPlane(raw_.origin + raw_.step[0] * (float(x / kTile * kTile) + kHalf) +
                               raw_.step[1] * (float(y / kTile * kTile) + kHalf),
                           axes_.along, raw_.planeNormal, raw_.planeDist);
        center[axes_.along] += lift;
    }
    return {center - tileReach_, center + tileReach_};
}

const LuxelPositionFinder::Tile &LuxelPositionFinder::TileOf(int x, int y, const Vec3f &p, float lift) {
    Tile &tile = tiles_[std::size_t(y / kTile) * std::size_t(tilesAcross_) + std::size_t(x / kTile)];
    if (!tile.region) {
        tile.box = TileBox(x, y, p, lift);
        tile.region.emplace(region_.Around(tile.box));
    }
    return tile;
}

int LuxelPositionFinder::ClusterAt(const Vec3f &p, const Tile &tile, VisibleClusters &filter) const {
    if (!box_.Contains(p))
        return filter.ClusterIfAllowed(in_.space.ClusterAt(p, kBrushEpsilon));
    const BspRegion &region = tile.box.Contains(p) ? *tile.region : region_;
    return filter.ClusterIfAllowed(region.ClusterAt(p, kBrushEpsilon));
}

bool LuxelPositionFinder::AnyOpen(const Boundsf &box, const Tile &tile) const {
    const Vec3f margin{kAtLeaf, kAtLeaf, kAtLeaf}, from = box.mins - margin, to = box.maxs + margin;
    const auto holds = [&](const Boundsf &part) { return part.Contains(from) && part.Contains(to); };
    const BspRegion whole = in_.space.Whole();
    const BspRegion &region = holds(tile.box) ? *tile.region : holds(box_) ? region_ : whole;
    return region.AnyOpen(from, to, kBrushEpsilon);
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

std::array<Vec3f, 2> LuxelPositionFinder::NudgeSteps(const LuxelPlane &plane) const {
    if (raw_.planar)
        return raw_.step;
    auto steps = Tangents(plane.normal);
    for (Vec3f &step : steps)
        step *= raw_.actualSampleSize / float(raw_.super);
    return steps;
}

LuxelPosition LuxelPositionFinder::Centered(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane,
                                            float offset, VisibleClusters &filter, PositionCounts &counts) {
    Vec3f p = OnSurface(x, y, sample, plane);
    const float lift = Lift(plane, offset);
    if (raw_.hasVectors)
        p[axes_.along] += lift;
    else
        p += plane.normal * offset;
    const int cluster = ClusterAt(p + ClusterLookupOffset(plane), TileOf(x, y, p, lift), filter);
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
    const Tile &tile = TileOf(x, y, center, Lift(plane, offset));
    const Vec3f lookupOffset = ClusterLookupOffset(plane);
    const auto steps = NudgeSteps(plane);
    Boundsf box = BoxAround(center + lookupOffset, steps);
    if (allowFallback)
        box.Add(FallbackBounds(x, y, sample, plane, offset));
    if (in_.lightmap.dark || !AnyOpen(box, tile)) {
        ++counts.failed;
        return {};
    }
    for (std::size_t i = 0; i < kNudges.size(); ++i) {
        const Vec3f nudged = center + steps[0] * (kNudges[i][0] * 0.5f) + steps[1] * (kNudges[i][1] * 0.5f);
        if (const int cluster = ClusterAt(nudged + lookupOffset, tile, filter); cluster >= 0) {
            ++counts.nudges[i + 1];
            return {nudged, cluster};
        }
    }
    LuxelPosition position;
    if (allowFallback) {
        position.xyz = Fallback(x, y, sample, plane, offset);
        position.cluster = ClusterAt(position.xyz, tile, filter);
    }
    ++(position.Occluded() ? counts.failed : counts.atVertex);
    return position;
}

} // namespace q3
