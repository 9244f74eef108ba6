// GPL-2.0-or-later. A baseline SH grid baker: one ray per light and point.
#include "tools/measure/shbench/plain.h"

#include "libs/sh/sh.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>

namespace q3::bench {

namespace {

/// Light of an area light taken as a point at its center, byte scale: add cosine area / (pi d^2), with the cosine at
/// the emitter.
double AreaLightAt(const Light &light, const Vec3d &toCenter) {
    const double distance2 = std::max(1.0, Dot(toCenter, toCenter)); // as if no nearer than 1 unit
    const double cosine = -Dot(Normalize(toCenter), light.shape.normal);
    const double facing = light.twoSided ? std::abs(cosine) : std::max(0.0, cosine);
    return double(light.radiosity) * facing * double(light.shape.area) / (std::numbers::pi * distance2);
}

bspGridPointSH_t LightPoint(const BenchMap &map, const Vec3f &position, std::uint64_t &rayCount) {
    const Vec3d p(position);
    PointRays rays(map.scene, p);
    DirectionSum sum{.forNormals = false};
    for (const Light &light : map.lights) {
        if (light.type == LightType::Sun) {
            rays.CastToSky(light, sum);
            continue;
        }
        const bool area = light.type == LightType::Area;
        // Rays to area lights end before the emitting surface, which would block them.
        const Vec3d target = area ? Vec3d(light.shape.center) + light.shape.normal * kEmitterGap : Vec3d(light.origin);
        const double add = area ? AreaLightAt(light, target - p) : PointLightAt(light, p);
        if (add > 0)
            rays.Cast(target, Normalize(target - p), Vec3d(light.color) * (light.negative ? -add : add), &sum, nullptr);
    }
    rays.Flush();
    rayCount += rays.Count();
    const double scale = double(map.options.PositiveGridScale()) / 255;
    bspGridPointSH_t stored{};
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t k = 0; k < 9; ++k) {
            const double ambient = k == 0 ? double(map.world.ambient[channel]) / kSHC0 : 0;
            stored.coeffs[k][channel] = float((sum.projection[channel][k] + ambient) * scale);
        }
    return stored;
}

} // namespace

Baked BakeBaseline(const BenchMap &map, const bspGridSHHeader_t &layout, const JobPool &jobs) {
    const double start = CpuSeconds();
    Baked baked;
    baked.bsp = map.bsp;
    LightGridSH grid;
    grid.header = layout;
    grid.points.resize(std::size_t(layout.numPoints));
    std::atomic<std::uint64_t> rays = 0;
    std::atomic<std::int64_t> lit = 0;
    const std::int64_t across = layout.gridBounds[0];
    jobs.For(layout.numPoints / across, [&](std::int64_t row, int) {
        std::uint64_t cast = 0;
        std::int64_t open = 0;
        for (std::int64_t x = 0; x < across; ++x) {
            const std::int64_t at[3] = {x, row % layout.gridBounds[1], row / layout.gridBounds[1]};
            Vec3f p;
            for (std::size_t axis = 0; axis < 3; ++axis)
                p[axis] = layout.gridMins[axis] + float(at[axis]) * layout.gridSize[axis];
            if (map.space.ClusterAt(p, 0) < 0)
                continue;
            ++open;
            grid.points[std::size_t(row * across + x)] = LightPoint(map, p, cast);
        }
        rays += cast, lit += open;
    });
    baked.bsp.gridSH = std::move(grid);
    baked.bsp.sparseGridSH.reset(); // of the file: readers prefer it
    baked.cost.cpuSeconds = CpuSeconds() - start;
    baked.cost.rays = rays;
    baked.cost.points = layout.numPoints;
    baked.cost.litPoints = lit;
    baked.cost.bytes =
        std::int64_t(sizeof(bspGridSHHeader_t)) + std::int64_t(sizeof(bspGridPointSH_t)) * layout.numPoints;
    return baked;
}

} // namespace q3::bench
