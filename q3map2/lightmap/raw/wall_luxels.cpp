// GPL-2.0-or-later. Luxels in walls that the texture filter shows on both sides.
#include "q3map2/lightmap/raw/wall_luxels.h"

#include "q3map2/light/scene/light_way.h"
#include "q3map2/lightmap/raw/luxel_axes.h"
#include "q3map2/lightmap/raw/luxel_masks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace q3 {

namespace {

/// Neighbors of a luxel in a ring, so that each touches the next.
constexpr std::array<std::array<int, 2>, 8> kRing{
    {{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}}};
constexpr std::size_t kSelf = kRing.size();
/// A side counts if the space this far from its luxel towards the luxel in the wall is open: there bilinear filtering
/// gives the latter this weight. Luxels.
constexpr float kLeastWeight = 1.0f / 8;
/// Positions this near to an opaque brush count as inside it. Game units.
constexpr float kSeenEpsilon = 0.125f;

/// A luxel in a wall that is shown on several sides of it.
struct WallLuxel {
    std::size_t luxel = 0;
    std::vector<std::vector<std::size_t>> sides; // luxels on each side: neighbors, or the luxel itself
};

/// Luxels that are lit at their center.
LuxelMask CenteredLuxels(const RawLightmap &raw) {
    constexpr float kSame = 1.0f / 64; // luxels
    const LuxelAxes axes = AxesOf(raw.axis);
    LuxelMask centered(raw.luxelClusters.size());
    for (int y = 0; y < raw.SuperHeight(); ++y)
        for (int x = 0; x < raw.SuperWidth(); ++x) {
            const std::size_t at = raw.SuperIndex(x, y);
            if (!raw.Mapped(at))
                continue;
            const Vec3f from = raw.positions[at] - raw.origin;
            centered[at] = std::abs(from[axes.u] / raw.step[0][axes.u] - float(x)) < kSame &&
                           std::abs(from[axes.v] / raw.step[1][axes.v] - float(y)) < kSame;
        }
    return centered;
}

/// Finds the sides around the luxels of one lightmap.
class SideFinder {
  public:
    SideFinder(const BspSpace &space, const LuxelMask &centered, const RawLightmap &raw)
        : space_(space), centered_(centered), raw_(raw) {}

    /// The sides around a luxel in a wall; none if it has fewer than two. Neighbors next to each other in the ring are
    /// on one side if the way between them is open.
    std::optional<WallLuxel> Find(int x, int y) const {
        const std::size_t self = raw_.SuperIndex(x, y);
        std::array<std::size_t, kRing.size()> around{};
        std::array<bool, kRing.size() + 1> counts{};
        for (std::size_t k = 0; k < kRing.size(); ++k) {
            const int u = x + kRing[k][0], v = y + kRing[k][1];
            if (u < 0 || v < 0 || u >= raw_.SuperWidth() || v >= raw_.SuperHeight())
                continue;
            around[k] = raw_.SuperIndex(u, v);
            counts[k] = centered_[around[k]] != 0 && IsOnSurface(raw_.positions[around[k]]);
        }
        if (!MayHaveTwoSides(counts))
            return std::nullopt;
        for (std::size_t k = 0; k < kRing.size(); ++k)
            counts[k] = counts[k] && IsOpenTowards(around[k], k);
        counts[kSelf] = raw_.Mapped(self);
        const auto position = [&](std::size_t k) -> const Vec3f & {
            return raw_.positions[k == kSelf ? self : around[k]];
        };
        std::array<std::uint8_t, kRing.size() + 1> side{};
        for (std::size_t k = 0; k <= kSelf; ++k)
            side[k] = std::uint8_t(k);
        const auto join = [&](std::size_t a, std::size_t b) {
            if (counts[a] && counts[b] && side[a] != side[b] &&
                WayBetween(space_, position(a), position(b)) == Way::Open)
                std::replace(side.begin(), side.end(), std::max(side[a], side[b]), std::min(side[a], side[b]));
        };
        for (std::size_t k = 0; k < kRing.size(); ++k)
            join(k, (k + 1) % kRing.size());
        for (std::size_t k = 0; k < kRing.size(); ++k)
            join(kSelf, k);
        return Sides(self, around, counts, side);
    }

  private:
    /// False beside an ordinary wall, which spares tests of ways: there all lit neighbors are on one side, in one arc
    /// of at most three.
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
        return space_.ClusterAt(p, kSeenEpsilon) >= 0;
    }

    static std::optional<WallLuxel> Sides(std::size_t self, const std::array<std::size_t, kRing.size()> &around,
                                          const std::array<bool, kRing.size() + 1> &counts,
                                          const std::array<std::uint8_t, kRing.size() + 1> &side) {
        WallLuxel found{self, {}};
        for (std::size_t group = 0; group <= kSelf; ++group) {
            std::vector<std::size_t> luxels;
            if (counts[kSelf] && side[kSelf] == group)
                luxels.push_back(self); // lit on this side
            else
                for (std::size_t k = 0; k < kRing.size(); ++k)
                    if (counts[k] && side[k] == group)
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
