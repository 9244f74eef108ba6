// GPL-2.0-or-later. The position at which a luxel is lit: near its surface, clear of solids, and not in walls.
#include "q3map2/lightmap/raw/luxel_position.h"

#include "q3map2/light/scene/open_parts.h"
#include "q3map2/lightmap/raw/lightmaps.h"
#include "q3map2/lightmap/raw/luxel_raster.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace q3 {

// ---- The position at which a luxel is lit: near its surface, clear of solids ----

namespace {

/// Positions this near to an opaque brush count as inside it. Game units.
constexpr float kBrushEpsilon = 0.125f;
/// -trianglecheck: positions closer than kEdgeMargin to an edge are moved to kEdgeInset inside of it. Game units.
constexpr float kEdgeMargin = 0.125f, kEdgeInset = 1;
/// Triangles whose doubled area in the lightmap is smaller give no luxel steps. Square luxels.
constexpr float kLeastTwiceArea = 1e-4f;
/// Spacing of luxels on a curve, as a fraction of the nominal luxel size, below which a nudge of half a luxel leaves
/// the curve.
constexpr float kDenseSpacing = 0.5f;
/// Distance from an edge of a triangle, in game units, at which a point over it is certainly not on the face of the
/// wall that the edge may run along.
constexpr float kAnchorInset = 0.25f;
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
    // Solves p = pu U + pv V and q = qu U + qv V for the steps U across and V down.
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
        p = MovedIntoTriangle(p, *plane.triangle, plane.normal, kEdgeMargin, kEdgeInset);
    return p;
}

std::array<LuxelSteps, 2> LuxelPositionFinder::StepsOfNudges(const LuxelPlane &plane) const {
    if (raw_.planar)
        return {raw_.step};
    const float size = raw_.actualSampleSize / float(raw_.super);
    auto whole = Tangents(plane.normal);
    for (Vec3f &step : whole)
        step *= size;
    LuxelSteps luxelSteps = plane.steps;
    const float spacing = std::min(Length(luxelSteps[0]), Length(luxelSteps[1]));
    if (spacing == 0 || spacing >= kDenseSpacing * size)
        return {whole};
    for (Vec3f &step : luxelSteps)
        if (const float length = Length(step); length > size)
            step *= size / length;
    return {luxelSteps, whole};
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
    return MovedIntoTriangle(p, triangle, luxel.plane.normal, kAnchorInset, kAnchorInset);
}

bool LuxelPositionFinder::IsOnSideOfSurface(const Request &luxel, const Vec3f &p) const {
    if (luxel.IsBeside())
        return std::any_of(luxel.neighbors.begin(), luxel.neighbors.end(),
                           [&](const Vec3f &from) { return StateOfSegment(in_.space, from, p) == SegmentState::Open; });
    return StateOfSegment(in_.space, Anchor(luxel), p) != SegmentState::Blocked;
}

bool LuxelPositionFinder::IsOverTriangle(const LuxelPlane &plane, const Vec3f &p) const {
    return raw_.planar || !raw_.hasVectors || !plane.triangle ||
           Contains(LuxelsOf(*plane.triangle), LuxelCoordinates(p));
}

LuxelPosition LuxelPositionFinder::Centered(const Request &luxel, VisibleClusters &filter, PositionCounts &counts) {
    const Vec3f p = Lifted(OnSurface(luxel), luxel.plane, luxel.offset);
    int cluster = ClusterAt(p + ClusterLookupOffset(luxel.plane), filter);
    if (cluster >= 0 && !CoversCenter(luxel) && !IsOnSideOfSurface(luxel, p))
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
            if (cluster >= 0 && IsOverTriangle(luxel.plane, nudged) && IsOnSideOfSurface(luxel, nudged)) {
                ++counts.nudges[i + 1];
                return {nudged, cluster};
            }
        }
    LuxelPosition position;
    if (!luxel.IsBeside()) {
        position.xyz = Fallback(luxel);
        position.cluster = ClusterAt(position.xyz, filter);
    }
    ++(position.Occluded() ? counts.failed : counts.atSample);
    return position;
}

// ---- Luxels in walls that the texture filter shows on both sides ----

namespace {

/// Neighbors of a luxel in a ring, so that each touches the next.
constexpr std::array<std::array<int, 2>, 8> kRing{
    {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}}};
constexpr std::size_t kSelf = kRing.size();
/// A side counts if the space this far from its luxel towards the luxel in the wall is open: there bilinear filtering
/// gives the latter this weight. Luxels.
constexpr float kLeastWeight = 1.0f / 8;

/// A luxel in a wall that is shown on several sides of it.
struct WallLuxel {
    std::size_t luxel = 0;
    std::vector<std::vector<std::size_t>> sides; // luxels on each side: neighbors, or the luxel itself
};

/// Luxels that are lit at their center.
LuxelMask CenteredLuxels(const RawLightmap &raw) {
    constexpr float kRounding = 1.0f / 64; // luxels
    const LuxelAxes axes = AxesOf(raw.axis);
    LuxelMask centered(raw.luxelClusters.size());
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x) {
            const std::size_t at = raw.SuperIndex(x, y);
            if (!raw.Mapped(at))
                continue;
            const Vec3f from = raw.positions[at] - raw.origin;
            centered[at] = std::abs(from[axes.u] / raw.step[0][axes.u] - float(x)) < kRounding &&
                           std::abs(from[axes.v] / raw.step[1][axes.v] - float(y)) < kRounding;
        }
    return centered;
}

/// Finds the sides around the luxels of one lightmap.
class SideFinder {
  public:
    SideFinder(const BspSpace &space, const LuxelMask &centered, const RawLightmap &raw)
        : space_(space), centered_(centered), raw_(raw) {}

    /// The sides around a luxel in a wall; none if it has fewer than two. Neighbors next to each other in the ring are
    /// on one side if the segment between them is open.
    std::optional<WallLuxel> Find(int x, int y) const {
        const std::size_t self = raw_.SuperIndex(x, y);
        std::array<std::size_t, kRing.size()> around{};
        std::array<bool, kRing.size() + 1> counted{}; // whether the luxel counts in its side; the last: luxel (x, y)
        for (std::size_t k = 0; k < kRing.size(); ++k) {
            const int u = x + kRing[k][0], v = y + kRing[k][1];
            if (u < 0 || v < 0 || u >= raw_.SuperWidth() || v >= raw_.SuperHeight())
                continue;
            around[k] = raw_.SuperIndex(u, v);
            counted[k] = centered_[around[k]] != 0 && IsOnSurface(raw_.positions[around[k]]);
        }
        if (!MayHaveTwoSides(counted))
            return std::nullopt;
        for (std::size_t k = 0; k < kRing.size(); ++k)
            counted[k] = counted[k] && IsOpenTowards(around[k], k);
        counted[kSelf] = raw_.Mapped(self);
        const auto position = [&](std::size_t k) -> const Vec3f & {
            return raw_.positions[k == kSelf ? self : around[k]];
        };
        std::array<std::uint8_t, kRing.size() + 1> side{}; // the first luxel of the side, as an index in the ring
        for (std::size_t k = 0; k <= kSelf; ++k)
            side[k] = std::uint8_t(k);
        const auto join = [&](std::size_t a, std::size_t b) {
            if (counted[a] && counted[b] && side[a] != side[b] &&
                StateOfSegment(space_, position(a), position(b)) == SegmentState::Open)
                std::replace(side.begin(), side.end(), std::max(side[a], side[b]), std::min(side[a], side[b]));
        };
        for (std::size_t k = 0; k < kRing.size(); ++k)
            join(k, (k + 1) % kRing.size());
        for (std::size_t k = 0; k < kRing.size(); ++k)
            join(kSelf, k);
        return Sides(self, around, counted, side);
    }

  private:
    /// False beside an ordinary wall, which spares tests of segments: there all lit neighbors are on one side, in one
    /// arc of at most three.
    static bool MayHaveTwoSides(const std::array<bool, kRing.size() + 1> &lit) {
        constexpr int kOneSide = 3;
        int count = 0, arcs = 0;
        for (std::size_t k = 0; k < kRing.size(); ++k) {
            count += lit[k];
            arcs += lit[k] && !lit[(k + 1) % kRing.size()];
        }
        return count > kOneSide || arcs > 1;
    }

    /// Whether p is over the bounds of the surfaces: light of luxels in the ring beside them says nothing about what is
    /// shown.
    bool IsOnSurface(const Vec3f &p) const {
        constexpr float kSlack = 0.01f; // game units
        const LuxelAxes axes = AxesOf(raw_.axis);
        for (const std::size_t axis : {axes.u, axes.v})
            if (p[axis] < raw_.bounds.mins[axis] - kSlack || p[axis] > raw_.bounds.maxs[axis] + kSlack)
                return false;
        return true;
    }

    /// Whether the space from neighbor k of the ring towards the luxel in the wall is open: kLeastWeight.
    bool IsOpenTowards(std::size_t neighbor, std::size_t k) const {
        const Vec3f back =
            raw_.step[0] * (float(-kRing[k][0]) * kLeastWeight) + raw_.step[1] * (float(-kRing[k][1]) * kLeastWeight);
        const Vec3f p = raw_.positions[neighbor] + back;
        return space_.ClusterAt(p, kBrushEpsilon) >= 0;
    }

    static std::optional<WallLuxel> Sides(std::size_t self, const std::array<std::size_t, kRing.size()> &around,
                                          const std::array<bool, kRing.size() + 1> &counted,
                                          const std::array<std::uint8_t, kRing.size() + 1> &side) {
        WallLuxel found{self, {}};
        for (std::size_t group = 0; group <= kSelf; ++group) {
            std::vector<std::size_t> luxels;
            if (counted[kSelf] && side[kSelf] == group)
                luxels.push_back(self); // lit on this side
            else
                for (std::size_t k = 0; k < kRing.size(); ++k)
                    if (counted[k] && side[k] == group)
                        luxels.push_back(around[k]);
            if (!luxels.empty())
                found.sides.push_back(std::move(luxels));
        }
        return found.sides.size() > 1 ? std::optional(std::move(found)) : std::nullopt;
    }

    const BspSpace &space_;
    const LuxelMask &centered_;
    const RawLightmap &raw_;
};

Vec3f MeanOf(const std::vector<Vec3f> &values, const std::vector<std::size_t> &luxels) {
    Vec3f sum;
    for (const std::size_t luxel : luxels)
        sum += values[luxel];
    return sum / float(luxels.size());
}

/// By color channel: the side with the least light.
std::array<std::size_t, 3> DarkestSides(const std::vector<Vec3f> &light, const WallLuxel &wall) {
    std::array<std::size_t, 3> darkest{};
    Vec3f least = MeanOf(light, wall.sides[0]);
    for (std::size_t s = 1; s < wall.sides.size(); ++s) {
        const Vec3f mean = MeanOf(light, wall.sides[s]);
        for (std::size_t c = 0; c < 3; ++c)
            if (mean[c] < least[c])
                least[c] = mean[c], darkest[c] = s;
    }
    return darkest;
}

std::vector<WallLuxel> FindWallLuxels(const BspSpace &space, const RawLightmap &raw) {
    const LuxelMask centered = CenteredLuxels(raw);
    const SideFinder finder(space, centered, raw);
    const LuxelMask touching = Dilate(centered, raw.SuperWidth(), raw.SuperHeight());
    std::vector<WallLuxel> walls;
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x)
            if (const std::size_t at = raw.SuperIndex(x, y);
                touching[at] != 0 && centered[at] == 0 && raw.luxelClusters[at] != kUnmapped)
                if (auto found = finder.Find(x, y))
                    walls.push_back(std::move(*found));
    return walls;
}

/// Sets the light of one style slot.
void FillSlot(const std::vector<WallLuxel> &walls, std::size_t slot, RawLightmap &raw) {
    std::vector<Vec3f> &light = raw.light[slot];
    for (const WallLuxel &wall : walls) {
        const auto darkest = DarkestSides(light, wall);
        const auto fill = [&](std::vector<Vec3f> &values) {
            Vec3f value;
            for (std::size_t c = 0; c < 3; ++c)
                value[c] = MeanOf(values, wall.sides[darkest[c]])[c];
            values[wall.luxel] = value;
        };
        for (std::vector<Vec3f> &channel : raw.directional[slot])
            fill(channel);
        if (slot == 0 && !raw.directions.empty() && !raw.Mapped(wall.luxel))
            raw.directions[wall.luxel] =
                MeanOf(raw.directions, wall.sides[darkest[0]]); // the sides rarely differ by color
        fill(light);
        raw.filled[slot][wall.luxel] = 1;
    }
}

} // namespace

void FillWallLuxels(const BspSpace &space, RawLightmap &raw) {
    if (!raw.planar || !raw.hasVectors)
        return;
    const std::vector<WallLuxel> walls = FindWallLuxels(space, raw);
    for (std::size_t slot = 0; slot < kStyles; ++slot)
        if (!raw.light[slot].empty())
            FillSlot(walls, slot, raw);
    for (const WallLuxel &wall : walls)
        if (!raw.Mapped(wall.luxel))
            raw.luxelClusters[wall.luxel] = kFlooded;
}

} // namespace q3
