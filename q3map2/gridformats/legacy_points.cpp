// GPL-2.0-or-later. The SH grid sampled at the points of the legacy grid.
#include "q3map2/gridformats/legacy_points.h"

#include "common/error.h"
#include "q3map2/light/grid/sh_floats.h"

#include <algorithm>
#include <cmath>

namespace q3 {

namespace {

constexpr std::int64_t kMaxPoints = 0x100000; ///< as the light stage allows
constexpr std::int32_t kContentsSolid = 1, kContentsTranslucent = 0x20000000;
/// Boxes are shrunk by 0.125 on each side, so that open space that they just touch does not count. Game units.
constexpr float kBoxMargin = -0.125f;

/// Calls f(x, y, z, index) for each point of a layout in its order.
template <typename F> void EachPoint(const GridLayout &layout, const F &f) {
    std::size_t index = 0;
    for (int z = 0; z < layout.bounds[2]; ++z)
        for (int y = 0; y < layout.bounds[1]; ++y)
            for (int x = 0; x < layout.bounds[0]; ++x)
                f(x, y, z, index++);
}

/// Calls f(index, squared distance) for the up to 26 neighbors of a point.
template <typename F> void EachNeighbor(const GridLayout &layout, int x, int y, int z, const F &f) {
    for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const int ax = x + dx, ay = y + dy, az = z + dz;
                if ((dx == 0 && dy == 0 && dz == 0) || ax < 0 || ay < 0 || az < 0 || ax >= layout.bounds[0] ||
                    ay >= layout.bounds[1] || az >= layout.bounds[2])
                    continue;
                const Vec3f step = Vec3f(layout.size) * Vec3f{float(dx), float(dy), float(dz)};
                f(std::size_t(layout.Index(ax, ay, az)), Dot(step, step));
            }
}

/// Classifies and lights the points of a legacy grid.
class PointSampler {
  public:
    PointSampler(const GridSource &source, const BspSpace &space, const GridLayout &layout)
        : source_(source), space_(space), lit_(std::size_t(layout.Count())) {
        points_.layout = layout;
        points_.light.resize(lit_.size());
        points_.use.assign(lit_.size(), PointUse::Void);
    }

    LegacyPoints Run() {
        const std::vector<bool> solid = SolidPoints(space_, points_.layout);
        EachPoint(points_.layout, [&](int x, int y, int z, std::size_t index) {
            const Vec3f at(points_.layout.Position(x, y, z));
            if (!solid[index])
                points_.use[index] = PointUse::Open;
            else if (space_.AnyOpen(at - Cell(), at + Cell(), kBoxMargin))
                points_.use[index] = PointUse::Solid;
            else
                return;
            // In the open, no light in reach means darkness.
            lit_[index] = source_.Sample(at, points_.light[index]) || !solid[index];
        });
        EachPoint(points_.layout, [&](int x, int y, int z, std::size_t) { MarkOnlyCorners(x, y, z); });
        while (Dilate()) {
        }
        return std::move(points_);
    }

  private:
    Vec3f Cell() const { return Vec3f(points_.layout.size); }

    /// Marks the corners of the cell above a point, if it has open space but all corners are in solids.
    void MarkOnlyCorners(int x, int y, int z) {
        const GridLayout &layout = points_.layout;
        std::array<std::size_t, 8> corners{};
        for (unsigned i = 0; i < 8; ++i) {
            const int at[3] = {x + int(i & 1), y + int(i >> 1 & 1), z + int(i >> 2)};
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (at[axis] >= layout.bounds[axis])
                    return;
            corners[i] = std::size_t(layout.Index(at[0], at[1], at[2]));
        }
        const auto isOpen = [this](std::size_t i) { return points_.use[i] == PointUse::Open; };
        const Vec3f mins(layout.Position(x, y, z));
        if (std::ranges::any_of(corners, isOpen) || !space_.AnyOpen(mins, mins + Cell(), kBoxMargin))
            return;
        for (const std::size_t i : corners)
            points_.use[i] = PointUse::Only;
    }

    /// Lights points in solids that have lit neighbors, from the state before this round. False: there are none.
    bool Dilate() {
        const std::vector<bool> before = lit_;
        bool any = false;
        EachPoint(points_.layout, [&](int x, int y, int z, std::size_t index) {
            if (before[index] || points_.use[index] == PointUse::Void)
                return;
            bspGridPointSH_t sum{};
            float total = 0;
            EachNeighbor(points_.layout, x, y, z, [&](std::size_t from, float distance2) {
                if (!before[from])
                    return;
                const float weight = 1 / distance2;
                total += weight;
                AddScaled(weight, points_.light[from], sum);
            });
            if (!(total > 0))
                return;
            for (Float3 &rgb : sum.coeffs)
                for (float &value : rgb)
                    value /= total;
            points_.light[index] = sum;
            lit_[index] = any = true;
        });
        return any;
    }

    const GridSource &source_;
    const BspSpace &space_;
    LegacyPoints points_;
    std::vector<bool> lit_;
};

} // namespace

GridLayout LegacyLayout(const Bsp &bsp) {
    if (bsp.models.empty())
        throw Error("the map has no world model, so no place for a light grid");
    const Vec3f cell = LegacyCell(bsp);
    const GridLayout layout = LayoutGrid(bsp.models[0].mins, bsp.models[0].maxs, cell.Array());
    if (layout.Count() > std::max(kMaxPoints, std::int64_t(bsp.gridPoints.size())))
        throw Error("the legacy light grid has {} points with the gridsize {} {} {}, expected at most {}",
                    layout.Count(), cell.x, cell.y, cell.z, kMaxPoints);
    return layout;
}

LegacyPoints SampleLegacyPoints(const GridSource &source, const BspSpace &space, const GridLayout &layout) {
    return PointSampler(source, space, layout).Run();
}

std::vector<bool> SolidBrushes(const Bsp &bsp) {
    std::vector<bool> solid;
    solid.reserve(bsp.brushes.size());
    for (const bspBrush_t &brush : bsp.brushes) {
        const std::int32_t contents = bsp.shaders[std::size_t(brush.shaderNum)].contentFlags;
        solid.push_back((contents & kContentsSolid) != 0 && (contents & kContentsTranslucent) == 0);
    }
    return solid;
}

std::vector<bool> SolidPoints(const BspSpace &space, const GridLayout &layout) {
    std::vector<bool> solid(std::size_t(layout.Count()));
    EachPoint(layout, [&](int x, int y, int z, std::size_t index) {
        solid[index] = space.ClusterAt(Vec3f(layout.Position(x, y, z)), 0) == kSolidCluster;
    });
    return solid;
}

} // namespace q3
