// GPL-2.0-or-later. Bakes of one grid with their cost, and the light that an engine shows from them.
#include "tools/measure/shbench/bakes.h"

#include "common/error.h"
#include "libs/ambientcubes/ambient_cubes.h"
#include "q3map2/bspfile/bsp.h"
#include "q3map2/convert/preview/grid_preview_map.h"
#include "q3map2/lightmap/light_stage.h"

#include <memory>

namespace q3::bench {

namespace {

/// Of the legacy grid in IBSP files: ambient and directed color, and the direction in two bytes.
constexpr std::size_t kIbspGridPointBytes = 8;

/// Heading of the pass in the log.
std::string_view PassOf(BakedFormat format, const LightOptions &options) {
    switch (format) {
    case BakedFormat::LegacyGrid:
        return "--- TraceGrid ---";
    case BakedFormat::AmbientCubes:
        if (!options.cubesFromSH)
            return "--- TraceAmbientCubes ---";
        [[fallthrough]];
    case BakedFormat::NamedGridSH:
        return "--- TraceNamedGridSH ---";
    case BakedFormat::GridSH:
    case BakedFormat::SparseGridSH: // traces a uniform grid first
        break;
    }
    return "--- TraceGridSH ---";
}

/// Size of the lump.
std::int64_t LumpBytes(BakedFormat format, const Bsp &bsp) {
    switch (format) {
    case BakedFormat::GridSH:
        return std::int64_t(sizeof(bspGridSHHeader_t) + bsp.gridSH->points.size() * sizeof(bspGridPointSH_t));
    case BakedFormat::SparseGridSH:
        return std::int64_t(EncodeSparseGrid(*bsp.sparseGridSH).size());
    case BakedFormat::NamedGridSH:
        return std::int64_t(EncodeNamedGrid(*bsp.namedGridSH).size());
    case BakedFormat::LegacyGrid:
        return std::int64_t(bsp.gridPoints.size() * kIbspGridPointBytes);
    case BakedFormat::AmbientCubes:
        break;
    }
    if (!bsp.ambientCubes)
        return 0;
    return std::int64_t(sizeof(bspCubeHeader_t) + bsp.ambientCubes->leafs.size() * sizeof(bspCubeLeaf_t) +
                        bsp.ambientCubes->samples.size() * sizeof(bspCubeSample_t));
}

/// The options of a bake that makes that format alone.
LightOptions OptionsFor(BakedFormat format, LightOptions options) {
    options.ambientCubes = format == BakedFormat::AmbientCubes;
    options.sh = format == BakedFormat::GridSH || (options.ambientCubes && options.cubesFromSH);
    options.shLights = format == BakedFormat::NamedGridSH;
    options.shAdaptive = format == BakedFormat::SparseGridSH || (options.shLights && options.shAdaptive);
    options.noGrid = format != BakedFormat::LegacyGrid;
    return options;
}

} // namespace

BakeSetting ParseBakeSetting(const std::string &text) {
    const std::size_t colon = text.find(':');
    if (colon == 0 || colon == std::string::npos)
        throw Error("--bake \"{}\": expected a name, a colon and light options", text);
    return {text.substr(0, colon), text.substr(colon + 1)};
}

BakedFormat FormatOf(const LightOptions &options) {
    return options.ambientCubes ? BakedFormat::AmbientCubes
           : options.shLights   ? BakedFormat::NamedGridSH
           : options.shAdaptive ? BakedFormat::SparseGridSH
                                : BakedFormat::GridSH;
}

Baked Bake(const BenchMap &map, const LightOptions &given, BakedFormat format, ShaderLibrary &library,
           const JobPool &jobs) {
    const LightOptions options = OptionsFor(format, given);
    Baked baked;
    baked.bsp = map.bsp;
    // The set-up ends when the heading of the pass is logged.
    double passStart = 0;
    const std::string_view pass = PassOf(format, options);
    Log log([&](LogLevel, std::string_view text) {
        if (text.find(pass) != std::string_view::npos)
            passStart = CpuSeconds();
    });
    LightmapOptions onlyGrid;
    onlyGrid.onlyGrid = true;
    const double start = CpuSeconds();
    const LightResult result = LightWorld(baked.bsp, map.inputs, options, onlyGrid, library, jobs, log);
    const double end = CpuSeconds();
    const GridStats &stats = format == BakedFormat::LegacyGrid     ? result.grid
                             : format == BakedFormat::AmbientCubes ? result.cubes
                                                                   : result.gridSH;
    baked.cost.cpuSeconds = end - start;
    baked.cost.setUpSeconds = (passStart > 0 ? passStart : end) - start;
    // Ambient cubes may be made from an SH grid, whose rays count too.
    baked.cost.rays = stats.counts.rays + (options.ambientCubes ? result.gridSH.counts.rays : 0);
    baked.cost.points = stats.points;
    baked.cost.litPoints = stats.open + stats.moved;
    baked.cost.bytes = LumpBytes(format, baked.bsp);
    if (options.ambientCubes && baked.bsp.ambientCubes) {
        baked.cost.litPoints = baked.cost.points;
        baked.cost.points = std::int64_t(baked.bsp.ambientCubes->samples.size());
    }
    if (format == BakedFormat::SparseGridSH) // fitted to light that is traced; solid space has no points
        baked.cost.points = baked.cost.litPoints = std::int64_t(baked.bsp.sparseGridSH->points.size());
    if (format == BakedFormat::NamedGridSH)
        baked.cost.points = baked.cost.litPoints = std::int64_t(baked.bsp.namedGridSH->points.size());
    return baked;
}

namespace {

ShownLight ShownBySH(const Bsp &bsp) {
    return [view = std::make_shared<const SHPreview>(bsp)](const Vec3f &position) {
        SHSample sample = view->At(position);
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

/// Through the reader for engines, from the bytes of the file.
ShownLight ShownByCubes(const Bsp &bsp) {
    Bsp alone = bsp;
    alone.gridSH.reset(), alone.sparseGridSH.reset(), alone.namedGridSH.reset();
    const auto file = std::make_shared<const std::vector<std::byte>>(WriteBsp(alone, {}));
    ambient_cubes cubes;
    if (const auto result = ambient_cubes_load(file->data(), file->size(), &cubes); result != AMBIENT_CUBES_OK)
        throw Error("ambient cubes: {}", ambient_cubes_message(result));
    return [file, cubes, &bsp](const Vec3f &position) {
        const float at[3] = {position.x, position.y, position.z};
        ambient_cube cube;
        ambient_cubes_blend(&cubes, std::uint32_t(LeafAt(bsp, position)), at, &cube);
        NormalLight light;
        for (std::size_t i = 0; i < kNormals; ++i) {
            const Vec3f n(Normals()[i]);
            const float normal[3] = {n.x, n.y, n.z};
            float rgb[3];
            ambient_cube_evaluate(&cube, normal, rgb);
            light[i] = {rgb[0], rgb[1], rgb[2]};
        }
        return light;
    };
}

} // namespace

ShownLight ShownBy(BakedFormat format, const Bsp &bsp) {
    return format == BakedFormat::LegacyGrid     ? ShownByLegacy(bsp)
           : format == BakedFormat::AmbientCubes ? ShownByCubes(bsp)
                                                 : ShownBySH(bsp);
}

} // namespace q3::bench
