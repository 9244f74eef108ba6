// GPL-2.0-or-later. Bakes of one grid with their cost, and the light that an engine shows from them.
#include "tools/shbench/bakes.h"

#include "common/error.h"
#include "q3map2/convert/preview/grid_preview_light.h"
#include "q3map2/lightmap/light_world.h"

#include <memory>

namespace q3::bench {

Baked Bake(const BenchMap &map, LightOptions options, bool sh, ShaderLibrary &library, const JobPool &jobs) {
    options.sh = sh;
    options.noGrid = sh;
    Baked baked;
    baked.bsp = map.bsp;
    // The set-up ends when the heading of the pass is logged.
    double passStart = 0;
    const std::string_view pass = sh ? "--- TraceGridSH ---" : "--- TraceGrid ---";
    Log log([&](LogLevel, std::string_view text) {
        if (text.find(pass) != std::string_view::npos)
            passStart = CpuSeconds();
    });
    LightmapOptions onlyGrid;
    onlyGrid.onlyGrid = true;
    const double start = CpuSeconds();
    const LightResult result = LightWorld(baked.bsp, map.inputs, options, onlyGrid, library, jobs, log);
    const double end = CpuSeconds();
    const GridStats &stats = sh ? result.gridSH : result.grid;
    baked.cost.cpuSeconds = end - start;
    baked.cost.setUpSeconds = (passStart > 0 ? passStart : end) - start;
    baked.cost.rays = stats.counts.rays;
    baked.cost.points = stats.points;
    baked.cost.litPoints = stats.open + stats.moved;
    baked.cost.bytes =
        sh ? 40 + 108 * stats.points : std::int64_t(baked.bsp.gridPoints.size() * sizeof(bspGridPoint_t));
    return baked;
}

ShownLight ShownBySH(const Bsp &bsp) {
    return [view = ShPreview(bsp)](const Vec3f &position) {
        ShSample sample = view.At(position);
        sample.tone.reset(); // compared with exact light, which is linear
        NormalLight light;
        for (std::size_t i = 0; i < kNormals; ++i)
            light[i] = LightOn(sample, Vec3f(Normals()[i]));
        return light;
    };
}

ShownLight ShownByLegacy(const Bsp &bsp) {
    const auto view = LegacyPreview::Make(bsp);
    if (!view)
        throw Error("the map has no legacy light grid of the size that engines expect");
    return [view = *view](const Vec3f &position) {
        const LegacySample sample = view.At(position);
        NormalLight light;
        for (std::size_t i = 0; i < kNormals; ++i)
            light[i] = LightOn(sample, Vec3f(Normals()[i]));
        return light;
    };
}

} // namespace q3::bench
