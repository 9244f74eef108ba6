// GPL-2.0-or-later. The SH light grid: placement, and light at every point in the open.
#include "q3map2/light/grid_bricks.h"
#include "q3map2/light/gridsh_fill.h"
#include "q3map2/light/light_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace q3 {

namespace {

constexpr float kMinCell = 8;
/// Engines hold lump lengths in 32-bit integers.
constexpr std::int64_t kMaxPoints = (0x7fffffffll - 40) / 108;
/// Lights fainter than this in all of a brick, and then at each point, are represented by a few of them. Byte scale; an
/// eighth of what a screen can show.
constexpr float kFaint = 1.0f / 8;

/// Sums beyond this, from absurd keys and scales, are cut. 1 = byte 255.
constexpr double kMaxCoefficient = 1e9;

/// Sum of what arrives at a place, [channel][k], unit scale.
using PointSum = std::array<ShVector, 3>;

/// The same for a block of places.
struct BlockSum {
    alignas(64) std::array<std::array<std::array<double, kPacketSize>, 9>, 3> sum{};

    void Add(const Light &light, const Arrivals &arrivals) {
        const double sign = light.negative ? -1 : 1;
        const Lanes *tints[] = {&arrivals.tint.x, &arrivals.tint.y, &arrivals.tint.z};
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double scale = sign * double(light.color[channel]) / 255;
            std::array<double, kPacketSize> scales;
            for (std::size_t i = 0; i < kPacketSize; ++i)
                scales[i] = arrivals.tinted && arrivals.live[i] != 0 ? scale * double((*tints[channel])[i]) : scale;
            for (std::size_t k = 0; k < 9; ++k)
                for (std::size_t i = 0; i < kPacketSize; ++i)
                    sum[channel][k][i] += scales[i] * double(arrivals.moments[k][i]);
        }
    }
    PointSum Of(std::size_t i) const {
        PointSum point;
        for (std::size_t channel = 0; channel < 3; ++channel)
            for (std::size_t k = 0; k < 9; ++k)
                point[channel][k] = sum[channel][k][i];
        return point;
    }
};

/// A hemisphere of uniform light around +z or -z, as floodlight gives it.
void AddFlood(const GridInputs &in, const Vec3f &position, PointSum &sum, RayCounts &counts) {
    for (const float up : {1.0f, -1.0f}) {
        const float share = FloodShare(in.scene, position, up, in.world.floodDistance, in.options.lowQuality, counts);
        const Vec3d light = Vec3d(in.world.floodColor) * (double(in.world.floodIntensity) * share / 255);
        const double convolve0 = in.options.shRadiance ? 1 / std::numbers::pi : kCosineLobe[0] / std::numbers::pi;
        const double convolve1 = in.options.shRadiance ? 1 / std::numbers::pi : kCosineLobe[2] / std::numbers::pi;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            sum[channel][0] += light[channel] * convolve0 * kShC0 * 2 * std::numbers::pi;
            sum[channel][2] += light[channel] * convolve1 * kShC1 * std::numbers::pi * up;
        }
    }
}

/// Ambient light, the minimum, the grid scale; and no channel whose mean is negative.
bspGridPointSH_t StorePoint(const GridInputs &in, const PointSum &total) {
    // Coefficient 0 of light 1 from everywhere.
    const double uniform = 1 / kShC0 / (in.options.shRadiance ? std::numbers::pi : 1);
    const double scale = in.options.gridScale > 0 ? in.options.gridScale : 1;
    bspGridPointSH_t stored{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        ShVector sum = total[channel];
        sum[0] += double(in.world.ambient[channel]) / 255 * uniform;
        if (sum[0] < 0)
            sum = {};
        sum[0] = std::max(sum[0], double(in.world.minGrid[channel]) / 255 * uniform);
        for (std::size_t k = 0; k < 9; ++k)
            stored.coeffs[k][channel] = float(std::clamp(sum[k] * scale, -kMaxCoefficient, kMaxCoefficient));
    }
    return stored;
}

/// Where points are lit from, and which of them are.
class PointPlaces {
  public:
    PointPlaces(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks)
        : states_(std::size_t(layout.Count()), PointState::Void), places_(std::size_t(bricks.Count())) {
        std::vector<std::vector<Displacement>> displaced(places_.size());
        in.jobs.For(bricks.Count(), [&](std::int64_t brick, int) {
            for (const BrickPoint &point : bricks.Points(brick)) {
                const PlacedPoint placed = PlaceGridPoint(in.space, layout, point.position);
                states_[point.index] = placed.state;
                if (placed.cluster < 0)
                    continue;
                if (placed.state != PointState::Open)
                    displaced[std::size_t(brick)].push_back({point.index, placed.position});
                AddPlace(places_[std::size_t(brick)], placed.position, placed.position, placed.cluster, point.index);
            }
        });
        for (const auto &part : displaced)
            displaced_.insert(displaced_.end(), part.begin(), part.end());
        std::sort(displaced_.begin(), displaced_.end(),
                  [](const Displacement &a, const Displacement &b) { return a.index < b.index; });
    }
    /// Places of a brick that are to be lit; taken once.
    std::vector<LightPlaces> Take(std::int64_t brick) { return std::move(places_[std::size_t(brick)]); }
    std::vector<PointState> &States() { return states_; }
    const std::vector<Displacement> &Displaced() const { return displaced_; }

  private:
    std::vector<PointState> states_;
    std::vector<std::vector<LightPlaces>> places_;
    std::vector<Displacement> displaced_;
};

} // namespace

GridLayout SetupGridSH(const Bsp &bsp, const Float3 &legacySize, const LightOptions &options, Log &log) {
    Float3 size{};
    for (std::size_t i = 0; i < 3; ++i) {
        const float wanted = options.gridSizeSH ? (*options.gridSizeSH)[i] : legacySize[i] / options.gridScaleSH;
        size[i] = std::max(kMinCell, wanted);
    }
    const bspModel_t &model = bsp.models.front();
    GridLayout layout = LayoutGrid(model.mins, model.maxs, size);
    const Float3 asked = size;
    while (layout.Count() > kMaxPoints) {
        for (float &axis : size)
            axis += kMinCell;
        layout = LayoutGrid(model.mins, model.maxs, size);
    }
    if (size != asked)
        log.Warn("SH grid size", "an SH grid with cells of {} {} {} passes the 2 GiB of a lump; {} {} {} is used",
                 asked[0], asked[1], asked[2], size[0], size[1], size[2]);
    log.Print("SH grid cells of {} {} {}\n", size[0], size[1], size[2]);
    log.Count(layout.Count(), "SH grid points");
    return layout;
}

LightGridSH TraceGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                        GridStats &stats) {
    const ContributionSettings settings{.pass = LightPass::GridSH,
                                        .sunOnly = in.options.sunOnly,
                                        .radiance = in.options.shRadiance,
                                        .samples = in.options.shSamples,
                                        .skip = in.options.skip};
    const float faint = kFaint / in.options.shSamples;
    const LightsByCluster byCluster(lights);
    LightGridSH grid;
    grid.header = {layout.mins, layout.size, layout.bounds, std::int32_t(layout.Count())};
    grid.points.assign(std::size_t(layout.Count()), bspGridPointSH_t{});
    stats.points = layout.Count();

    const GridBricks bricks(layout);
    PointPlaces places(in, layout, bricks);
    const bool flood = in.options.floodlight || in.world.hasFloodlight;
    RunGridBricks(in, bricks, stats, [&](std::int64_t brick, GridStats &work) {
        std::vector<LightPlaces> blocks = places.Take(brick);
        if (blocks.empty())
            return;
        StartFaint(blocks, faint);
        std::vector<BlockSum> sums(blocks.size());
        Arrivals arrivals;
        const BrickLights candidates(byCluster, BrickView(blocks), std::uint64_t(brick), faint, in.options.skip, work);
        ContributionSettings pass = settings;
        pass.faint = candidates.Many() ? faint : 0;
        for (const BrickLight &one : candidates.List())
            for (std::size_t block = 0; block < blocks.size(); ++block)
                if (LightContributionToPoint(*one.light, one.weight, pass, in.scene, blocks[block], arrivals,
                                             work.counts))
                    sums[block].Add(*one.light, arrivals);
        for (std::size_t block = 0; block < blocks.size(); ++block)
            for (std::size_t i = 0; i < blocks[block].count; ++i) {
                PointSum sum = sums[block].Of(i);
                if (flood)
                    AddFlood(in, blocks[block].position[i], sum, work.counts);
                grid.points[blocks[block].index[i]] = StorePoint(in, sum);
            }
    });
    FillGridSH(in, layout, places.Displaced(), places.States(), grid);
    const auto &states = places.States();
    stats.open = std::count(states.begin(), states.end(), PointState::Open) +
                 std::count(states.begin(), states.end(), PointState::Beside);
    stats.moved = std::count(states.begin(), states.end(), PointState::Moved);
    stats.filled = std::count(states.begin(), states.end(), PointState::Filled);
    return grid;
}

} // namespace q3
