// GPL-2.0-or-later. What the light grids of a map show at a position.
#include "q3map2/convert/preview/grid_preview_light.h"

#include "common/error.h"
#include "q3map2/bspfile/bspfile_grid.h"
#include "q3map2/bspfile/entities.h"
#include "q3map2/bspfile/entity_key.h"
#include "q3map2/bspfile/light_keys.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

namespace q3 {

// ---- Cells of the sparse SH grid by position ----

std::optional<SparseCell> SparseCellAt(const SparseGridSH &grid, const Vec3f &position) {
    SparseCell cell;
    std::size_t root = 0, stride = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at = (double(position[axis]) - double(grid.mins[axis])) / double(grid.cell[axis]);
        if (!(at >= 0 && at < double(grid.roots[axis] << grid.levels)))
            return std::nullopt;
        cell.low[axis] = std::int32_t(at);
        root += stride * std::size_t(cell.low[axis] >> grid.levels);
        stride *= std::size_t(grid.roots[axis]);
    }
    const SparseGridNode *node = &grid.nodes[root];
    for (cell.size = grid.levels - 1;; --cell.size) {
        const auto bit = [&](std::size_t axis) { return unsigned(cell.low[axis] >> cell.size & 1); };
        const unsigned octant = bit(0) | bit(1) << 1 | bit(2) << 2, lowerOctants = (1u << octant) - 1;
        if ((node->inner >> octant & 1) == 0)
            break;
        node = &grid.nodes[node->children + std::size_t(std::popcount(node->inner & lowerOctants))];
    }
    for (std::int32_t &low : cell.low)
        low = low >> cell.size << cell.size;
    return cell;
}

Vec3f SparseCellColor(int size) {
    static constexpr std::array<Vec3f, 6> kColors = {Vec3f{1, 0.3f, 0.25f}, {1, 0.75f, 0.2f}, {0.45f, 0.9f, 0.3f},
                                                     {0.25f, 0.85f, 0.9f},  {0.35f, 0.5f, 1}, {0.8f, 0.45f, 1}};
    return kColors[std::size_t(size) % kColors.size()];
}

// ---- What the two light grids of a map show at a position ----

namespace {

constexpr float kRenormalizeBelow = 0.99f; ///< engines renormalize only smaller sums of weights

/// The unit direction that a point of the legacy grid stores as two angles in bytes.
Vec3f DirectionOf(const bspGridPoint_t &point) {
    constexpr float step = 2 * std::numbers::pi_v<float> / 256; // radians
    const float polar = float(point.latLong[0]) * step, around = float(point.latLong[1]) * step;
    return {std::cos(around) * std::sin(polar), std::sin(around) * std::sin(polar), std::cos(polar)};
}

Vec3f FromBytes(const std::array<std::uint8_t, 3> &bytes) {
    return Vec3f(float(bytes[0]), float(bytes[1]), float(bytes[2])) / 255.0f;
}

} // namespace

SHPreview::SHPreview(const Bsp &bsp) {
    if (bsp.sparseGridSH) {
        sparseLump_ = EncodeSparseGrid(*bsp.sparseGridSH);
        grid_ = SparseReader(sparseLump_);
    } else if (bsp.gridSH && !bsp.gridSH->points.empty()) {
        grid_ = UniformReader(*bsp.gridSH);
    } else {
        throw Error("the map has no SH light grid to show: light it with -sh first");
    }
    const Entity world = StoredWorld(bsp.entities);
    radiance_ = world.Value(kGridSHKey) == kRadiance;
    shgrid_tone tone;
    if (world.Has(kToneKey) && shgrid_parse_tone(std::string(world.Value(kToneKey)).c_str(), &tone) == SHGRID_OK)
        tone_ = tone;
}

SHSample SHPreview::At(const Vec3f &position) const {
    const float at[3] = {position.x, position.y, position.z};
    SHSample sample{{}, tone_};
    shgrid_sample(&grid_, at, &sample.coeffs);
    if (radiance_)
        shgrid_convolve(&sample.coeffs);
    return sample;
}

Vec3f LightOn(const SHSample &sample, const Vec3f &normal) {
    const float along[3] = {normal.x, normal.y, normal.z};
    float rgb[3];
    shgrid_evaluate(&sample.coeffs, along, rgb);
    if (sample.tone)
        shgrid_apply_tone(&*sample.tone, rgb);
    return {rgb[0], rgb[1], rgb[2]};
}

Vec3f LightOn(const LegacySample &sample, const Vec3f &normal) {
    return sample.ambient + sample.directed * std::max(0.0f, Dot(normal, sample.direction));
}

std::optional<LegacyPreview> LegacyPreview::Make(const Bsp &bsp) {
    LegacyPreview preview;
    const auto given = keys::kGridSize.Vector(StoredWorld(bsp.entities));
    const Float3 size = given ? given->Array() : kDefaultGridSize;
    try {
        preview.layout_ = LayoutGrid(bsp.models[0].mins, bsp.models[0].maxs, size);
    } catch (const Error &) {
        return std::nullopt; // ReadBsp has warned
    }
    if (bsp.gridPoints.empty() || preview.layout_.Count() != std::int64_t(bsp.gridPoints.size()))
        return std::nullopt;
    preview.points_ = bsp.gridPoints;
    return preview;
}

LegacySample LegacyPreview::At(const Vec3f &position) const {
    std::array<int, 3> low;
    Vec3f fraction;
    for (std::size_t axis = 0; axis < 3; axis++) {
        const float last = float(layout_.bounds[axis] - 1);
        const float at = (position[axis] - layout_.mins[axis]) / layout_.size[axis];
        const float cell = std::clamp(std::floor(at), 0.0f, last);
        low[axis] = std::min(int(cell), layout_.bounds[axis] - 1);
        fraction[axis] = std::clamp(at - cell, 0.0f, 1.0f);
    }
    LegacySample sum;
    float total = 0;
    for (unsigned corner = 0; corner < 8; corner++) {
        float weight = 1;
        std::int64_t index = 0, stride = 1;
        bool inside = true;
        for (std::size_t axis = 0; axis < 3; axis++) {
            const bool upper = corner >> axis & 1;
            inside = inside && low[axis] + upper < layout_.bounds[axis];
            weight *= upper ? fraction[axis] : 1 - fraction[axis];
            index += stride * (low[axis] + upper);
            stride *= layout_.bounds[axis];
        }
        if (!inside)
            continue;
        const bspGridPoint_t &point = points_[std::size_t(index)];
        if (point.ambient == std::array<std::uint8_t, 3>{}) // inside a wall
            continue;
        total += weight;
        sum.ambient += FromBytes(point.ambient) * weight;
        sum.directed += FromBytes(point.directed) * weight;
        sum.direction += DirectionOf(point) * weight;
    }
    if (total > 0 && total < kRenormalizeBelow) {
        sum.ambient = sum.ambient / total;
        sum.directed = sum.directed / total;
    }
    sum.direction = Normalize(sum.direction);
    return sum;
}

} // namespace q3
