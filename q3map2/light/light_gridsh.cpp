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
/// Lights that together give less than this to all points of a brick are left out. Byte scale; an eighth of what a screen can show.
constexpr float kFaintTolerance = 1.0f / 8;

/// One point that gets light, while its brick is traced.
struct LitPoint {
    Vec3f position;
    int cluster = kSolidCluster;
    std::uint32_t index = 0;
    std::array<ShVector, 3> sum{}; // [channel][k], unit scale
};

/// Adds what one light gives to a packet's points.
void AddLight(const Light &light, const ContributionSettings &settings, const GridInputs &in, std::span<LitPoint> points,
              ContributionCounts &counts) {
    PointPacket packet;
    packet.count = int(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        packet.position[i] = packet.rayOrigin[i] = points[i].position;
        packet.cluster[i] = points[i].cluster;
        packet.index[i] = points[i].index;
    }
    LightContributionToPoint(light, settings, in.scene, packet, counts);
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (packet.add[i] <= 0 || packet.visible[i] == Vec3f{})
            continue;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const double scale = (light.negative ? -1.0 : 1.0) * double(light.color[channel]) *
                                 double(packet.visible[i][channel]) / 255;
            for (std::size_t k = 0; k < 9; ++k)
                points[i].sum[channel][k] += scale * packet.moments[i][k];
        }
    }
}

/// A hemisphere of uniform light around +z or -z, as floodlight gives it.
void AddFlood(const GridInputs &in, LitPoint &point, RayCounts &counts) {
    for (const float up : {1.0f, -1.0f}) {
        const float share =
            FloodShare(in.scene, point.position, up, in.world.floodDistance, in.options.lowQuality, counts);
        const Vec3d light = Vec3d(in.world.floodColor) * (double(in.world.floodIntensity) * share / 255);
        const double convolve0 = in.options.shRadiance ? 1 / std::numbers::pi : kCosineLobe[0] / std::numbers::pi;
        const double convolve1 = in.options.shRadiance ? 1 / std::numbers::pi : kCosineLobe[2] / std::numbers::pi;
        for (std::size_t channel = 0; channel < 3; ++channel) {
            point.sum[channel][0] += light[channel] * convolve0 * kShC0 * 2 * std::numbers::pi;
            point.sum[channel][2] += light[channel] * convolve1 * kShC1 * std::numbers::pi * up;
        }
    }
}

/// Ambient light, the minimum, the grid scale; and no channel whose mean is negative.
bspGridPointSH_t StorePoint(const GridInputs &in, const LitPoint &point) {
    // Coefficient 0 of light 1 from everywhere.
    const double uniform = 1 / kShC0 / (in.options.shRadiance ? std::numbers::pi : 1);
    const double scale = in.options.gridScale > 0 ? in.options.gridScale : 1;
    bspGridPointSH_t stored{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        ShVector sum = point.sum[channel];
        sum[0] += double(in.world.ambient[channel]) / 255 * uniform;
        if (sum[0] < 0)
            sum = {};
        sum[0] = std::max(sum[0], double(in.world.minGrid[channel]) / 255 * uniform);
        for (std::size_t k = 0; k < 9; ++k)
            stored.coeffs[k][channel] = float(sum[k] * scale);
    }
    return stored;
}

/// Where points are lit from, and which of them are.
class PointPlaces {
  public:
    PointPlaces(const GridInputs &in, const GridLayout &layout, const GridBricks &bricks)
        : states_(std::size_t(layout.Count()), PointState::Void), places_(std::size_t(bricks.Count())) {
        in.jobs.For(bricks.Count(), [&](std::int64_t brick, int) {
            for (const BrickPoint &point : bricks.Points(brick)) {
                const PlacedPoint placed = PlaceGridPoint(in.space, layout, point.position);
                states_[point.index] = placed.state;
                if (placed.state == PointState::Open || placed.state == PointState::Moved)
                    places_[std::size_t(brick)].push_back({placed.position, placed.cluster, point.index, {}});
            }
        });
    }
    /// Points of a brick that are to be lit; taken once.
    std::vector<LitPoint> Take(std::int64_t brick) { return std::move(places_[std::size_t(brick)]); }
    std::vector<PointState> &States() { return states_; }

  private:
    std::vector<PointState> states_;
    std::vector<std::vector<LitPoint>> places_;
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
        log.Warn("SH grid size", "an SH grid with cells of {} {} {} passes the 2 GiB of a lump; {} {} {} is used", asked[0],
                 asked[1], asked[2], size[0], size[1], size[2]);
    log.Print("SH grid cells of {} {} {}\n", size[0], size[1], size[2]);
    log.Count(layout.Count(), "SH grid points");
    return layout;
}

LightGridSH TraceGridSH(const GridInputs &in, const GridLayout &layout, const std::vector<Light> &lights,
                        GridStats &stats) {
    const ContributionSettings settings{.pass = LightPass::GridSH,
                                        .sunOnly = in.options.sunOnly,
                                        .ignorePvs = in.options.noSkip,
                                        .radiance = in.options.shRadiance};
    LightGridSH grid;
    grid.header = {layout.mins, layout.size, layout.bounds, std::int32_t(layout.Count())};
    grid.points.assign(std::size_t(layout.Count()), bspGridPointSH_t{});
    stats.points = layout.Count();

    const GridBricks bricks(layout);
    PointPlaces places(in, layout, bricks);
    const bool flood = in.options.floodlight || in.world.hasFloodlight;
    RunGridBricks(in, bricks, stats, [&](std::int64_t brick, GridStats &work) {
        std::vector<LitPoint> points = places.Take(brick);
        if (points.empty())
            return;
        const BrickLights candidates(lights, BrickView::Of(points), kFaintTolerance, in.options, work);
        for (const Light *light : candidates.List())
            ForEachPacket(std::span(points),
                          [&](std::span<LitPoint> packet) { AddLight(*light, settings, in, packet, work.counts); });
        for (LitPoint &point : points) {
            if (flood)
                AddFlood(in, point, work.counts);
            grid.points[point.index] = StorePoint(in, point);
        }
    });
    FillGridSH(in, layout, places.States(), grid);
    const auto &states = places.States();
    stats.open = std::count(states.begin(), states.end(), PointState::Open);
    stats.moved = std::count(states.begin(), states.end(), PointState::Moved);
    stats.filled = std::count(states.begin(), states.end(), PointState::Filled);
    return grid;
}

} // namespace q3
