// GPL-2.0-or-later. The legacy light grid.
#include "q3map2/light/light_grid.h"

#include "q3map2/light/grid_bricks.h"
#include "q3map2/light/light_tone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr std::int64_t kMaxPoints = 0x100000;
constexpr float kMinCell = 8;
constexpr float kNudgeMargin = -0.125f;
constexpr float kSolidMargin = 0.125f; ///< rays start this clear of solids. Game units
constexpr int kNudges = 16;            ///< steps from the point to half a cell away
constexpr float kAtLeaf = 0.2f;        ///< places farther from a leaf are never taken to be in it. Game units
constexpr std::size_t kMaxRecords = 32767;
/// Lights fainter than this in all of a brick are represented by a few of them. Byte scale.
constexpr float kFaint = 1.0f / 16;

/// What one light gave to a point.
struct GridRecord {
    Vec3f direction, color, ownAmbient;
};

struct LegacyPoint {
    Vec3f sum; // running, of all styles: for -cheapgrid
    Vec3d directionSum;
    std::vector<GridRecord> records;

    void Clear() {
        sum = {}, directionSum = {};
        records.clear();
    }
};

/// The first of PlacePoint's steps whose spots need looking at: those of smaller ones lie in a box without open leafs.
int FirstOpenStep(const BspRegion &space, const Vec3f &base, const Vec3f &half) {
    int first = 1;
    for (int last = kNudges; first < last;) {
        const int step = (first + last) / 2;
        const Vec3f reach = half * (float(step) / kNudges) + Vec3f{kAtLeaf, kAtLeaf, kAtLeaf};
        if (space.AnyOpen(base - reach, base + reach, kNudgeMargin))
            last = step;
        else
            first = step + 1;
    }
    return first;
}

/// Finds the point's place: where it is, or, when that is solid, the nearest open spot up to half a cell away. The
/// established program draws spots at random, ever farther away.
bool PlacePoint(const BspRegion &region, const Vec3f &half, Vec3f &position, int &cluster) {
    const Vec3f base = position;
    cluster = region.ClusterAt(base, 0);
    if (cluster >= 0)
        return true;
    if (!region.AnyOpen(base - half, base + half, kNudgeMargin))
        return false;
    const BspRegion space = region.Around({base - half, base + half});
    for (int step = FirstOpenStep(space, base, half); step <= kNudges; ++step)
        for (int axes = 1; axes <= 3; ++axes)
            for (int z = -1; z <= 1; ++z)
                for (int y = -1; y <= 1; ++y)
                    for (int x = -1; x <= 1; ++x) {
                        if (std::abs(x) + std::abs(y) + std::abs(z) != axes)
                            continue;
                        position = base + half * Vec3f{float(x), float(y), float(z)} * (float(step) / kNudges);
                        cluster = space.ClusterAt(position, kNudgeMargin);
                        if (cluster >= 0)
                            return true;
                    }
    return false;
}

/// Many points lie in the plane of a wall or a floor. Their rays start a hair off it, so that those into the wall are
/// blocked and the others are not.
Vec3f ClearOfSolids(const BspRegion &space, const Vec3f &p) {
    const auto clear = [&](const Vec3f &at) {
        const Vec3f margin{kSolidMargin, kSolidMargin, kSolidMargin};
        return !space.AnySolid(at - margin, at + margin);
    };
    if (clear(p))
        return p;
    for (int axes = 1; axes <= 3; ++axes)
        for (int z = -1; z <= 1; ++z)
            for (int y = -1; y <= 1; ++y)
                for (int x = -1; x <= 1; ++x) {
                    const Vec3f at = p + Vec3f{float(x), float(y), float(z)} * (2.5f * kSolidMargin);
                    if (std::abs(x) + std::abs(y) + std::abs(z) == axes && clear(at))
                        return at;
                }
    return p;
}

/// The places of a brick's points, block by block. Counts those in the open.
std::vector<LightPlaces> PlaceBrick(const BspSpace &space, const GridLayout &layout, std::span<const BrickPoint> points,
                                    GridStats &work) {
    std::vector<LightPlaces> blocks;
    const Vec3f half = Vec3f(layout.size) * 0.5f, margin = half + Vec3f{1, 1, 1};
    const BspRegion brick = RegionAround(space.Whole(), points, margin);
    for (std::size_t first = 0; first < points.size(); first += kPacketSize) {
        const auto near = points.subspan(first, std::min(kPacketSize, points.size() - first));
        const BspRegion around = RegionAround(brick, near, margin);
        for (const BrickPoint &at : near) {
            Vec3f position = at.position;
            int cluster = kSolidCluster;
            if (!PlacePoint(around, half, position, cluster))
                continue;
            AddPlace(blocks, position, ClearOfSolids(around, position), cluster, at.index);
            ++work.open;
        }
    }
    return blocks;
}

void AddFloodlight(const GridInputs &in, const Vec3f &position, LegacyPoint &point, RayCounts &counts) {
    for (const float up : {1.0f, -1.0f}) {
        const float share = FloodShare(in.scene, position, up, in.world.floodDistance, in.options.lowQuality, counts);
        const Vec3f flood = in.world.floodColor * (in.world.floodIntensity * share);
        point.records.push_back({{0, 0, 1}, flood * 0.75f, flood * 0.25f});
        point.directionSum += Vec3d{0, 0, double(Length(flood * 0.75f))};
    }
}

/// Every ray is a light of its own.
void AddIndirect(const GridInputs &in, const Vec3f &position, std::uint32_t index, LegacyPoint &point,
                 RayCounts &counts) {
    std::vector<IndirectRay> rays;
    in.indirect->Gather(position, index, rays);
    counts.rays += rays.size();
    for (const IndirectRay &ray : rays) {
        if (ray.color == Vec3f{})
            continue;
        const Vec3f color = ray.color * (IndirectLight::kFacing / float(rays.size()));
        point.records.push_back({ray.direction, color, {}});
        point.directionSum += Vec3d(ray.direction) * double(Length(color));
    }
}

std::array<std::uint8_t, 2> DirectionBytes(const Vec3f &t) {
    if (t.x == 0 && t.y == 0)
        return {std::uint8_t(t.z > 0 ? 0 : 128), 0};
    constexpr double kScale = 180 / std::numbers::pi * 255 / 360;
    const int fromZ = int(std::acos(std::clamp(double(t.z), -1.0, 1.0)) * kScale);
    const int aroundZ = int(std::atan2(double(t.y), double(t.x)) * kScale);
    return {std::uint8_t(fromZ & 255), std::uint8_t(aroundZ & 255)};
}

bspGridPoint_t StorePoint(const GridInputs &in, const LegacyPoint &point) {
    const LightOptions &o = in.options;
    const Vec3f main(Normalize(point.directionSum));
    Vec3f ambient = in.world.ambient, directed;
    for (const GridRecord &record : point.records) {
        const float k =
            std::max(0.0f, o.gridAmbientDirectionality +
                               Dot(record.direction, main) * (o.gridDirectionality - o.gridAmbientDirectionality));
        directed += record.color * k;
        ambient += record.color * (0.25f * (1 - k)) + record.ownAmbient;
    }
    ambient = Max(ambient, in.world.minGrid);
    bspGridPoint_t stored;
    stored.ambient = ColorToBytes(ambient, o.gridScale * o.gridAmbientScale, 1, o.tone);
    stored.directed = ColorToBytes(directed, o.gridScale, 1, o.tone);
    constexpr std::array<std::uint8_t, 3> kBlack{};
    if (stored.ambient == kBlack && stored.directed != kBlack)
        stored.ambient = {1, 1, 1};
    stored.latLong = DirectionBytes(main);
    return stored;
}

/// Adds what one light gives to the points of a block.
void AddArrivals(const Light &light, const GridInputs &in, const Arrivals &arrivals, LightPlaces &places,
                 std::span<LegacyPoint> points) {
    for (std::size_t i = 0; i < places.count; ++i) {
        if (arrivals.live[i] == 0)
            continue;
        Vec3f color = light.color * (light.negative ? -arrivals.add[i] : arrivals.add[i]);
        if (arrivals.tinted)
            color = color * arrivals.tint[i];
        const Vec3f direction = arrivals.direction[i];
        points[i].directionSum += Vec3d(direction) * double(Length(color));
        points[i].sum += color;
        // Light of other styles turns the direction, but this format has no place for its colour.
        points[i].records.push_back({direction, light.style == 0 ? color : Vec3f{}, {}});
        const Vec3f &sum = points[i].sum;
        const bool white = in.options.cheapGrid && sum.x >= 255 && sum.y >= 255 && sum.z >= 255;
        places.wanted.Set(i, !white && points[i].records.size() < kMaxRecords);
    }
}

/// The points of a block, lit. `points`: memory for as many.
void LightBlock(const GridInputs &in, const ContributionSettings &settings, std::span<const BrickLight> lights,
                LightPlaces &places, std::span<LegacyPoint> points, std::span<bspGridPoint_t> grid, GridStats &work) {
    for (LegacyPoint &point : points)
        point.Clear();
    Arrivals arrivals;
    for (const BrickLight &one : lights) {
        LightContributionToPoint(*one.light, one.weight, settings, in.scene, {&places, 1}, {&arrivals, 1}, work.counts);
        AddArrivals(*one.light, in, arrivals, places, points);
    }
    for (std::size_t i = 0; i < places.count; ++i) {
        if (in.options.floodlight || in.world.hasFloodlight)
            AddFloodlight(in, places.position[i], points[i], work.counts);
        if (in.indirect)
            AddIndirect(in, places.rayOrigin[i], places.index[i], points[i], work.counts);
        grid[places.index[i]] = StorePoint(in, points[i]);
    }
}

} // namespace

GridLayout SetupGrid(const Bsp &bsp, Entity &world, Log &log) {
    const Vec3f wanted = world.Vector({"gridsize"}).value_or(Vec3f{64, 64, 128});
    Float3 size{};
    for (std::size_t i = 0; i < 3; ++i)
        size[i] = std::max(kMinCell, std::floor(wanted[i]));
    const bspModel_t &model = bsp.models.front();
    GridLayout layout = LayoutGrid(model.mins, model.maxs, size);
    for (std::size_t axis = 0; layout.Count() > kMaxPoints; axis = (axis + 1) % 3) {
        size[axis] += 16;
        layout = LayoutGrid(model.mins, model.maxs, size);
    }
    if (size[0] != wanted.x || size[1] != wanted.y || size[2] != wanted.z) {
        world.Set("gridsize", fmt::format("{:.0f} {:.0f} {:.0f}", size[0], size[1], size[2]));
        log.Print("Grid size changed to {:.0f} {:.0f} {:.0f}\n", size[0], size[1], size[2]);
    }
    log.Count(layout.Count(), "grid points");
    return layout;
}

std::vector<bspGridPoint_t> TraceGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                                      GridStats &stats) {
    const ContributionSettings settings{.pass = LightPass::LegacyGrid,
                                        .sunOnly = in.options.sunOnly,
                                        .pointAreas = in.options.faster,
                                        .skip = in.options.skip};
    const LightsByCluster byCluster(lights);
    std::vector<bspGridPoint_t> grid(std::size_t(layout.Count()), bspGridPoint_t{});
    const GridBricks bricks(layout);
    stats.points = layout.Count();
    RunGridBricks(in, bricks, stats, [&](std::int64_t brick, GridStats &work) {
        std::vector<LightPlaces> blocks = PlaceBrick(in.space, layout, bricks.Points(brick), work);
        if (blocks.empty())
            return;
        StartFaint(blocks, kFaint);
        const BrickLights candidates(byCluster, BrickView(blocks), std::uint64_t(brick), kFaint, in.options.skip, work);
        ContributionSettings pass = settings;
        pass.faint = candidates.Many() ? kFaint : 0;
        std::array<LegacyPoint, kPacketSize> points;
        for (LightPlaces &places : blocks)
            LightBlock(in, pass, candidates.List(), places, points, grid, work);
    });
    return grid;
}

} // namespace q3
