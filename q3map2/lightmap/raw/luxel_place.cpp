// GPL-2.0-or-later. From where one luxel is lit: a place in the open near its surface.
#include "q3map2/lightmap/raw/luxel_place.h"

#include "q3map2/lightmap/raw/luxel_raster.h"

#include <cmath>

namespace q3 {

namespace {

/// Receivers so near an opaque brush are in it. Game units.
constexpr float kBrushEpsilon = 0.125f;
/// -trianglecheck: receivers closer than this to the edge are moved a unit inside. Game units.
constexpr float kEdgeMargin = 0.125f;
constexpr int kTriangleRounds = 3;
/// Luxels on a side of those that share a part of the tree, and how far from its plane a planar lightmap's receivers
/// may be for it, game units.
constexpr int kTile = 4;
constexpr float kTileDepth = 0.5f;

/// In half luxels.
constexpr std::array<std::array<float, 2>, 8> kNudges{
    {{-1, 0}, {1, 0}, {0, 1}, {0, -1}, {-1, 1}, {1, -1}, {1, 1}, {-1, -1}}};

/// Holds p and its nudges.
Boundsf BoxAround(const Vec3f &p, const std::array<Vec3f, 2> &steps) {
    Boundsf box;
    box.Add(p);
    for (const auto &[across, down] : kNudges)
        box.Add(p + steps[0] * (across * 0.5f) + steps[1] * (down * 0.5f));
    return box;
}

/// Two unit vectors across n and each other.
std::array<Vec3f, 2> Across(const Vec3f &n) {
    const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const Vec3f smallest = x <= y && x <= z ? Vec3f{1, 0, 0} : y <= z ? Vec3f{0, 1, 0} : Vec3f{0, 0, 1};
    const Vec3f right = Normalize(Cross(smallest, n));
    return {right, Cross(right, n)};
}

/// Moves p into the triangle.
Vec3f IntoTriangle(Vec3f p, const std::array<SurfaceVertex, 3> &triangle, const Vec3f &normal) {
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

int ClusterFilter::Allowed(int cluster) {
    if (cluster < 0 || known_.empty())
        return cluster;
    Known &known = known_[std::size_t(cluster)];
    if (known == Unasked) {
        known = No;
        for (const int own : clusters_)
            if (space_.Visible(own, cluster)) {
                known = Yes;
                break;
            }
    }
    return known == Yes ? cluster : kSolidCluster;
}

LuxelPlacer::LuxelPlacer(const SurfaceInputs &in, const RawLightmap &raw, const Boundsf &around)
    : in_(in), raw_(raw), axes_(AxesOf(raw.axis)), box_(around), region_(in.space.Whole().Around(around)),
      tilesAcross_((raw.SuperWidth() + kTile - 1) / kTile),
      tiles_(std::size_t(tilesAcross_) * std::size_t((raw.SuperHeight() + kTile - 1) / kTile)) {
    SetTileReach();
}

/// From the middle of a tile, or where that is not known from any of its receivers, to all receivers; those that are
/// farther off only cost time.
void LuxelPlacer::SetTileReach() {
    middles_ = raw_.planar && raw_.hasVectors;
    const float luxels = middles_ ? kTile / 2 + 0.25f : kTile + 0.5f;
    const float size = luxels * raw_.actualSampleSize / float(raw_.super);
    tileReach_ = {size, size, size};
    if (!middles_)
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

/// A box about the receivers of luxel (x, y) and its neighbours, one of whose receivers is p, lifted by `lift` along
/// the projection.
Boundsf LuxelPlacer::TileBox(int x, int y, const Vec3f &p, float lift) const {
    Vec3f middle = p;
    if (middles_) {
        constexpr float kHalf = (kTile - 1) * 0.5f;
        middle = OntoPlane(raw_.origin + raw_.step[0] * (float(x / kTile * kTile) + kHalf) +
                               raw_.step[1] * (float(y / kTile * kTile) + kHalf),
                           axes_.along, raw_.planeNormal, raw_.planeDist);
        middle[axes_.along] += lift;
    }
    return {middle - tileReach_, middle + tileReach_};
}

const LuxelPlacer::Tile &LuxelPlacer::TileOf(int x, int y, const Vec3f &p, float lift) {
    Tile &tile = tiles_[std::size_t(y / kTile) * std::size_t(tilesAcross_) + std::size_t(x / kTile)];
    if (!tile.region) {
        tile.box = TileBox(x, y, p, lift);
        tile.region.emplace(region_.Around(tile.box));
    }
    return tile;
}

int LuxelPlacer::ClusterAt(const Vec3f &p, const Tile &tile, ClusterFilter &filter) const {
    if (!box_.Contains(p))
        return filter.Allowed(in_.space.ClusterAt(p, kBrushEpsilon));
    const BspRegion &region = tile.box.Contains(p) ? *tile.region : region_;
    return filter.Allowed(region.ClusterAt(p, kBrushEpsilon));
}

bool LuxelPlacer::AnyOpen(const Boundsf &box, const Tile &tile) const {
    const Vec3f margin{kAtLeaf, kAtLeaf, kAtLeaf}, from = box.mins - margin, to = box.maxs + margin;
    const auto holds = [&](const Boundsf &part) { return part.Contains(from) && part.Contains(to); };
    const BspRegion whole = in_.space.Whole();
    const BspRegion &region = holds(tile.box) ? *tile.region : holds(box_) ? region_ : whole;
    return region.AnyOpen(from, to, kBrushEpsilon);
}

Vec3f LuxelPlacer::OnPlane(float x, float y, const LuxelPlane &plane) const {
    return OntoPlane(raw_.origin + raw_.step[0] * x + raw_.step[1] * y, axes_.along, plane.normal, plane.dist);
}

Vec3f LuxelPlacer::OnSurface(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane) const {
    Vec3f p = raw_.hasVectors ? OnPlane(float(x), float(y), plane) : sample->xyz;
    if (in_.lightmap.triangleCheck && plane.triangle)
        p = IntoTriangle(p, *plane.triangle, plane.normal);
    return p;
}

std::array<Vec3f, 2> LuxelPlacer::NudgeSteps(const LuxelPlane &plane) const {
    if (raw_.planar)
        return raw_.step;
    auto steps = Across(plane.normal);
    for (Vec3f &step : steps)
        step *= raw_.actualSampleSize / float(raw_.super);
    return steps;
}

LuxelPlacer::Place LuxelPlacer::Middle(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane, float offset,
                                       ClusterFilter &filter, PlacementCounts &counts) {
    Vec3f p = OnSurface(x, y, sample, plane);
    const float lift = Lift(plane, offset);
    if (raw_.hasVectors)
        p[axes_.along] += lift;
    else
        p += plane.normal * offset;
    const int cluster = ClusterAt(p + Probe(plane), TileOf(x, y, p, lift), filter);
    counts.nudges[0] += cluster >= 0;
    return {p, cluster};
}

Vec3f LuxelPlacer::Above(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane, float offset) const {
    if (sample)
        return sample->xyz + sample->normal * offset;
    const auto &[a, b, c] = *plane.triangle;
    const auto [across, down] = MiddleIn({a.luxel, b.luxel, c.luxel}, x, y);
    return OnPlane(across - 0.5f, down - 0.5f, plane) + a.normal * offset;
}

Boundsf LuxelPlacer::AboveBox(int x, int y, const SurfaceVertex *sample, const LuxelPlane &plane, float offset) const {
    Boundsf box;
    if (sample)
        box.Add(Above(x, y, sample, plane, offset));
    else
        for (const float across : {-0.5f, 0.5f})
            for (const float down : {-0.5f, 0.5f})
                box.Add(OnPlane(float(x) + across, float(y) + down, plane) + (*plane.triangle)[0].normal * offset);
    return box;
}

LuxelPlacer::Place LuxelPlacer::Beside(int x, int y, const Vec3f &middle, const SurfaceVertex *sample,
                                       const LuxelPlane &plane, float offset, bool lastTry, ClusterFilter &filter,
                                       PlacementCounts &counts) {
    const Tile &tile = TileOf(x, y, middle, Lift(plane, offset));
    const Vec3f probe = Probe(plane);
    const auto steps = NudgeSteps(plane);
    Boundsf box = BoxAround(middle + probe, steps);
    if (lastTry)
        box.Add(AboveBox(x, y, sample, plane, offset));
    if (in_.lightmap.dark || !AnyOpen(box, tile)) {
        ++counts.failed;
        return {};
    }
    for (std::size_t i = 0; i < kNudges.size(); ++i) {
        const Vec3f nudged = middle + steps[0] * (kNudges[i][0] * 0.5f) + steps[1] * (kNudges[i][1] * 0.5f);
        if (const int cluster = ClusterAt(nudged + probe, tile, filter); cluster >= 0) {
            ++counts.nudges[i + 1];
            return {nudged, cluster};
        }
    }
    Place place;
    if (lastTry) {
        place.xyz = Above(x, y, sample, plane, offset);
        place.cluster = ClusterAt(place.xyz, tile, filter);
    }
    ++(place.Closed() ? counts.failed : counts.atVertex);
    return place;
}

} // namespace q3
