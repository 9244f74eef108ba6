// GPL-2.0-or-later. Light grids of a map whose world was scaled or moved.
#include "q3map2/edit/edit_grids.h"

#include "common/error.h"
#include "q3map2/edit/edit_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace q3 {

namespace {

constexpr Float3 kDefaultCell = {64, 64, 128};
constexpr std::array<std::string_view, 2> kLumpsWithoutPositions = {"RGBLIGHTING", "LIGHTINGDIR"};
/// Positions that differ by less than this part of a cell are the same.
constexpr double kSamePlace = 1e-3;
constexpr int kMostSteps = 16; ///< between neighboring floats

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

bool IsSameGrid(const GridLayout &a, const GridLayout &b) {
    for (std::size_t i = 0; i < 3; ++i)
        if (a.bounds[i] != b.bounds[i] || std::abs(a.mins[i] - b.mins[i]) > float(kSamePlace) * a.size[i])
            return false;
    return true;
}

/// Whether the legacy grid of `before` is where it belongs in `bsp`.
bool LegacyGridFits(const Bsp &before, const AxisTransform &transform, Bsp &bsp) {
    const Entity oldWorld = EntitiesOf(before, "the map").front();
    const Entity newWorld = EntitiesOf(bsp, "the map").front();
    try {
        const bspModel_t &old = before.models[0];
        GridLayout wanted = LayoutGrid(old.mins, old.maxs, GridCellOf(oldWorld));
        if (wanted.Count() != std::int64_t(bsp.gridPoints.size()))
            return false;
        wanted.mins = transform.Apply(wanted.mins);
        wanted.size = GridCellOf(newWorld);
        bspModel_t &world = bsp.models[0];
        for (std::size_t i = 0; i < 3; ++i) {
            world.mins[i] = NudgedBound(world.mins[i], wanted.size[i], double(wanted.mins[i]), true);
            const double last = double(wanted.mins[i]) + double(wanted.size[i]) * (wanted.bounds[i] - 1);
            world.maxs[i] = NudgedBound(world.maxs[i], wanted.size[i], last, false);
        }
        return IsSameGrid(wanted, LayoutGrid(world.mins, world.maxs, wanted.size));
    } catch (const Error &) { // no grid can be laid out
        return false;
    }
}

} // namespace

Float3 GridCellOf(const Entity &world) {
    const auto given = world.Vector({"gridsize"});
    if (!given || given->x <= 0 || given->y <= 0 || given->z <= 0)
        return kDefaultCell;
    return given->Array();
}

void TransformGrids(const Bsp &before, const AxisTransform &transform, Bsp &bsp, Log &log) {
    if (!bsp.gridPoints.empty() && !LegacyGridFits(before, transform, bsp)) {
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
    std::erase_if(bsp.bspx, [&](const BspxLump &lump) {
        const bool keeps = std::ranges::find(kLumpsWithoutPositions, lump.name) != kLumpsWithoutPositions.end();
        if (!keeps)
            log.Warn("BSPX lump", "the BSPX lump {} is dropped: it may hold positions", lump.name);
        return !keeps;
    });
}

} // namespace q3
