// GPL-2.0-or-later. The points of the light grids around a place: states, where they are lit from, what fills them.
#include "q3map2/lightmap/explain/explain_grid.h"

#include "q3map2/light/grid_bakes.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

/// Cells on each side of the cell that are lit too, since filling and fit of its corners depend on them.
constexpr int kCellsAround = 3;

/// A box of points of a grid.
struct GridWindow {
    GridLayout layout;
    Int3 first{}; ///< its first point in the whole grid
    Int3 cell{};  ///< the lowest corner of the cell, in the whole grid
    Vec3f part;   ///< place of the point in the cell, 0 to 1
};

/// The cell around p and `around` cells on all sides of it.
GridWindow WindowAround(const GridLayout &whole, const Vec3f &p, int around) {
    GridWindow window{whole, {}, {}, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const int last = whole.bounds[axis] - 1;
        const float at = std::clamp((p[axis] - whole.mins[axis]) / whole.size[axis], 0.0f, float(last));
        const int low = std::min(int(at), std::max(0, last - 1)), first = std::max(0, low - around);
        window.cell[axis] = low, window.first[axis] = first;
        window.part[axis] = at - float(low);
        window.layout.mins[axis] = whole.mins[axis] + float(first) * whole.size[axis];
        window.layout.bounds[axis] = std::min(last, low + 1 + around) - first + 1;
    }
    return window;
}

/// Calls use(point in the whole grid, in the window, weight in the blend) for the corners of the cell.
template <typename Use> void ForCorners(const GridWindow &window, const GridLayout &whole, const Use &use) {
    for (int corner = 0; corner < 8; ++corner) {
        Int3 point = window.cell, inWindow{};
        float weight = 1;
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool upper = (corner >> axis & 1) != 0;
            point[axis] += upper ? 1 : 0;
            inside = inside && point[axis] < whole.bounds[axis];
            inWindow[axis] = point[axis] - window.first[axis];
            weight *= upper ? window.part[axis] : 1 - window.part[axis];
        }
        if (inside)
            use(point, inWindow, weight);
    }
}

float MeanByte(const bspGridPointSH_t &point) {
    return 255 * MeanLight(std::bit_cast<SHFloats>(point));
}

std::int64_t IndexIn(const GridLayout &layout, const Int3 &point) {
    return layout.Index(point[0], point[1], point[2]);
}

/// Sources of the value of a point before the fit, the largest fraction first.
std::vector<SourceAccount> SourcesOf(const GridWindow &window, const GridSHSteps &steps, std::uint32_t index) {
    std::vector<SourceAccount> result;
    for (const FillSource &source :
         FillSources(window.layout, steps.displaced, steps.groups, steps.placed, steps.traced, index)) {
        Int3 point = window.layout.Coordinates(source.index);
        for (std::size_t axis = 0; axis < 3; ++axis)
            point[axis] += window.first[axis];
        result.push_back(
            {point, source.position, source.group, float(source.weight), MeanByte(steps.traced.points[source.index])});
    }
    std::ranges::stable_sort(result,
                             [](const SourceAccount &a, const SourceAccount &b) { return a.fraction > b.fraction; });
    return result;
}

std::optional<Vec3f> LitFrom(const GridSHSteps &steps, std::uint32_t index, const Vec3f &position) {
    const PointState state = steps.placed[index];
    if (state == PointState::Open || state == PointState::OnEmitter)
        return position;
    const auto found = std::ranges::find(steps.displaced, index, &DisplacedPoint::index);
    return found == steps.displaced.end() ? std::optional<Vec3f>() : found->position;
}

GridLayout LayoutOf(const LightSetup &setup) {
    if (const auto &grid = setup.bsp.gridSH)
        return {grid->header.gridMins, grid->header.gridSize, grid->header.gridBounds};
    Log quiet(Log::Nowhere());
    return SetupGridSH(setup.bsp, setup.layout.size, setup.options, quiet);
}

} // namespace

GridExplainer::GridExplainer(const LightSetup &setup, const ObstacleFinder &obstacles, const JobPool &jobs)
    : setup_(setup), obstacles_(obstacles), jobs_(jobs), layout_(LayoutOf(setup)) {
    Log quiet(Log::Nowhere());
    lights_ = LightsForSH(setup, StyledLights::LeaveOut, quiet);
    int culled = 0;
    legacyLights_ =
        SetupEnvelopes(setup.lights, LightPass::LegacyGrid, setup.options, setup.space, setup.skySeenFrom, culled);
}

std::vector<GridPointAccount> GridExplainer::CellAt(const Vec3f &p) const {
    Log quiet(Log::Nowhere());
    const GridWindow window = WindowAround(layout_, p, kCellsAround);
    const GridInputs in{setup_.space, setup_.scene, setup_.options, setup_.world, jobs_, quiet};
    GridSHTracer tracer(in, window.layout, lights_);
    GridStats stats;
    GridSHSteps steps;
    const LightGridSH fitted = tracer.TraceGridSH(stats, &steps);
    std::vector<GridPointAccount> corners;
    ForCorners(window, layout_, [&](const Int3 &point, const Int3 &inWindow, float weight) {
        const auto index = std::uint32_t(IndexIn(window.layout, inWindow));
        GridPointAccount &account = corners.emplace_back();
        account.point = point;
        account.index = std::uint32_t(IndexIn(layout_, point));
        account.position = Vec3f(layout_.Position(point[0], point[1], point[2]));
        account.weight = weight;
        account.placed = steps.placed[index], account.state = steps.states[index];
        account.litFrom = LitFrom(steps, index, account.position);
        account.solid = obstacles_.SolidAt(account.position);
        if (account.state == PointState::Filled)
            account.sources = SourcesOf(window, steps, index);
        for (const SourceAccount &source : account.sources)
            account.groups = std::max(account.groups, source.group + 1);
        account.traced = MeanByte(steps.traced.points[index]);
        account.filled = MeanByte(steps.filled.points[index]);
        account.fitted = MeanByte(fitted.points[index]);
        if (setup_.bsp.gridSH && account.index < setup_.bsp.gridSH->points.size())
            account.stored = MeanByte(setup_.bsp.gridSH->points[account.index]);
    });
    return corners;
}

std::vector<LegacyPointAccount> GridExplainer::LegacyCellAt(const Vec3f &p) const {
    Log quiet(Log::Nowhere());
    const GridWindow window = WindowAround(setup_.layout, p, 0);
    const GridInputs in{setup_.space, setup_.scene, setup_.options, setup_.world, jobs_, quiet};
    GridStats stats;
    const std::vector<bspGridPoint_t> points = TraceGrid(in, window.layout, legacyLights_, stats);
    std::vector<LegacyPointAccount> corners;
    ForCorners(window, setup_.layout, [&](const Int3 &point, const Int3 &inWindow, float weight) {
        LegacyPointAccount &account = corners.emplace_back();
        account.point = point;
        account.position = Vec3f(setup_.layout.Position(point[0], point[1], point[2]));
        account.weight = weight;
        const LegacyPlace place = PlaceLegacyPoint(setup_.space, setup_.layout, account.position);
        if (place.cluster >= 0)
            account.litFrom = place.position;
        account.now = points[std::size_t(IndexIn(window.layout, inWindow))];
        const auto index = std::size_t(IndexIn(setup_.layout, point));
        if (index < setup_.bsp.gridPoints.size())
            account.stored = setup_.bsp.gridPoints[index];
    });
    return corners;
}

} // namespace q3
