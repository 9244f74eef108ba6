// GPL-2.0-or-later. The legacy light grid.
#include "q3map2/light/grid/light_grid.h"

#include "q3map2/bspfile/light_keys.h"
#include "q3map2/light/grid/grid_bricks.h"
#include "q3map2/light/options/light_tone.h"
#include "q3map2/light/transfer/light_contribution.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

namespace q3 {

namespace {

/// By this much the cells of larger grids grow, axis by axis, until the grid is small enough. Game units.
constexpr float kCellStep = 16;
/// Nudged positions count as open up to 1/8 unit inside a brush: the epsilon of BspSpace::ClusterAt.
constexpr float kNudgeMargin = -0.125f;
constexpr float kSolidMargin = 0.125f; ///< rays start this clear of solids. Game units
/// Distance along each axis at which a position with kSolidMargin of clear space is searched. Game units.
constexpr float kClearStep = 2.5f * kSolidMargin;
constexpr int kNudges = 16; ///< steps from the point to half a cell away
/// Lights kept per point: MAX_CONTRIBUTIONS - 1 of NetRadiant's q3map2.
constexpr std::int32_t kMaxRecords = 32767;
/// Lights fainter than this in all of a brick are represented by a few of them. Byte scale.
constexpr float kFaintInBrick = 1.0f / 16;

/// Blocks that are lit together, so that their rays fill packets; more would need more memory for records.
constexpr std::size_t kBlocksTogether = 4;
/// Factor of the part of a light that is stored as ambient: the mean of max(0, n . u) over all normals n.
constexpr float kMeanCosine = 0.25f;
/// Fractions of floodlight that are stored as directed and as ambient light.
constexpr float kFloodDirected = 0.75f, kFloodAmbient = 0.25f;

/// Fraction of light that is stored as directed: max(0, offset + along * slope), where `along` is the cosine
/// between the light's direction and the main direction.
struct Directed {
    float offset, slope;
    explicit Directed(const LightOptions &options)
        : offset(options.gridAmbientDirectionality),
          slope(options.gridDirectionality - options.gridAmbientDirectionality) {}
    float Fraction(float along) const { return std::max(0.0f, offset + along * slope); }
};

/// Light that reaches the points of a few blocks. How much of it is ambient depends on a point's main direction, which
/// is known only at the end, so every contribution is recorded.
class GridRecords {
  public:
    /// Starts anew with that many blocks.
    void Reset(std::size_t blocks) {
        blocks_.assign(blocks, Block());
        lightRecords_.clear();
        lightRecords_.reserve(kUsualLights * blocks);
        pointRecords_.clear();
    }
    /// What a record counts for.
    enum class Counts { AsLight, AsDirection };
    /// Adds a light at the points of a block.
    void Add(std::size_t block, const Lanes3 &color, int style, Counts counts, const ProbeIncidentLight &incident);
    /// Adds light from a direction at one point, and ambient light; `weightedDirection` is added to the main
    /// direction's sum.
    void Add(std::size_t block, std::size_t lane, int style, const Vec3f &direction, const Vec3f &color,
             const Vec3f &ownAmbient, const Vec3d &weightedDirection) {
        pointRecords_.push_back({block, lane, style, direction, color, ownAmbient});
        Block &to = blocks_[block];
        to.directionSumX[lane] += weightedDirection.x, to.directionSumY[lane] += weightedDirection.y,
            to.directionSumZ[lane] += weightedDirection.z;
        ++to.records[lane];
    }
    std::int32_t Count(std::size_t block, std::size_t lane) const { return blocks_[block].records[lane]; }

    /// Light of a style at the points of a block, split into its ambient and directed part.
    struct Parts {
        Lanes3 ambient, directed;
    };
    /// The light of a block.
    struct BlockLight {
        Lanes3 mainDirection;
        Parts steady;                ///< style 0, with the ambient light of the world
        std::map<int, Parts> styled; ///< other styles
        Parts &OfStyle(int style);
    };
    std::vector<BlockLight> Split(const LightOptions &options, const Vec3f &ambient) const;

  private:
    static constexpr std::size_t kUsualLights = 16; ///< lights that reach a block of most maps
    struct Block {
        DoubleLanes directionSumX{}, directionSumY{}, directionSumZ{};
        IntLanes records{};
    };
    struct LightRecord {
        std::size_t block;
        int style;
        Lanes3 direction, color; ///< zero where nothing arrives
    };
    struct PointRecord {
        std::size_t block, lane;
        int style;
        Vec3f direction, color, ownAmbient;
    };
    static void AddDirection(const Lanes3 &color, const ProbeIncidentLight &incident, LightRecord &record,
                             Block &block);
    static void Divide(const LightRecord &record, const Directed &directed, const Lanes3 &mainDirection, Parts &parts);

    std::vector<Block> blocks_;
    std::vector<LightRecord> lightRecords_;
    std::vector<PointRecord> pointRecords_;
};

/// Records that no worker uses at the moment. They keep their memory: with thousands of lights it is megabytes, which
/// Windows would take back after every few blocks.
class SpareRecords {
  public:
    std::unique_ptr<GridRecords> Take() {
        const std::scoped_lock lock(mutex_);
        if (spare_.empty())
            return std::make_unique<GridRecords>();
        std::unique_ptr<GridRecords> records = std::move(spare_.back());
        spare_.pop_back();
        return records;
    }
    void Return(std::unique_ptr<GridRecords> records) {
        const std::scoped_lock lock(mutex_);
        spare_.push_back(std::move(records));
    }

  private:
    std::mutex mutex_;
    std::vector<std::unique_ptr<GridRecords>> spare_;
};

/// Color of the arriving light per lane, negative for negative lights.
void SetColors(const Light &light, const ProbeIncidentLight &incident, Lanes3 &color) {
    Vectorize([&]() Q3_INLINE {
        const Vec3f c = light.color;
        const bool negative = light.negative;
        for (const std::size_t i : kEachLane) {
            const float strength = negative ? -incident.strength[i] : incident.strength[i];
            color.x[i] = c.x * strength, color.y[i] = c.y * strength, color.z[i] = c.z * strength;
        }
        if (incident.tinted)
            for (const std::size_t i : kEachLane) {
                color.x[i] *= incident.tint.x[i];
                color.y[i] *= incident.tint.y[i];
                color.z[i] *= incident.tint.z[i];
            }
    });
}

void GridRecords::AddDirection(const Lanes3 &color, const ProbeIncidentLight &incident, LightRecord &record,
                               Block &block) {
    Vectorize([&]() Q3_INLINE {
        Lanes weight;
        for (const std::size_t i : kEachLane) {
            const bool live = incident.live[i] != 0;
            const float r = color.x[i], g = color.y[i], b = color.z[i], length = std::sqrt(r * r + g * g + b * b);
            weight[i] = live ? length : 0;
            record.color.x[i] = live ? r : 0, record.color.y[i] = live ? g : 0, record.color.z[i] = live ? b : 0;
            record.direction.x[i] = live ? incident.direction.x[i] : 0;
            record.direction.y[i] = live ? incident.direction.y[i] : 0;
            record.direction.z[i] = live ? incident.direction.z[i] : 0;
        }
        for (const std::size_t i : kEachLane) {
            block.directionSumX[i] += double(record.direction.x[i]) * double(weight[i]);
            block.directionSumY[i] += double(record.direction.y[i]) * double(weight[i]);
            block.directionSumZ[i] += double(record.direction.z[i]) * double(weight[i]);
            block.records[i] -= incident.live[i]; // -1 where light arrives
        }
    });
}

void GridRecords::Add(std::size_t block, const Lanes3 &color, int style, Counts counts,
                      const ProbeIncidentLight &incident) {
    LightRecord &record = lightRecords_.emplace_back();
    record.block = block;
    AddDirection(color, incident, record, blocks_[block]);
    record.style = style;
    if (counts == Counts::AsDirection) {
        record.style = 0;
        record.color.Fill({});
    }
}

/// Splits a record into ambient and directed light and adds both.
void GridRecords::Divide(const LightRecord &record, const Directed &directed, const Lanes3 &mainDirection,
                         Parts &parts) {
    Vectorize([&]() Q3_INLINE {
        const Directed fractions = directed; // a copy, which the outputs cannot alias
        const Lanes3 &color = record.color, &direction = record.direction;
        for (const std::size_t i : kEachLane) {
            const float along = direction.x[i] * mainDirection.x[i] + direction.y[i] * mainDirection.y[i] +
                                direction.z[i] * mainDirection.z[i];
            const float k = fractions.Fraction(along), rest = kMeanCosine * (1 - k);
            parts.directed.x[i] += color.x[i] * k;
            parts.directed.y[i] += color.y[i] * k;
            parts.directed.z[i] += color.z[i] * k;
            parts.ambient.x[i] += color.x[i] * rest;
            parts.ambient.y[i] += color.y[i] * rest;
            parts.ambient.z[i] += color.z[i] * rest;
        }
    });
}

GridRecords::Parts &GridRecords::BlockLight::OfStyle(int style) {
    if (style == 0)
        return steady;
    const auto [found, isNew] = styled.try_emplace(style);
    if (isNew) {
        found->second.ambient.Fill({});
        found->second.directed.Fill({});
    }
    return found->second;
}

std::vector<GridRecords::BlockLight> GridRecords::Split(const LightOptions &options, const Vec3f &ambient) const {
    const Directed directed(options);
    std::vector<BlockLight> lights(blocks_.size());
    for (std::size_t block = 0; block < blocks_.size(); ++block) {
        const Block &from = blocks_[block];
        BlockLight &light = lights[block];
        for (const std::size_t i : kEachLane)
            light.mainDirection.Set(
                i, Vec3f(Normalize(Vec3d{from.directionSumX[i], from.directionSumY[i], from.directionSumZ[i]})));
        light.steady.ambient.Fill(ambient);
        light.steady.directed.Fill({});
    }
    for (const LightRecord &record : lightRecords_) {
        BlockLight &light = lights[record.block];
        Divide(record, directed, light.mainDirection, light.OfStyle(record.style));
    }
    for (const PointRecord &record : pointRecords_) {
        BlockLight &light = lights[record.block];
        Parts &parts = light.OfStyle(record.style);
        const float k = directed.Fraction(Dot(record.direction, light.mainDirection[record.lane]));
        parts.directed.Set(record.lane, parts.directed[record.lane] + record.color * k);
        parts.ambient.Set(record.lane,
                          parts.ambient[record.lane] + (record.color * (kMeanCosine * (1 - k)) + record.ownAmbient));
    }
    return lights;
}

/// The first of PlacePoint's steps that can succeed: boxes of smaller steps hold no open leaf.
int FirstOpenStep(const BspSpace &space, const Vec3f &base, const Vec3f &half) {
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

/// Finds where the point is lit from: its position or, if that is solid, the nearest open one up to half a cell away.
/// NetRadiant's q3map2 draws positions at random, ever farther away.
bool PlacePoint(const BspSpace &space, const Vec3f &half, Vec3f &position, int &cluster) {
    const Vec3f base = position;
    cluster = space.ClusterAt(base, 0);
    if (cluster >= 0)
        return true;
    if (!space.AnyOpen(base - half, base + half, kNudgeMargin))
        return false;
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

/// Many points lie in the plane of a wall or floor. Their rays start slightly off that plane, so that rays into the
/// wall are blocked and all other rays are not.
Vec3f ClearOfSolids(const BspSpace &space, const Vec3f &p) {
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
                    const Vec3f at = p + Vec3f{float(x), float(y), float(z)} * kClearStep;
                    if (std::abs(x) + std::abs(y) + std::abs(z) == axes && clear(at))
                        return at;
                }
    return p;
}

/// The receivers of a brick's points, block by block. Counts them in work.open.
std::vector<ReceiverBatch> PlaceBrick(const BspSpace &space, const GridLayout &layout,
                                      std::span<const BrickPoint> points, GridStats &work) {
    std::vector<ReceiverBatch> blocks;
    blocks.reserve(BatchCount(points.size()));
    for (const BrickPoint &at : points) {
        const LegacyPlace place = PlaceLegacyPoint(space, layout, at.position);
        if (place.cluster < 0)
            continue;
        BatchWithRoom(blocks).Add(place.position, place.rayOrigin, place.cluster, at.index);
        ++work.open;
    }
    return blocks;
}

/// Adds floodlight at a point. What comes from below counts as from above too.
void AddFloodlight(const GridInputs &in, const Vec3f &position, std::size_t block, std::size_t lane,
                   GridRecords &records, RayCounts &counts) {
    for (const float up : {1.0f, -1.0f}) {
        const float fraction =
            FloodFraction(in.scene, position, up, in.world.floodDistance, in.floodDirections, counts);
        const Vec3f flood = in.world.floodColor * (in.world.floodIntensity * fraction);
        const Vec3f directed = flood * kFloodDirected;
        records.Add(block, lane, 0, {0, 0, 1}, directed, flood * kFloodAmbient, Vec3d{0, 0, double(Length(directed))});
    }
}

/// Adds bounced light of a style at a point.
void AddIndirect(const IndirectLight &indirect, int style, const ReceiverBatch &receivers, std::size_t block,
                 std::size_t lane, GridRecords &records, RayCounts &counts) {
    std::vector<IndirectRay> rays;
    indirect.Gather(receivers.rayOrigin[lane], receivers.index[lane], rays);
    counts.rays += rays.size();
    for (const IndirectRay &ray : rays)
        records.Add(block, lane, style, ray.direction, ray.light, {}, Vec3d(ray.direction) * double(Length(ray.light)));
}

/// Steps of directions in bytes: 255 are a full turn.
constexpr double kStepsPerRadian = 180 / std::numbers::pi * 255 / 360;

/// A direction as polar angle and azimuth, in steps, truncated. Straight down is half of 256.
std::array<std::uint8_t, 2> DirectionBytes(const Vec3f &t) {
    if (t.x == 0 && t.y == 0)
        return {std::uint8_t(t.z > 0 ? 0 : 128), 0};
    const int fromZ = int(std::acos(std::clamp(double(t.z), -1.0, 1.0)) * kStepsPerRadian);
    const int aroundZ = int(std::atan2(double(t.y), double(t.x)) * kStepsPerRadian);
    return {std::uint8_t(fromZ & 255), std::uint8_t(aroundZ & 255)};
}

/// Stored colors of a style at a point.
struct StoredColors {
    int style = 0;
    std::array<std::uint8_t, 3> ambient{}, directed{};
    int Sum() const {
        return std::accumulate(ambient.begin(), ambient.end(), 0) +
               std::accumulate(directed.begin(), directed.end(), 0);
    }
};

StoredColors StoreColors(const GridInputs &in, int style, const Vec3f &ambient, const Vec3f &directed) {
    const LightOptions &o = in.options;
    return {style, ColorToBytes(ambient, o.gridScale * o.gridAmbientScale, 1, o.tone),
            ColorToBytes(directed, o.gridScale, 1, o.tone)};
}

/// The point in a lane of a block: style 0, and the other styles that give most light, in ascending order. Counts
/// those left out.
bspGridPoint_t StorePoint(const GridInputs &in, const GridRecords::BlockLight &light, std::size_t lane,
                          std::map<int, std::int64_t> &dropped) {
    bspGridPoint_t stored{};
    const auto put = [&stored](std::size_t slot, const StoredColors &colors) {
        stored.ambient[slot] = colors.ambient, stored.directed[slot] = colors.directed;
        stored.styles[slot] = std::uint8_t(colors.style);
    };
    StoredColors colors =
        StoreColors(in, 0, Max(light.steady.ambient[lane], in.world.minGrid), light.steady.directed[lane]);
    constexpr std::array<std::uint8_t, 3> kBlack{};
    if (colors.ambient == kBlack && colors.directed != kBlack) // engines of IBSP take black for a wall
        colors.ambient = {1, 1, 1};
    put(0, colors);
    stored.latLong = DirectionBytes(light.mainDirection[lane]);
    std::vector<StoredColors> others;
    for (const auto &[style, parts] : light.styled)
        if (const StoredColors one = StoreColors(in, style, parts.ambient[lane], parts.directed[lane]); one.Sum() > 0)
            others.push_back(one);
    if (others.size() >= kStyles) {
        std::ranges::stable_sort(others, std::greater(), &StoredColors::Sum);
        for (std::size_t i = kStyles - 1; i < others.size(); ++i)
            ++dropped[others[i].style];
        others.resize(kStyles - 1);
        std::ranges::sort(others, {}, &StoredColors::style);
    }
    for (std::size_t i = 0; i < others.size(); ++i)
        put(i + 1, others[i]);
    return stored;
}

/// Points of a few blocks being lit. Keeps references; resets `records`.
class GridBlocks {
  public:
    GridBlocks(const GridInputs &in, std::span<ReceiverBatch> blocks, GridRecords &records)
        : in_(in), blocks_(blocks), records_(records), incident_(blocks.size()),
          sums_(in.options.cheapGrid ? blocks.size() : 0) {
        records_.Reset(blocks.size());
    }
    void Trace(const LightSettings &settings, std::span<const WeightedLight> lights, GridStats &work) {
        for (const WeightedLight &one : lights) {
            LightContributionToPoint(*one.light, one.weight, settings, in_.scene, blocks_, incident_, work.counts);
            for (std::size_t block = 0; block < blocks_.size(); ++block)
                if (incident_[block].live.Any()) {
                    Lanes3 color;
                    SetColors(*one.light, incident_[block], color);
                    // Styled light turns the main direction, even where the file has no place for its color.
                    const bool stored = one.light->style == 0 || in_.options.styleSlots;
                    records_.Add(block, color, one.light->style,
                                 stored ? GridRecords::Counts::AsLight : GridRecords::Counts::AsDirection,
                                 incident_[block]);
                    if (in_.options.cheapGrid || lights.size() > std::size_t(kMaxRecords))
                        StopFullPoints(block, color, one.light->style);
                }
        }
        for (std::size_t block = 0; block < blocks_.size(); ++block)
            AddFloodAndBounced(block, work);
    }
    void Store(std::span<bspGridPoint_t> grid, GridStats &work) const {
        const auto lights = records_.Split(in_.options, in_.world.ambient);
        for (std::size_t block = 0; block < blocks_.size(); ++block)
            for (std::size_t i = 0; i < blocks_[block].count; ++i)
                grid[blocks_[block].index[i]] = StorePoint(in_, lights[block], i, work.dropped);
    }

  private:
    /// Stops lighting points that `color`, just added, makes white (-cheapgrid), and points with kMaxRecords records.
    void StopFullPoints(std::size_t block, const Lanes3 &color, int style);
    void AddFloodAndBounced(std::size_t block, GridStats &work);

    const GridInputs &in_;
    std::span<ReceiverBatch> blocks_;
    GridRecords &records_;
    std::vector<ProbeIncidentLight> incident_;
    std::vector<Lanes3> sums_; ///< by block: light so far, of all styles; only with -cheapgrid
};

void GridBlocks::StopFullPoints(std::size_t block, const Lanes3 &color, int style) {
    // Light of another style in a slot of its own does not make the point white when it is off.
    const bool counts = in_.options.cheapGrid && (style == 0 || !in_.options.styleSlots);
    for (unsigned lanes = incident_[block].live.Bits(); lanes != 0; lanes &= lanes - 1) {
        const auto i = std::size_t(std::countr_zero(lanes));
        bool white = false;
        if (counts) {
            const Vec3f sum = sums_[block][i] + color[i];
            sums_[block].Set(i, sum);
            white = sum.x >= 255 && sum.y >= 255 && sum.z >= 255;
        }
        blocks_[block].wanted.Set(i, !white && records_.Count(block, i) < kMaxRecords);
    }
}

void GridBlocks::AddFloodAndBounced(std::size_t block, GridStats &work) {
    const ReceiverBatch &receivers = blocks_[block];
    for (std::size_t i = 0; i < receivers.count; ++i) {
        if (in_.options.floodlight || in_.world.hasFloodlight)
            AddFloodlight(in_, receivers.position[i], block, i, records_, work.counts);
        if (in_.indirect)
            AddIndirect(*in_.indirect, 0, receivers, block, i, records_, work.counts);
        for (const StyledIndirect &one : in_.styled)
            AddIndirect(*one.light, one.style, receivers, block, i, records_, work.counts);
    }
}

} // namespace

LegacyPlace PlaceLegacyPoint(const BspSpace &space, const GridLayout &layout, const Vec3f &point) {
    LegacyPlace place{point, point};
    int cluster = kSolidCluster;
    if (!PlacePoint(space, Vec3f(layout.size) * 0.5f, place.position, cluster))
        return {point, point};
    place.rayOrigin = ClearOfSolids(space, place.position);
    place.cluster = cluster;
    return place;
}

Vec3f DirectionTowardsLight(const bspGridPoint_t &point) {
    const double fromZ = (point.latLong[0] + 0.5) / kStepsPerRadian,
                 aroundZ = (point.latLong[1] + 0.5) / kStepsPerRadian;
    return Vec3f(Vec3d{std::cos(aroundZ) * std::sin(fromZ), std::sin(aroundZ) * std::sin(fromZ), std::cos(fromZ)});
}

GridLayout SetupGrid(const Bsp &bsp, Entity &world, Log &log) {
    const Vec3f wanted = keys::kGridSize.Vector(world).value_or(Vec3f(kDefaultGridSize));
    Float3 size{};
    for (std::size_t i = 0; i < 3; ++i)
        size[i] = std::max(kMinCell, std::floor(wanted[i]));
    const bspModel_t &model = bsp.models.front();
    GridLayout layout = LayoutGrid(model.mins, model.maxs, size);
    for (std::size_t axis = 0; layout.Count() > kMaxLegacyPoints; axis = (axis + 1) % 3) {
        size[axis] += kCellStep;
        layout = LayoutGrid(model.mins, model.maxs, size);
    }
    if (size[0] != wanted.x || size[1] != wanted.y || size[2] != wanted.z) {
        world.Set("gridsize", fmt::format("{:.0f} {:.0f} {:.0f}", size[0], size[1], size[2]));
        log.Print("Grid size changed to {:.0f} {:.0f} {:.0f}\n", size[0], size[1], size[2]);
    }
    log.Count(layout.Count(), "grid points");
    return layout;
}

namespace {

/// The mean light of style 0 at points that have it in slot 0.
bspGridPoint_t MeanOfPoints(std::span<const bspGridPoint_t *const> points) {
    bspGridPoint_t mean{};
    mean.latLong = points.front()->latLong;
    const auto count = int(points.size());
    for (std::size_t channel = 0; channel < 3; ++channel) {
        int ambient = 0, directed = 0;
        for (const bspGridPoint_t *point : points)
            ambient += point->ambient[0][channel], directed += point->directed[0][channel];
        mean.ambient[0][channel] = std::uint8_t((ambient + count / 2) / count);
        mean.directed[0][channel] = std::uint8_t((directed + count / 2) / count);
    }
    return mean;
}

/// Gives points in walls no style, so that engines leave them out, and the mean light of the lit points around them for
/// engines that do not look: models beside a wall are lit from its corners too.
void MarkWalls(const GridLayout &layout, const std::vector<std::uint8_t> &lit, std::vector<bspGridPoint_t> &grid) {
    std::vector<const bspGridPoint_t *> around;
    for (std::int64_t index = 0; index < layout.Count(); ++index) {
        bspGridPoint_t &point = grid[std::size_t(index)];
        if (lit[std::size_t(index)] != 0)
            continue;
        around.clear();
        const Int3 at = layout.Coordinates(index);
        for (int z = std::max(at[2] - 1, 0); z <= std::min(at[2] + 1, layout.bounds[2] - 1); ++z)
            for (int y = std::max(at[1] - 1, 0); y <= std::min(at[1] + 1, layout.bounds[1] - 1); ++y)
                for (int x = std::max(at[0] - 1, 0); x <= std::min(at[0] + 1, layout.bounds[0] - 1); ++x)
                    if (const auto near = std::size_t(layout.Index(x, y, z)); lit[near] != 0)
                        around.push_back(&grid[near]);
        if (!around.empty())
            point = MeanOfPoints(around);
        point.styles = kNoStyles;
    }
}

} // namespace

// ---- Units: bricks of the legacy grid ----

namespace {

/// How a brick is known in a store.
struct UnitName {
    Hash128 key;
    bool mayBeKnown = true; ///< false: something that matters has changed since the run before
};
/// Nothing: the brick is computed in any case.
std::optional<UnitName> NameOfLegacyBrick(const GridInputs &in, std::span<const ReceiverBatch> blocks,
                                          std::int64_t brick, const LightsInReach &lights, const LightHashes &hashes) {
    // A cache keeps direct light alone, and here it cannot be told from bounced light and from floodlight.
    const bool isPure = !in.indirect && in.styled.empty() && !in.options.floodlight && !in.world.hasFloodlight;
    if (!in.units || (in.units->IsCache() && !isPure))
        return std::nullopt;
    LightUnitKey key("legacy grid", hashes, *in.units);
    key.AddReceivers(blocks);
    key.More().Add(lights.HasManyFaint());
    if (in.units->IsCache())
        for (const WeightedLight &one : lights.List())
            key.AddLight(*one.light, one.weight);
    else
        key.More().Add(brick);
    return UnitName{key.Key(), !key.IsTouched()};
}

/// dropped: see GridStats, of the brick alone.
std::vector<std::byte> BytesOfLegacyBrick(std::span<const ReceiverBatch> blocks, std::span<const bspGridPoint_t> grid,
                                          const std::map<int, std::int64_t> &dropped) {
    UnitWriter writer;
    std::vector<bspGridPoint_t> points;
    for (const ReceiverBatch &block : blocks)
        for (std::size_t i = 0; i < block.count; ++i)
            points.push_back(grid[block.index[i]]);
    writer.PutAll(points);
    std::vector<std::int64_t> counts;
    for (const auto &[style, count] : dropped)
        counts.insert(counts.end(), {style, count});
    writer.PutAll(counts);
    return writer.Take();
}

/// Sets the points of the brick if the store has them.
bool FindLegacyBrick(const UnitStore &units, const Hash128 &key, std::span<const ReceiverBatch> blocks,
                     std::span<bspGridPoint_t> grid, GridStats &work) {
    const auto bytes = units.Find(key);
    if (!bytes)
        return false;
    UnitReader reader(*bytes);
    std::vector<bspGridPoint_t> points;
    std::vector<std::int64_t> dropped;
    reader.GetAll(points);
    reader.GetAll(dropped);
    std::size_t count = 0;
    for (const ReceiverBatch &block : blocks)
        count += block.count;
    if (!reader.IsComplete() || points.size() != count || dropped.size() % 2 != 0)
        return false;
    auto next = points.begin();
    for (const ReceiverBatch &block : blocks)
        for (std::size_t i = 0; i < block.count; ++i)
            grid[block.index[i]] = *next++;
    for (std::size_t i = 0; i < dropped.size(); i += 2)
        work.dropped[int(dropped[i])] += dropped[i + 1];
    return true;
}

/// By brick, whether this process computes it; empty: all. Neighbors have different costs, so every n-th.
std::vector<std::uint8_t> OwnBricks(const UnitStore *units, std::size_t count) {
    return units && units->IsPart() ? units->Own(std::vector<double>(count, 1.0), UnitStore::Division::BySize)
                                    : std::vector<std::uint8_t>();
}

} // namespace

std::vector<bspGridPoint_t> TraceGrid(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                                      GridStats &stats) {
    const LightSettings settings{.pass = LightPass::LegacyGrid,
                                 .sunOnly = in.options.sunOnly,
                                 .pointAreas = in.options.faster,
                                 .skip = in.options.skip};
    const PassLights passLights(lights);
    const LightHashes hashes(lights, in.units);
    std::vector<bspGridPoint_t> grid(std::size_t(layout.Count()), bspGridPoint_t{});
    std::vector<std::uint8_t> lit(grid.size()); // a byte each: workers write side by side
    const GridBricks bricks(layout);
    SpareRecords spare;
    stats.points = layout.Count();
    const std::vector<std::uint8_t> own = OwnBricks(in.units, std::size_t(bricks.Count()));
    RunBricks(in, bricks.Count(), stats, [&](std::int64_t brick, GridStats &work) {
        if (!own.empty() && own[std::size_t(brick)] == 0)
            return;
        std::vector<ReceiverBatch> blocks = PlaceBrick(in.space, layout, bricks.Points(brick), work);
        if (blocks.empty())
            return;
        for (const ReceiverBatch &block : blocks)
            for (std::size_t i = 0; i < block.count; ++i)
                lit[block.index[i]] = 1;
        StartFaintResiduals(blocks, kFaintInBrick);
        const LightsInReach lightsInReach(passLights, BrickExtent(blocks), {std::uint64_t(brick), kFaintInBrick},
                                          in.options.skip, work);
        const std::optional<UnitName> unit = NameOfLegacyBrick(in, blocks, brick, lightsInReach, hashes);
        if (unit && unit->mayBeKnown && FindLegacyBrick(*in.units, unit->key, blocks, grid, work))
            return;
        const std::map<int, std::int64_t> droppedBefore = std::exchange(work.dropped, {});
        LightSettings pass = settings;
        pass.faint = lightsInReach.HasManyFaint() ? kFaintInBrick : 0;
        std::unique_ptr<GridRecords> records = spare.Take();
        for (std::size_t first = 0; first < blocks.size(); first += kBlocksTogether) {
            const std::size_t count = std::min(kBlocksTogether, blocks.size() - first);
            GridBlocks together(in, std::span(blocks).subspan(first, count), *records);
            together.Trace(pass, lightsInReach.List(), work);
            together.Store(grid, work);
        }
        spare.Return(std::move(records));
        if (unit)
            in.units->Keep(unit->key, BytesOfLegacyBrick(blocks, grid, work.dropped));
        for (const auto &[style, count] : droppedBefore)
            work.dropped[style] += count;
    });
    if (in.options.styleSlots)
        MarkWalls(layout, lit, grid);
    return grid;
}

} // namespace q3
