// GPL-2.0-or-later. The SH light grid of a map as the source of other grids.
#include "q3map2/gridformats/grid_source.h"

#include "common/error.h"
#include "libs/sh/sh.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/grid_reader.h"
#include "q3map2/bspfile/light_keys.h"
#include "q3map2/bspfile/written_keys.h"
#include "q3map2/light/grid/light_gridsh.h"
#include "q3map2/light/grid/sh_floats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace q3 {

namespace {

bool IsBlack(const bspGridPointSH_t &point) {
    return std::ranges::all_of(point.coeffs, [](const Float3 &rgb) { return rgb == Float3{}; });
}

/// The points that the light stage gives the SH grid of the map by default.
GridLayout DefaultLayoutSH(const Bsp &bsp) {
    if (bsp.models.empty())
        throw Error("the map has no world model, so no place for a light grid");
    const Vec3f legacy = LegacyCell(bsp);
    Float3 size{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        size[axis] = std::max(kMinCell, legacy[axis] / LightOptions{}.gridScaleSH);
    return LayoutGridSH(bsp, size);
}

} // namespace

Vec3f LegacyCell(const Bsp &bsp) {
    return keys::kGridSize.Vector(StoredWorld(bsp.entities)).value_or(Vec3f(kDefaultGridSize));
}

LightGridSH ExpandSparseGrid(const SparseGridSH &sparse, const GridLayout &layout) {
    static_assert(sizeof(shgrid_coeffs) == sizeof(bspGridPointSH_t));
    const std::vector<std::byte> lump = EncodeSparseGrid(sparse);
    const shgrid_grid reader = SparseReader(lump);
    LightGridSH grid{{layout.mins, layout.size, layout.bounds, std::int32_t(layout.Count())}, {}};
    std::size_t count = 0;
    grid.points.resize(std::size_t(layout.Count()));
    for (int z = 0; z < layout.bounds[2]; ++z)
        for (int y = 0; y < layout.bounds[1]; ++y)
            for (int x = 0; x < layout.bounds[0]; ++x) {
                const Float3 at = layout.Position(x, y, z);
                shgrid_coeffs value;
                shgrid_sample(&reader, at.data(), &value);
                grid.points[count++] = std::bit_cast<bspGridPointSH_t>(value);
            }
    return grid;
}

StoredGridSH SourceGrid(const Bsp &bsp) {
    const bool hasUniform = bsp.gridSH && !bsp.gridSH->points.empty();
    if (!hasUniform && !bsp.sparseGridSH)
        throw Error("the map has no SH light grid to convert: light it with -sh, -shbspx or -shadaptive first");
    return {hasUniform ? *bsp.gridSH : ExpandSparseGrid(*bsp.sparseGridSH, DefaultLayoutSH(bsp)),
            StoredWorld(bsp.entities).Value(kGridSHKey) == kRadiance};
}

GridSource::GridSource(const StoredGridSH &stored, const std::vector<bool> &isSolid)
    : layout_{stored.grid.header.gridMins, stored.grid.header.gridSize, stored.grid.header.gridBounds},
      points_(stored.grid.points), void_(points_.size()) {
    for (std::size_t i = 0; i < points_.size(); ++i) {
        void_[i] = isSolid[i] && IsBlack(points_[i]);
        if (stored.radiance)
            for (std::size_t k = 0; k < 9; ++k)
                for (float &value : points_[i].coeffs[k])
                    value *= float(kCosineLobe[k]);
    }
}

bool GridSource::Sample(const Vec3f &position, bspGridPointSH_t &light) const {
    light = {};
    std::array<std::int64_t, 3> low{};
    std::array<float, 3> fraction{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double last = layout_.bounds[axis] - 1;
        const double at = (double(position[axis]) - double(layout_.mins[axis])) / double(layout_.size[axis]);
        const double inside = std::clamp(at, 0.0, last);
        low[axis] = std::int64_t(inside);
        fraction[axis] = float(inside - double(low[axis]));
    }
    float total = 0;
    for (unsigned corner = 0; corner < 8; ++corner) {
        std::array<std::int64_t, 3> at = low;
        float weight = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool upper = (corner >> axis & 1) != 0;
            at[axis] += upper;
            weight *= upper ? fraction[axis] : 1 - fraction[axis];
        }
        if (!(weight > 0)) // past the last point, too
            continue;
        const auto index = std::size_t(layout_.Index(at[0], at[1], at[2]));
        if (void_[index])
            continue;
        AddScaled(weight, points_[index], light);
        total += weight;
    }
    if (!(total > 0))
        return false;
    for (Float3 &rgb : light.coeffs)
        for (float &value : rgb)
            value /= total;
    return true;
}

} // namespace q3
