// GPL-2.0-or-later. Neighboring luxels across the seams between lightmaps.
#include "q3map2/lightmap/bounce/lightmap_seams.h"

#include "q3map2/light/batch/ray_batcher.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace q3 {

namespace {

/// Greatest distance between neighbors, whatever the luxel size. Game units.
constexpr float kMaxDistance = 40;
/// Sight is tested between points this far over the surface, so that the edge of a ramp does not block it. Game units.
constexpr float kLift = 4;
/// Greatest distance of a neighbor from the plane of the luxel: kPlaneDistanceLuxels luxels + kPlaneDistance game
/// units.
constexpr float kPlaneDistanceLuxels = 0.5f, kPlaneDistance = 2;

/// Whether the whole window around the luxel is mapped: then it is not near the rim.
bool WindowIsMapped(const RawLightmap &raw, int x, int y, int reach) {
    if (x < reach || y < reach || x + reach >= raw.SuperWidth() || y + reach >= raw.SuperHeight())
        return false;
    for (int row = y - reach; row <= y + reach; ++row)
        for (std::size_t i = raw.SuperIndex(x - reach, row); i <= raw.SuperIndex(x + reach, row); ++i)
            if (!raw.Mapped(i))
                return false;
    return true;
}

/// Half width of the window in luxels of the super grid: `reach`, doubled if the lightmap is supersampled.
int WindowReach(const RawLightmap &raw, int reach) {
    return reach * std::min(raw.super, 2);
}

/// World steps from a luxel to the next column and row.
std::array<Vec3f, 2> StepsAt(const RawLightmap &raw, int x, int y) {
    if (raw.hasVectors)
        return raw.step;
    const Vec3f position = raw.positions[raw.SuperIndex(x, y)];
    const auto step = [&](int sx, int sy) {
        for (const int side : {1, -1}) {
            const int ox = x + side * sx, oy = y + side * sy;
            if (ox >= 0 && oy >= 0 && ox < raw.SuperWidth() && oy < raw.SuperHeight() &&
                raw.Mapped(raw.SuperIndex(ox, oy)))
                return (raw.positions[raw.SuperIndex(ox, oy)] - position) * float(side);
        }
        return Vec3f{};
    };
    return {step(1, 0), step(0, 1)};
}

using Cell = std::array<std::int32_t, 3>;
struct CellHash {
    std::size_t operator()(const Cell &cell) const {
        return std::size_t(cell[0]) * 73856093u ^ std::size_t(cell[1]) * 19349663u ^ std::size_t(cell[2]) * 83492791u;
    }
};

} // namespace

/// Finds neighbors by a spatial hash of all rim luxels.
struct LightmapSeams::Finder {
    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    const std::vector<RimLuxel> &rims;
    int reach;
    float minCosine;
    std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells = {};

    static Cell CellOf(const Vec3f &p) {
        const auto number = [](float v) { return std::int32_t(std::floor(v / (2 * kMaxDistance))); };
        return {number(p.x), number(p.y), number(p.z)};
    }
    const Vec3f &Position(const RimLuxel &rim) const { return surfaces.lightmaps[rim.lightmap].positions[rim.luxel]; }
    void Find(std::size_t rim, std::vector<Neighbor> &found) const;
    void DropOccluded(const RimLuxel &rim, std::vector<Neighbor> &found) const;
};

void LightmapSeams::Finder::Find(std::size_t number, std::vector<Neighbor> &found) const {
    const RimLuxel &rim = rims[number];
    const RawLightmap &raw = surfaces.lightmaps[rim.lightmap];
    const auto width = std::uint32_t(raw.SuperWidth());
    const Vec3f position = Position(rim), normal = raw.normals[rim.luxel];
    const auto steps = StepsAt(raw, int(rim.luxel % width), int(rim.luxel / width));
    const float xx = Dot(steps[0], steps[0]), xy = Dot(steps[0], steps[1]), yy = Dot(steps[1], steps[1]);
    const float det = xx * yy - xy * xy;
    if (!(det > 0))
        return;
    const float planeDistance = kPlaneDistanceLuxels * std::sqrt(std::max(xx, yy)) + kPlaneDistance,
                maxLuxels = float(WindowReach(raw, reach)) + 0.5f;
    const Vec3f half{kMaxDistance, kMaxDistance, kMaxDistance};
    const Cell low = CellOf(position - half), high = CellOf(position + half);
    for (std::int32_t x = low[0]; x <= high[0]; ++x)
        for (std::int32_t y = low[1]; y <= high[1]; ++y)
            for (std::int32_t z = low[2]; z <= high[2]; ++z) {
                const auto cell = cells.find({x, y, z});
                if (cell == cells.end())
                    continue;
                for (const std::uint32_t other : cell->second) {
                    const RimLuxel &to = rims[other];
                    const Vec3f offset = Position(to) - position;
                    if (to.lightmap == rim.lightmap || Dot(offset, offset) > kMaxDistance * kMaxDistance ||
                        std::abs(Dot(offset, normal)) > planeDistance ||
                        !(Dot(surfaces.lightmaps[to.lightmap].normals[to.luxel], normal) > minCosine))
                        continue;
                    const float u = Dot(offset, steps[0]), v = Dot(offset, steps[1]);
                    const float dx = (u * yy - v * xy) / det, dy = (v * xx - u * xy) / det;
                    if (std::abs(dx) <= maxLuxels && std::abs(dy) <= maxLuxels)
                        found.push_back({to.lightmap, to.luxel, dx, dy});
                }
            }
    DropOccluded(rim, found);
}

void LightmapSeams::Finder::DropOccluded(const RimLuxel &rim, std::vector<Neighbor> &found) const {
    const auto over = [&](std::uint32_t lightmap, std::uint32_t luxel) {
        const RawLightmap &raw = surfaces.lightmaps[lightmap];
        return raw.positions[luxel] + raw.normals[luxel] * kLift;
    };
    RayCounts counts;
    std::vector<Neighbor> kept;
    auto rays = MakeRayBatcher<Neighbor>([&](RayPacket &packet, std::span<const Neighbor> neighbors) {
        in.scene.TraceSurfaceToLight(packet, 1, counts);
        for (std::size_t i = 0; i < neighbors.size(); ++i)
            if (packet.live[i] != 0)
                kept.push_back(neighbors[i]);
    });
    for (const Neighbor &neighbor : found)
        rays.Aim(neighbor, over(rim.lightmap, rim.luxel), over(neighbor.lightmap, neighbor.luxel));
    rays.Flush();
    found = std::move(kept);
}

LightmapSeams::LightmapSeams(const SurfaceInputs &in, const SurfaceLight &surfaces, int reach, float minCosine) {
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i) {
        const RawLightmap &raw = surfaces.lightmaps[i];
        firstRim_.push_back(rims_.size());
        for (int y = 0; y < raw.SuperHeight(); ++y)
            for (int x = 0; x < raw.SuperWidth(); ++x)
                if (const std::size_t luxel = raw.SuperIndex(x, y);
                    raw.Mapped(luxel) && !WindowIsMapped(raw, x, y, WindowReach(raw, reach)))
                    rims_.push_back({std::uint32_t(i), std::uint32_t(luxel), 0});
    }
    firstRim_.push_back(rims_.size());
    Finder finder{in, surfaces, rims_, reach, minCosine};
    for (std::size_t i = 0; i < rims_.size(); ++i)
        finder.cells[Finder::CellOf(finder.Position(rims_[i]))].push_back(std::uint32_t(i));
    std::vector<std::vector<Neighbor>> found(surfaces.lightmaps.size());
    in.jobs.For(std::int64_t(found.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        std::vector<Neighbor> one;
        for (std::size_t rim = firstRim_[i]; rim < firstRim_[i + 1]; ++rim) {
            one.clear();
            finder.Find(rim, one);
            rims_[rim].first = std::uint32_t(one.size()); // the count, replaced by the index below
            found[i].insert(found[i].end(), one.begin(), one.end());
        }
    });
    for (const auto &one : found)
        neighbors_.insert(neighbors_.end(), one.begin(), one.end());
    std::uint32_t next = 0;
    for (RimLuxel &rim : rims_) {
        const std::uint32_t count = rim.first;
        rim.first = next, next += count;
    }
    rims_.push_back({~std::uint32_t(0), ~std::uint32_t(0), next});
}

std::span<const LightmapSeams::Neighbor> LightmapSeams::NeighborsAcross(std::size_t lightmap, std::size_t luxel) const {
    const auto begin = rims_.begin() + std::ptrdiff_t(firstRim_[lightmap]),
               end = rims_.begin() + std::ptrdiff_t(firstRim_[lightmap + 1]);
    const auto rim =
        std::lower_bound(begin, end, luxel, [](const RimLuxel &one, std::size_t l) { return one.luxel < l; });
    if (rim == end || rim->luxel != luxel)
        return {};
    return std::span(neighbors_).subspan(rim->first, (rim + 1)->first - rim->first);
}

} // namespace q3
