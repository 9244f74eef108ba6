// GPL-2.0-or-later. Where lightmaps touch: luxels across the joint.
#include "q3map2/lightmap/bounce/lightmap_seams.h"

#include "q3map2/light/batch/ray_batcher.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace q3 {

namespace {

/// Luxels farther apart are no neighbours, whatever their size. Game units.
constexpr float kFarthest = 40;
/// Sight is tested from this far over the surface: over the edge between a floor and a ramp. Game units.
constexpr float kLift = 4;
/// Planes of neighbours are at most so far apart: luxels, and game units more.
constexpr float kAside = 0.5f, kAsideUnits = 2;

bool Whole(const RawLightmap &raw, int x, int y, int reach) {
    if (x < reach || y < reach || x + reach >= raw.SuperWidth() || y + reach >= raw.SuperHeight())
        return false;
    for (int row = y - reach; row <= y + reach; ++row)
        for (std::size_t i = raw.SuperIndex(x - reach, row); i <= raw.SuperIndex(x + reach, row); ++i)
            if (!raw.Mapped(i))
                return false;
    return true;
}

/// Finer luxels take more neighbours, as in their own lightmap.
int WindowOf(const RawLightmap &raw, int reach) {
    return reach * std::min(raw.super, 2);
}

/// World steps from a luxel to the next ones.
std::array<Vec3f, 2> StepsAt(const RawLightmap &raw, int x, int y) {
    if (raw.hasVectors)
        return raw.step;
    const Vec3f place = raw.positions[raw.SuperIndex(x, y)];
    const auto step = [&](int sx, int sy) {
        for (const int side : {1, -1}) {
            const int ox = x + side * sx, oy = y + side * sy;
            if (ox >= 0 && oy >= 0 && ox < raw.SuperWidth() && oy < raw.SuperHeight() &&
                raw.Mapped(raw.SuperIndex(ox, oy)))
                return (raw.positions[raw.SuperIndex(ox, oy)] - place) * float(side);
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

/// Rim luxels by place.
struct LightmapSeams::Finder {
    const SurfaceInputs &in;
    const SurfaceLight &surfaces;
    const std::vector<Rim> &rims;
    int reach;
    float alike;
    std::unordered_map<Cell, std::vector<std::uint32_t>, CellHash> cells = {};

    static Cell CellOf(const Vec3f &p) {
        const auto number = [](float v) { return std::int32_t(std::floor(v / (2 * kFarthest))); };
        return {number(p.x), number(p.y), number(p.z)};
    }
    const Vec3f &Place(const Rim &rim) const { return surfaces.lightmaps[rim.lightmap].positions[rim.luxel]; }
    void Find(std::size_t rim, std::vector<Neighbour> &found) const;
    void DropHidden(const Rim &rim, std::vector<Neighbour> &found) const;
};

void LightmapSeams::Finder::Find(std::size_t number, std::vector<Neighbour> &found) const {
    const Rim &rim = rims[number];
    const RawLightmap &raw = surfaces.lightmaps[rim.lightmap];
    const auto width = std::uint32_t(raw.SuperWidth());
    const Vec3f place = Place(rim), normal = raw.normals[rim.luxel];
    const auto steps = StepsAt(raw, int(rim.luxel % width), int(rim.luxel / width));
    const float xx = Dot(steps[0], steps[0]), xy = Dot(steps[0], steps[1]), yy = Dot(steps[1], steps[1]);
    const float det = xx * yy - xy * xy;
    if (!(det > 0))
        return;
    const float aside = kAside * std::sqrt(std::max(xx, yy)) + kAsideUnits,
                farthest = float(WindowOf(raw, reach)) + 0.5f;
    const Vec3f half{kFarthest, kFarthest, kFarthest};
    const Cell low = CellOf(place - half), high = CellOf(place + half);
    for (std::int32_t x = low[0]; x <= high[0]; ++x)
        for (std::int32_t y = low[1]; y <= high[1]; ++y)
            for (std::int32_t z = low[2]; z <= high[2]; ++z) {
                const auto cell = cells.find({x, y, z});
                if (cell == cells.end())
                    continue;
                for (const std::uint32_t other : cell->second) {
                    const Rim &to = rims[other];
                    const Vec3f way = Place(to) - place;
                    if (to.lightmap == rim.lightmap || Dot(way, way) > kFarthest * kFarthest ||
                        std::abs(Dot(way, normal)) > aside ||
                        !(Dot(surfaces.lightmaps[to.lightmap].normals[to.luxel], normal) > alike))
                        continue;
                    const float u = Dot(way, steps[0]), v = Dot(way, steps[1]);
                    const float dx = (u * yy - v * xy) / det, dy = (v * xx - u * xy) / det;
                    if (std::abs(dx) <= farthest && std::abs(dy) <= farthest)
                        found.push_back({to.lightmap, to.luxel, dx, dy});
                }
            }
    DropHidden(rim, found);
}

void LightmapSeams::Finder::DropHidden(const Rim &rim, std::vector<Neighbour> &found) const {
    const auto over = [&](std::uint32_t lightmap, std::uint32_t luxel) {
        const RawLightmap &raw = surfaces.lightmaps[lightmap];
        return raw.positions[luxel] + raw.normals[luxel] * kLift;
    };
    RayCounts counts;
    std::vector<Neighbour> kept;
    auto rays = MakeRayBatcher<Neighbour>([&](RayPacket &packet, std::span<const Neighbour> neighbours) {
        in.scene.TraceSurfaceToLight(packet, 1, counts);
        for (std::size_t i = 0; i < neighbours.size(); ++i)
            if (packet.live[i] != 0)
                kept.push_back(neighbours[i]);
    });
    for (const Neighbour &neighbour : found)
        rays.Aim(neighbour, over(rim.lightmap, rim.luxel), over(neighbour.lightmap, neighbour.luxel));
    rays.Flush();
    found = std::move(kept);
}

LightmapSeams::LightmapSeams(const SurfaceInputs &in, const SurfaceLight &surfaces, int reach, float alike) {
    for (std::size_t i = 0; i < surfaces.lightmaps.size(); ++i) {
        const RawLightmap &raw = surfaces.lightmaps[i];
        firstOf_.push_back(rims_.size());
        for (int y = 0; y < raw.SuperHeight(); ++y)
            for (int x = 0; x < raw.SuperWidth(); ++x)
                if (const std::size_t luxel = raw.SuperIndex(x, y);
                    raw.Mapped(luxel) && !Whole(raw, x, y, WindowOf(raw, reach)))
                    rims_.push_back({std::uint32_t(i), std::uint32_t(luxel), 0});
    }
    firstOf_.push_back(rims_.size());
    Finder finder{in, surfaces, rims_, reach, alike};
    for (std::size_t i = 0; i < rims_.size(); ++i)
        finder.cells[Finder::CellOf(finder.Place(rims_[i]))].push_back(std::uint32_t(i));
    std::vector<std::vector<Neighbour>> found(surfaces.lightmaps.size());
    in.jobs.For(std::int64_t(found.size()), [&](std::int64_t number, int) {
        const auto i = std::size_t(number);
        std::vector<Neighbour> one;
        for (std::size_t rim = firstOf_[i]; rim < firstOf_[i + 1]; ++rim) {
            one.clear();
            finder.Find(rim, one);
            rims_[rim].first = std::uint32_t(one.size());
            found[i].insert(found[i].end(), one.begin(), one.end());
        }
    });
    for (const auto &one : found)
        neighbours_.insert(neighbours_.end(), one.begin(), one.end());
    std::uint32_t next = 0;
    for (Rim &rim : rims_) {
        const std::uint32_t count = rim.first;
        rim.first = next, next += count;
    }
    rims_.push_back({~std::uint32_t(0), ~std::uint32_t(0), next});
}

std::span<const LightmapSeams::Neighbour> LightmapSeams::NeighborsAcross(std::size_t lightmap,
                                                                         std::size_t luxel) const {
    const auto begin = rims_.begin() + std::ptrdiff_t(firstOf_[lightmap]),
               end = rims_.begin() + std::ptrdiff_t(firstOf_[lightmap + 1]);
    const auto rim = std::lower_bound(begin, end, luxel, [](const Rim &one, std::size_t l) { return one.luxel < l; });
    if (rim == end || rim->luxel != luxel)
        return {};
    return std::span(neighbours_).subspan(rim->first, (rim + 1)->first - rim->first);
}

} // namespace q3
