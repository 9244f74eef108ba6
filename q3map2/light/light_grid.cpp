// GPL-2.0-or-later. The legacy light grid.
#include "q3map2/light/light_grid.h"

#include "q3map2/light/grid_bricks.h"
#include "q3map2/light/light_tone.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr std::int64_t kMaxPoints = 0x100000;
constexpr float kMinCell = 8;
constexpr float kNudgeMargin = -0.125f;
constexpr float kSolidMargin = 0.125f; ///< rays start this clear of solids. Game units
constexpr int kNudges = 16;            ///< steps from the point to half a cell away
constexpr std::size_t kMaxRecords = 32767;
/// Lights fainter than this in all of a brick are represented by a few of them. Byte scale.
constexpr float kFaint = 1.0f / 16;

/// Blocks that are lit together, so that their rays fill packets; more would keep more records at once.
constexpr std::size_t kTogether = 4;

/// What lights give to the points of a few blocks. How much of it is ambient hangs on the main direction of a point,
/// which is known at the end, so all of it is recorded.
class GridRecords {
  public:
    explicit GridRecords(std::size_t points) : points_(points) { records_.reserve(kUsual * points); }
    /// Light from a direction, and ambient light of its own; `turn` turns the main direction.
    void Add(std::size_t point, const Vec3f &direction, const Vec3f &color, const Vec3f &ownAmbient,
             const Vec3d &turn) {
        records_.push_back({std::uint32_t(point), direction, color, ownAmbient});
        points_[point].turns += turn;
        ++points_[point].records;
    }
    std::size_t Count(std::size_t point) const { return points_[point].records; }

    /// Light of a point in its two parts.
    struct Parts {
        Vec3f main, ambient, directed;
    };
    std::vector<Parts> All(const LightOptions &options, const Vec3f &ambient) const;

  private:
    static constexpr std::size_t kUsual = 16; ///< lights that reach a point of most maps
    struct Record {
        std::uint32_t point;
        Vec3f direction, color, ownAmbient;
    };
    struct Point {
        Vec3d turns;
        std::size_t records = 0;
    };
    std::vector<Point> points_;
    std::vector<Record> records_;
};

std::vector<GridRecords::Parts> GridRecords::All(const LightOptions &options, const Vec3f &ambient) const {
    std::vector<Parts> all;
    all.reserve(points_.size());
    for (const Point &point : points_)
        all.push_back({Vec3f(Normalize(point.turns)), ambient, {}});
    for (const Record &record : records_) {
        Parts &light = all[record.point];
        const float k = std::max(0.0f, options.gridAmbientDirectionality +
                                           Dot(record.direction, light.main) *
                                               (options.gridDirectionality - options.gridAmbientDirectionality));
        light.directed += record.color * k;
        light.ambient += record.color * (0.25f * (1 - k)) + record.ownAmbient;
    }
    return all;
}

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

void AddFloodlight(const GridInputs &in, const Vec3f &position, std::size_t point, GridRecords &records,
                   RayCounts &counts) {
    for (const float up : {1.0f, -1.0f}) {
        const float share = FloodShare(in.scene, position, up, in.world.floodDistance, in.options.lowQuality, counts);
        const Vec3f flood = in.world.floodColor * (in.world.floodIntensity * share);
        records.Add(point, {0, 0, 1}, flood * 0.75f, flood * 0.25f, Vec3d{0, 0, double(Length(flood * 0.75f))});
    }
}

/// Every ray is a light of its own.
void AddIndirect(const GridInputs &in, const Vec3f &position, std::uint32_t index, std::size_t point,
                 GridRecords &records, RayCounts &counts) {
    std::vector<IndirectRay> rays;
    in.indirect->Gather(position, index, rays);
    counts.rays += rays.size();
    for (const IndirectRay &ray : rays) {
        if (ray.color == Vec3f{})
            continue;
        const Vec3f color = ray.color * (IndirectLight::kFacing / float(rays.size()));
        records.Add(point, ray.direction, color, {}, Vec3d(ray.direction) * double(Length(color)));
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

bspGridPoint_t StorePoint(const GridInputs &in, const GridRecords::Parts &light) {
    const LightOptions &o = in.options;
    bspGridPoint_t stored;
    stored.ambient = ColorToBytes(Max(light.ambient, in.world.minGrid), o.gridScale * o.gridAmbientScale, 1, o.tone);
    stored.directed = ColorToBytes(light.directed, o.gridScale, 1, o.tone);
    constexpr std::array<std::uint8_t, 3> kBlack{};
    if (stored.ambient == kBlack && stored.directed != kBlack)
        stored.ambient = {1, 1, 1};
    stored.latLong = DirectionBytes(light.main);
    return stored;
}

/// Points of a few blocks being lit.
class GridBlocks {
  public:
    GridBlocks(const GridInputs &in, std::span<LightPlaces> blocks)
        : in_(in), blocks_(blocks), records_(blocks.size() * kPacketSize), arrivals_(blocks.size()),
          sums_(in.options.cheapGrid ? blocks.size() * kPacketSize : 0) {}
    void Trace(const ContributionSettings &settings, std::span<const BrickLight> lights, GridStats &work) {
        for (const BrickLight &one : lights) {
            LightContributionToPoint(*one.light, one.weight, settings, in_.scene, blocks_, arrivals_, work.counts);
            for (std::size_t block = 0; block < blocks_.size(); ++block)
                AddArrivals(*one.light, block);
        }
        for (std::size_t block = 0; block < blocks_.size(); ++block)
            AddOthers(block, work);
    }
    void Store(std::span<bspGridPoint_t> grid) const {
        const auto lights = records_.All(in_.options, in_.world.ambient);
        for (std::size_t block = 0; block < blocks_.size(); ++block)
            for (std::size_t i = 0; i < blocks_[block].count; ++i)
                grid[blocks_[block].index[i]] = StorePoint(in_, lights[block * kPacketSize + i]);
    }

  private:
    /// What one light gives to the points of a block.
    void AddArrivals(const Light &light, std::size_t block);
    void AddOthers(std::size_t block, GridStats &work);

    const GridInputs &in_;
    std::span<LightPlaces> blocks_;
    GridRecords records_;
    std::vector<Arrivals> arrivals_;
    std::vector<Vec3f> sums_; ///< of all styles; with -cheapgrid, for which white is enough
};

void GridBlocks::AddArrivals(const Light &light, std::size_t block) {
    const Arrivals &arrivals = arrivals_[block];
    LightPlaces &places = blocks_[block];
    for (unsigned lanes = arrivals.live.Bits(); lanes != 0; lanes &= lanes - 1) {
        const auto i = std::size_t(std::countr_zero(lanes));
        const std::size_t point = block * kPacketSize + i;
        Vec3f color = light.color * (light.negative ? -arrivals.add[i] : arrivals.add[i]);
        if (arrivals.tinted)
            color = color * arrivals.tint[i];
        const Vec3f direction = arrivals.direction[i];
        // Light of other styles turns the direction, but this format has no place for its colour.
        records_.Add(point, direction, light.style == 0 ? color : Vec3f{}, {},
                     Vec3d(direction) * double(Length(color)));
        bool white = false;
        if (in_.options.cheapGrid) {
            const Vec3f sum = sums_[point] += color;
            white = sum.x >= 255 && sum.y >= 255 && sum.z >= 255;
        }
        places.wanted.Set(i, !white && records_.Count(point) < kMaxRecords);
    }
}

void GridBlocks::AddOthers(std::size_t block, GridStats &work) {
    const LightPlaces &places = blocks_[block];
    for (std::size_t i = 0; i < places.count; ++i) {
        const std::size_t point = block * kPacketSize + i;
        if (in_.options.floodlight || in_.world.hasFloodlight)
            AddFloodlight(in_, places.position[i], point, records_, work.counts);
        if (in_.indirect)
            AddIndirect(in_, places.rayOrigin[i], places.index[i], point, records_, work.counts);
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
        for (std::size_t first = 0; first < blocks.size(); first += kTogether) {
            GridBlocks together(in, std::span(blocks).subspan(first, std::min(kTogether, blocks.size() - first)));
            together.Trace(pass, candidates.List(), work);
            together.Store(grid);
        }
    });
    return grid;
}

} // namespace q3
