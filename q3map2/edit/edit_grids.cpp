// GPL-2.0-or-later. Light grids of a map whose world was scaled or moved.
#include "q3map2/edit/edit_grids.h"

#include "common/error.h"
#include "q3map2/edit/edit_lumps.h"
#include "q3map2/edit/edit_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace q3 {

namespace {

/// Positions that differ by less than this part of a cell are the same.
constexpr double kSamePlace = 1e-3;
constexpr int kMostSteps = 16;     ///< between neighboring floats, and of cells
constexpr double kCellStep = 1e-6; ///< part of a cell by which it may shrink

/// The value, or a float near it, whose first or last grid position by the rule of engines is `wanted`.
float NudgedBound(float bound, float cell, double wanted, bool isFirst) {
    const auto fits = [&](float value) {
        const double place = double(cell * (isFirst ? std::ceil(value / cell) : std::floor(value / cell)));
        return std::abs(place - wanted) < kSamePlace * double(cell);
    };
    float down = bound, up = bound;
    for (int step = 0; step <= kMostSteps; ++step) {
        if (fits(down))
            return down;
        if (fits(up))
            return up;
        down = std::nextafter(down, -std::numeric_limits<float>::infinity());
        up = std::nextafter(up, std::numeric_limits<float>::infinity());
    }
    return bound;
}

bool IsSameOnAxis(const GridLayout &a, const GridLayout &b, std::size_t axis) {
    return a.bounds[axis] == b.bounds[axis] &&
           std::abs(a.mins[axis] - b.mins[axis]) <= float(kSamePlace) * a.size[axis];
}

/// Changes a cell and the bounds of the world by rounding steps until the rule of engines gives the wanted points along
/// the axis. False: it does not.
bool FitAxis(const GridLayout &wanted, std::size_t axis, bspModel_t &world, Float3 &cell) {
    for (int step = 0; step <= kMostSteps; ++step) {
        const std::string text = NumberText(double(wanted.size[axis]) * (1 - step * kCellStep));
        bspModel_t model = world;
        Float3 size = cell;
        size[axis] = float(NumberFromText(text));
        const double first = double(wanted.mins[axis]), count = wanted.bounds[axis] - 1;
        model.mins[axis] = NudgedBound(model.mins[axis], size[axis], first, true);
        model.maxs[axis] = NudgedBound(model.maxs[axis], size[axis], first + double(size[axis]) * count, false);
        if (IsSameOnAxis(wanted, LayoutGrid(model.mins, model.maxs, size), axis)) {
            world = model;
            cell = size;
            return true;
        }
    }
    return false;
}

/// Whether the legacy grid of `before` is where it belongs in `bsp`, whose world bounds and gridsize may change by
/// rounding.
bool FitLegacyGrid(const Bsp &before, const AxisTransform &transform, Bsp &bsp) {
    std::vector<Entity> entities = StoredEntities(bsp.entities, "the map");
    try {
        const bspModel_t &old = before.models[0];
        GridLayout wanted =
            LayoutGrid(old.mins, old.maxs, GridCellOf(StoredEntities(before.entities, "the map").front()));
        if (wanted.Count() != std::int64_t(bsp.gridPoints.size()))
            return false;
        wanted.mins = transform.Apply(wanted.mins);
        wanted.size = GridCellOf(entities.front());
        Float3 cell = wanted.size;
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (!FitAxis(wanted, axis, bsp.models[0], cell))
                return false;
        if (cell != wanted.size) {
            entities.front().Set("gridsize", VectorText(Vec3d(cell)));
            bsp.entities = FormatEntities(entities);
        }
        return true;
    } catch (const Error &) { // no grid can be laid out
        return false;
    }
}

} // namespace

Float3 GridCellOf(const Entity &world) {
    const auto given = world.Vector({"gridsize"});
    if (!given || given->x <= 0 || given->y <= 0 || given->z <= 0)
        return kDefaultGridSize;
    return given->Array();
}

void TransformGrids(const Bsp &before, const AxisTransform &transform, Bsp &bsp, Log &log) {
    if (!bsp.gridPoints.empty() && !FitLegacyGrid(before, transform, bsp)) {
        bsp.gridPoints.clear();
        log.Warn("light grid", "the legacy light grid is dropped: engines would look for its points elsewhere; "
                               "-light -onlygrid makes a new one");
    }
    if (bsp.gridSH) {
        bspGridSHHeader_t &head = bsp.gridSH->header;
        head.gridMins = transform.Apply(head.gridMins);
        for (std::size_t i = 0; i < 3; ++i)
            head.gridSize[i] = float(double(head.gridSize[i]) * transform.factors[i]);
    }
    if (bsp.sparseGridSH) {
        SparseGridSH &grid = *bsp.sparseGridSH;
        grid.mins = transform.Apply(grid.mins);
        for (std::size_t i = 0; i < 3; ++i)
            grid.cell[i] = float(double(grid.cell[i]) * transform.factors[i]);
    }
    TransformLumps(transform, bsp, log);
}

} // namespace q3
